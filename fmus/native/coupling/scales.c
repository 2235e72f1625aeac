#include "base/elementary.h"
#include "coupling/composite.h"
#include "units/rotor.h"
#include "units/weights.h"
#include "weights/liquid.h"

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

/* Mass that a balancer has the rotor carry, by the port or in its force [kg]. */
static double added_mass(const Unit *unit)
{
    if (unit->equations == &WEIGHTS_EQUATIONS) {
        return weights_added_mass(&((const Balls *)unit->own)->track.weights);
    } else {
        const double *real = unit->real;
        const Liquid liquid = {real[0], real[1], real[2], real[3]};
        return liquid_added_mass(&liquid);
    }
}

void composite_added_masses(const Composite *c, double *masses)
{
    int k;
    for (k = 0; k < c->parts->unit->layout.sizes.planes; k++) {
        masses[k] = 0.0;
    }
    for (k = 1; k < c->mounted; k++) {
        masses[c->parts[k].plane] += added_mass(c->parts[k].unit);
    }
}

double composite_largest_force(const Composite *c)
{
    const Rotor *rotor = c->parts->unit->own;
    const int n = rotor->stations;
    const double speed = c->course->drive.fastest, spin_up = c->course->drive.steepest;
    double own = 0.0, carried = 0.0, mass = 0.0, weight;
    int k;
    for (k = 1; k < c->mounted; k++) {
        const Unit *unit = c->parts[k].unit;
        if (unit->equations == &WEIGHTS_EQUATIONS) {
            const Balls *balls = unit->own;
            const Weights *weights = &balls->track.weights;
            const double *speeds = unit->real + FIRST_ANGLE + balls->count;
            const double rate = speed + largest_of(balls->count, speeds);
            own += balls->count * weights->mass * weights->track_radius * (rate * rate + spin_up);
        }
        carried += added_mass(unit);
    }
    for (k = 0; k < n * n; k++) {
        mass += rotor->rotor.mass[k];
    }
    weight = mass * hypotenuse(rotor->rotor.gravity[0], rotor->rotor.gravity[1]);
    return own + carried * (own + (largest_rotor_force(c->parts->unit, speed, spin_up) + weight)) / mass;
}
