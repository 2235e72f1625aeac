/* What tells whether a machine is balanced: vibration, unbalance that is left, capacity in use.

   The vibration is half the peak-to-peak displacement over one revolution, at the station and along the axis
   where it is largest.  A machine without supports
   also drifts and tilts slowly.  Its vibration is the amplitude of the part that turns with the rotor: a least-squares
   fit of 1, s, s^2, cos t and sin t over the revolution, with the angle t of the rotor in it and s = t/2 pi. */
#include <string.h>

#include "base/elementary.h"
#include "base/matrix.h"
#include "constants.h"
#include "contact/ring.h"
#include "coupling/composite.h"

enum { PARTS_OF_STEP = 4 }; /* a step of an eighth of a revolution then misses 0.5 % of a peak */
enum { FITTED = 5, FITTED_COSINE = 3 };
static const double NOT_HELD = 1e-10; /* of an element of the matrix: what rounding leaves of 0 */

static size_t axes_of(const Composite *c)
{
    return 2 * (size_t)c->parts->unit->layout.sizes.stations;
}

size_t verdict_doubles(const Composite *c)
{
    return 2 * axes_of(c) + FITTED * (FITTED + axes_of(c));
}

/* Products of the terms (FITTED, FITTED), and behind them with every displacement (2 n, FITTED). */
static double *products_of(const Composite *c)
{
    return c->extent + 2 * axes_of(c);
}

/* Whether a stiffness matrix (n, n) lets a motion go, by elimination; it is overwritten. */
static bool lets_go(int n, double *matrix)
{
    const double size = largest_of(n * n, matrix);
    int i, j, k;
    for (k = 0; k < n; k++) {
        const double *row = matrix + k * n;
        if (!(row[k] > NOT_HELD * size)) {
            return true;
        }
        for (i = k + 1; i < n; i++) {
            const double factor = matrix[i * n + k] / row[k];
            for (j = k; j < n; j++) {
                matrix[i * n + j] -= factor * row[j];
            }
        }
    }
    return false;
}

static bool is_free(const Composite *c)
{
    const LinearRotor *rotor = &composite_rotor(c)->rotor;
    const int n = rotor->stations;
    const double *const axes[2] = {rotor->stiffness_x, rotor->stiffness_y};
    int axis;
    if (rotor->bearings.count > 0 || rotor->sliders) {
        return false;
    }
    for (axis = 0; axis < 2; axis++) {
        copy_doubles((size_t)(n * n), axes[axis], c->square);
        if (!lets_go(n, c->square)) {
            return false;
        }
    }
    return true;
}

/* The extents begin at these displacements. */
static void begin_extents(Composite *c, const double *place)
{
    size_t k;
    c->course->vibration.turned = c->course->vibration.last = 0.0;
    for (k = 0; k < axes_of(c); k++) {
        c->extent[2 * k] = c->extent[2 * k + 1] = place[k];
    }
    fill_doubles(FITTED * (FITTED + axes_of(c)), 0.0, products_of(c));
}

void verdict_begin(Composite *c)
{
    c->course->vibration.drifts = is_free(c);
    begin_extents(c, c->parts->unit->memory + MOTION);
}

/* Take displacements at an angle of the rotor in this revolution to the least squares. */
static void take_products(Composite *c, const double *place, double angle)
{
    const double s = angle / TAU, terms[FITTED] = {1.0, s, s * s, cosine(angle), sine(angle)};
    double *products = products_of(c), *own = products + FITTED * FITTED;
    size_t k;
    int j;
    for (j = 0; j < FITTED; j++) {
        add_multiple(1, FITTED, terms + j, terms, products + FITTED * j);
    }
    for (k = 0; k < axes_of(c); k++) {
        add_multiple(1, FITTED, place + k, terms, own + FITTED * k);
    }
}

/* Take over displacements at an angle of the rotor in this revolution. */
static void look_at(Composite *c, const double *place, double angle)
{
    const size_t axes = axes_of(c);
    size_t k;
    for (k = 0; k < axes; k++) {
        c->extent[2 * k] = smaller(c->extent[2 * k], place[k]);
        c->extent[2 * k + 1] = larger(c->extent[2 * k + 1], place[k]);
    }
    if (c->course->vibration.drifts) {
        take_products(c, place, angle);
    }
}

/* Amplitude along an axis of the part that turns with the rotor, the largest of all stations; 0 where there
   were too few looks. */
static double turning(const Composite *c)
{
    const double *products = products_of(c);
    double most = 0.0;
    size_t k;
    for (k = 0; k < axes_of(c); k++) {
        double matrix[FITTED * FITTED], found[FITTED];
        copy_doubles(FITTED * FITTED, products, matrix);
        copy_doubles(FITTED, products + FITTED * (FITTED + k), found);
        if (matrix_solve(1, FITTED, 1, matrix, found)) {
            return 0.0;
        }
        most = larger(most, hypotenuse(found[FITTED_COSINE], found[FITTED_COSINE + 1]));
    }
    return most;
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

/* After a whole revolution: store its vibration, and reset the extents for the next one. */
static void end_revolution(Composite *c, const double *place, double turned)
{
    Vibration *vibration = &c->course->vibration;
    vibration->turned += turned;
    if (vibration->turned >= TAU * (1.0 - 1e-9)) {
        const double last = vibration->drifts ? turning(c) : amplitude(c), beyond = vibration->turned - TAU;
        begin_extents(c, place);
        vibration->last = last;
        vibration->turned = larger(0.0, beyond);
    }
}

void verdict_follow(Composite *c, double speed, double step)
{
    const size_t n = axes_of(c);
    const double *begin = c->at_begin + MOTION, *end = c->parts->unit->memory + MOTION;
    const double turned = c->course->vibration.turned, turns = absolute(speed) * step;
    double *place = c->pieces.looked_at;
    size_t k;
    int j;
    for (j = 1; j <= PARTS_OF_STEP; j++) {
        const double s = (double)j / PARTS_OF_STEP, r = 1.0 - s;
        for (k = 0; k < n; k++) { /* the cubic between both ends */
            place[k] = r * r * (begin[k] * (1.0 + 2.0 * s) + begin[n + k] * step * s) +
                       s * s * (end[k] * (1.0 + 2.0 * r) - end[n + k] * step * r);
        }
        look_at(c, place, turned + s * turns);
    }
    end_revolution(c, end, turns);
}

void verdict_look(Composite *c, const double *place, double turned)
{
    look_at(c, place, c->course->vibration.turned + absolute(turned));
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
