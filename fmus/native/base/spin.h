/* How the rotor turns within a step. */
#ifndef AUTOBALANCER_SPIN_H
#define AUTOBALANCER_SPIN_H

#include <stdbool.h>

/* Angle and speed of the rotor, its angular acceleration and the derivatives of that of order 1 to 3. */
typedef struct {
    double angle, speed, rates[4];
} Spin;

/* Whether the angular acceleration changes within the step; rates (4,) as of `Spin`. */
static inline bool drifts(const double *rates)
{
    return rates[1] != 0.0 || rates[2] != 0.0 || rates[3] != 0.0;
}

static inline Spin spin_of(double angle, double speed, const double *rates)
{
    Spin spin = {angle, speed, {rates[0], rates[1], rates[2], rates[3]}};
    return spin;
}

/* The same `time` later, or before where it is negative [s]. */
static inline Spin spin_after(const Spin *start, double time)
{
    const double *rates = start->rates;
    const double w1 = rates[0], w2 = rates[1], w3 = rates[2], w4 = rates[3], t = time;
    Spin end;
    end.angle = start->angle +
                t * (start->speed +
                     t * (w1 / 2.0 + t * (w2 / 6.0 + t * (w3 / 24.0 + t * w4 / 120.0))));
    end.speed = start->speed + t * (w1 + t * (w2 / 2.0 + t * (w3 / 6.0 + t * w4 / 24.0)));
    end.rates[0] = w1 + t * (w2 + t * (w3 / 2.0 + t * w4 / 6.0));
    end.rates[1] = w2 + t * (w3 + t * w4 / 2.0);
    end.rates[2] = w3 + t * w4;
    end.rates[3] = w4;
    return end;
}

#endif
