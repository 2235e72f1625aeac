/* Forces from outside on the planes of the rotor: along fixed axes, each a cubic from when the host told it,
   by its value and its derivatives of order 1 to 3. */
#include <string.h>

#include "base/elementary.h"
#include "base/spin.h"
#include "coupling/composite.h"

static const double SAME_COURSE = 1e-9; /* of a force: a cubic that misses the one before by less goes on */

/* Components: of every plane two. */
static size_t components(const Composite *c)
{
    return 2 * (size_t)c->parts->unit->layout.sizes.planes;
}

size_t outside_count(const Composite *c)
{
    return SIGNAL_ORDERS * components(c);
}

void outside_take(const Unit *unit)
{
    const Composite *c = unit->own;
    memcpy(c->outer_forces, unit->real + c->outer, outside_count(c) * sizeof(double));
    c->course->drive.pushed_at = unit->time;
}

/* Whether a component goes on `time` after it was told as the host says now; `stride` between its orders. */
static bool goes_on(const double *before, const double *now, size_t stride, double time)
{
    const double f0 = before[0], f1 = before[stride], f2 = before[2 * stride], f3 = before[3 * stride], t = time;
    if (f1 == 0.0 && f2 == 0.0 && f3 == 0.0) {
        return now[0] == f0 && now[stride] == 0.0 && now[2 * stride] == 0.0 && now[3 * stride] == 0.0;
    }
    const double here[SIGNAL_ORDERS] = {f0 + t * (f1 + t * (f2 / 2.0 + t * f3 / 6.0)),
                                        f1 + t * (f2 + t * f3 / 2.0), f2 + t * f3, f3};
    const double size = absolute(f0) + t * (absolute(f1) + t * (absolute(f2) / 2.0 + t * absolute(f3) / 6.0));
    double scale = SAME_COURSE * size; /* and for each order less a time */
    int k;
    for (k = 0; k < SIGNAL_ORDERS; k++, scale /= t > 0.0 ? t : 1.0) {
        if (absolute(now[stride * (size_t)k] - here[k]) > scale) {
            return 0;
        }
    }
    return 1;
}

bool outside_jumps(const Unit *unit)
{
    const Composite *c = unit->own;
    const size_t count = components(c);
    const double *now = unit->real + c->outer, time = unit->time - c->course->drive.pushed_at;
    size_t k;
    for (k = 0; k < count; k++) {
        if (!goes_on(c->outer_forces + k, now + k, count, time)) {
            return 1;
        }
    }
    return 0;
}

Pair outside_derivative(const Composite *c, const double *forces, int plane, int order, double time)
{
    const size_t stride = components(c);
    const double *told = forces + 2 * (size_t)plane + stride * (size_t)(SIGNAL_ORDERS - 1);
    Pair sum = pair_both(0.0);
    int k;
    for (k = SIGNAL_ORDERS - 1; k >= order; k--, told -= stride) {
        sum = pair_sum(pair_scaled(sum, time / (k - order + 1)), pair_of(told[0], told[1]));
    }
    return sum;
}

/* Force on a plane at a time since it was told, and its slope, as axes see it that turn with the rotor. */
static Knot seen_at(const Composite *c, int plane, double time, const Spin *spin)
{
    const size_t stride = components(c);
    const double *told = c->outer_forces + 2 * (size_t)plane;
    const Complex turn = rect(1.0, -spin->angle);
    Complex cubic[SIGNAL_ORDERS], fixed[2];
    Knot seen;
    int k;
    for (k = 0; k < SIGNAL_ORDERS; k++, told += stride) {
        cubic[k] = complex_of(told[0], told[1]);
    }
    cubic_at(cubic, time, fixed);
    seen.value = complex_product(fixed[0], turn);
    /* (F e^{-i beta})' = (F' - i w F) e^{-i beta} */
    seen.slope = complex_sum(complex_product(fixed[1], turn),
                             complex_of(spin->speed * seen.value.im, -spin->speed * seen.value.re));
    return seen;
}

static int pushes(const Composite *c, int plane)
{
    const size_t stride = components(c);
    const double *told = c->outer_forces + 2 * (size_t)plane;
    int k, found = 0;
    for (k = 0; k < SIGNAL_ORDERS; k++, told += stride) {
        found |= told[0] != 0.0 || told[1] != 0.0;
    }
    return found;
}

bool outside_knot(const Unit *unit, int plane, Knot *seen)
{
    const Composite *c = unit->own;
    const Unit *rotor = c->parts->unit;
    const double *speed = rotor->real + c->parts->speed_input, since = unit->time - c->course->drive.pushed_at;
    const Spin start = spin_of(rotor->memory[REST], speed[0], speed + SPIN_UP);
    if (!pushes(c, plane)) {
        return false;
    }
    *seen = seen_at(c, plane, since, &start);
    return true;
}
