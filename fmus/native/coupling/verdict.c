/* What tells whether a machine is balanced: vibration, unbalance that is left, capacity in use. */
#include <string.h>

#include "base/elementary.h"
#include "constants.h"
#include "contact/ring.h"
#include "coupling/composite.h"

enum { PARTS_OF_STEP = 4 }; /* a step of an eighth of a revolution then misses 0.5 % of a peak */

static size_t axes_of(const Composite *c)
{
    return 2 * (size_t)c->parts->unit->layout.sizes.stations;
}

size_t verdict_doubles(const Composite *c)
{
    return 2 * axes_of(c);
}

/* The extents begin at these displacements. */
static void begin_extents(Composite *c, const double *place)
{
    size_t k;
    c->course->vibration.turned = c->course->vibration.last = 0.0;
    for (k = 0; k < axes_of(c); k++) {
        c->extent[2 * k] = c->extent[2 * k + 1] = place[k];
    }
}

void verdict_begin(Composite *c)
{
    begin_extents(c, c->parts->unit->memory + MOTION);
}

/* Half of the largest extent of a station along an axis. */
static double amplitude(const Composite *c)
{
    double most = 0.0;
    size_t k;
    for (k = 0; k < axes_of(c); k++) {
        most = larger(most, 0.5 * (c->extent[2 * k + 1] - c->extent[2 * k]));
    }
    return most;
}

/* Where a revolution ends, store its vibration and begin the next revolution. */
static void end_revolution(Composite *c, const double *place, double turned)
{
    Vibration *vibration = &c->course->vibration;
    vibration->turned += turned;
    if (vibration->turned >= TAU * (1.0 - 1e-9)) {
        const double last = amplitude(c), beyond = vibration->turned - TAU;
        begin_extents(c, place);
        vibration->last = last;
        vibration->turned = larger(0.0, beyond);
    }
}

void verdict_follow(Composite *c, double speed, double step)
{
    const size_t n = axes_of(c);
    const double *begin = c->at_begin + MOTION, *end = c->parts->unit->memory + MOTION;
    size_t k;
    int j;
    for (k = 0; k < n; k++) {
        for (j = 1; j <= PARTS_OF_STEP; j++) {
            /* the cubic between both ends */
            const double s = (double)j / PARTS_OF_STEP, r = 1.0 - s;
            const double place = r * r * (begin[k] * (1.0 + 2.0 * s) + begin[n + k] * step * s) +
                                 s * s * (end[k] * (1.0 + 2.0 * r) - end[n + k] * step * r);
            c->extent[2 * k] = smaller(c->extent[2 * k], place);
            c->extent[2 * k + 1] = larger(c->extent[2 * k + 1], place);
        }
    }
    end_revolution(c, end, absolute(speed) * step);
}

void verdict_look(Composite *c, const double *place, double turned)
{
    size_t k;
    for (k = 0; k < axes_of(c); k++) {
        c->extent[2 * k] = smaller(c->extent[2 * k], place[k]);
        c->extent[2 * k + 1] = larger(c->extent[2 * k + 1], place[k]);
    }
    end_revolution(c, place, absolute(turned));
}

double verdict_vibration(const Composite *c)
{
    return c->course->vibration.last > 0.0 ? c->course->vibration.last : amplitude(c);
}

/* Largest static moment of weights on one track, that of all in contact, whichever is the first [kg m]. */
static double capacity_of(const Balls *balls, const double *angles)
{
    const int n = balls->count;
    double mass = 0.0, most = 0.0;
    WeightsInOrder weights;
    Failure failure;
    int k;
    /* an overlap is refused in steps: order, masses and spacings are set before */
    order_weights(&balls->track, angles, angles + n, angles + 2 * (size_t)n, balls->scratch,
                  &weights, &failure);
    for (k = 0; k < n; k++) {
        mass += weights.mass[k];
        most = larger(most, find_offsets(&weights, k, n));
    }
    return balls->track.moment * mass * most;
}

void verdict_unbalance(const Composite *c, double *left, double *used)
{
    const Rotor *rotor = composite_rotor(c);
    Complex sum = {0.0, 0.0};
    int k;
    *used = 0.0;
    for (k = 0; k < rotor->stations; k++) {
        sum = complex_sum(sum, complex_of(rotor->rotor.unbalance[2 * k], rotor->rotor.unbalance[2 * k + 1]));
    }
    for (k = 1; k < c->parts_without_motor; k++) {
        const double *angles = c->parts[k].unit->memory;
        const Balls *balls = part_balls(c->parts + k);
        if (balls) {
            const Complex own = weights_static_moment(&balls->track.weights, angles, NULL);
            sum = complex_sum(sum, track_static_moment(&balls->track, angles, NULL));
            if (!balls->track.full) { /* those that fill their track supply nothing */
                *used = larger(*used, magnitude(own) / capacity_of(balls, angles));
            }
        }
    }
    *left = magnitude(sum);
}
