/* What a changing angular acceleration adds to what a constant one would have led to. */
#ifndef AUTOBALANCER_SPIN_H
#define AUTOBALANCER_SPIN_H

/* Of the rotor: angle, speed and acceleration, and the slope of the acceleration itself. */
typedef struct {
    double angle, speed, acceleration, slope;
} Drift;

/* Whether the angular acceleration changes within the step. */
static inline int drifts(const double *spin_up)
{
    return spin_up[1] != 0.0 || spin_up[2] != 0.0 || spin_up[3] != 0.0;
}

/* The drift `time` after the start of a step; spin_up (4,): angular acceleration there and its
   derivatives of order 1 to 3. */
static inline Drift drift(const double *spin_up, double time)
{
    const double first = spin_up[1], second = spin_up[2], third = spin_up[3];
    Drift found = {0.0, 0.0, 0.0, 0.0};
    if (!drifts(spin_up)) {
        return found;
    }
    found.angle = time * time * time *
                  (first / 6.0 + time * (second / 24.0 + time * third / 120.0));
    found.speed = time * time * (first / 2.0 + time * (second / 6.0 + time * third / 24.0));
    found.acceleration = time * (first + time * (second / 2.0 + time * third / 6.0));
    found.slope = first + time * (second + time * third / 2.0);
    return found;
}

#endif
