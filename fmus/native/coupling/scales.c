#include "base/elementary.h"
#include "coupling/composite.h"

static double largest_row(int n, const double *matrix)
{
    double largest = 0.0;
    int i, j;
    for (i = 0; i < n; i++) {
        double sum = 0.0;
        for (j = 0; j < n; j++) {
            sum += matrix[i * n + j];
        }
        largest = larger(largest, absolute(sum));
    }
    return largest;
}

/* What unbalance and displaced supports push the rotor with at most [N]. */
static double largest_rotor_force(const Unit *unit, double speed, double spin_up)
{
    const LinearRotor *rotor = &((const Rotor *)unit->own)->rotor;
    const int n = rotor->stations;
    const double *start = unit->real + unit->layout.parameters.count - 4 * n;
    const double *rate = start + 2 * n;
    double unbalance = 0.0, out = 0.0, motion = 0.0;
    int k;
    for (k = 0; k < 2 * n; k += 2) {
        unbalance += hypotenuse(rotor->unbalance[k], rotor->unbalance[k + 1]);
        out = larger(out, hypotenuse(start[k], start[k + 1]));
        motion = larger(motion, hypotenuse(rate[k], rate[k + 1]));
    }
    return unbalance * (speed * speed + spin_up) +
           out * larger(largest_row(n, rotor->stiffness_x), largest_row(n, rotor->stiffness_y)) +
           motion * larger(largest_row(n, rotor->damping_x), largest_row(n, rotor->damping_y));
}

void composite_added_masses(const Composite *c, double *masses)
{
    int k;
    for (k = 0; k < c->parts->unit->layout.sizes.planes; k++) {
        masses[k] = 0.0;
    }
    for (k = 1; k < c->parts_without_motor; k++) {
        masses[c->parts[k].plane] += part_added_mass(c->parts + k);
    }
}

double composite_largest_force(const Composite *c)
{
    const LinearRotor *rotor = &composite_rotor(c)->rotor;
    const double speed = c->course->drive.fastest, spin_up = c->course->drive.steepest;
    const double mass = sum_of(rotor->mass, rotor->stations * rotor->stations);
    const double weight = mass * hypotenuse(rotor->gravity[0], rotor->gravity[1]);
    double own = 0.0, carried = 0.0;
    int k;
    for (k = 1; k < c->parts_without_motor; k++) {
        const Balls *balls = part_balls(c->parts + k);
        if (balls) {
            const Weights *weights = &balls->track.weights;
            const double *speeds = c->parts[k].unit->real + FIRST_ANGLE + balls->count;
            const double rate = speed + largest_of(balls->count, speeds);
            own += balls->count * weights->mass * weights->track_radius * (rate * rate + spin_up);
        }
        carried += part_added_mass(c->parts + k);
    }
    return own + carried * (own + (largest_rotor_force(c->parts->unit, speed, spin_up) + weight)) / mass;
}
