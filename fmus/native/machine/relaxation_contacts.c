/* What is sure of contacts in a step under heavy drag, though only some points of it are known.

   Between two points a function changes by at most its greatest slope times the time.  With |N| at most P the speed of
   a weight is at most the larger of that at the start and P/d; and N changes by its own slope, that of the plane's
   acceleration, and by the speed.  A gap, or what presses two weights on each other, that is far enough above 0 at
   both points stays there between them. */
#include "base/elementary.h"
#include "machine/phase.h"
#include "machine/relaxation.h"

#define GAP_KEPT 1e-10  /* rad: smaller ones are left to series, which find the instant */
#define PRESS_KEPT 1e-6 /* of P: N is known as it was before the last iteration */

/* -- bounds ------------------------------------------------------------------------------------------------- */

static double bound_of(Pair a)
{
    return absolute(pair_x(a)) + absolute(pair_y(a));
}

void relaxation_bound(Relaxation *r, const Machine *m, double length)
{
    const Carried *start = m->carried;
    const double offset = m->tracks->is_off ? bound_of(m->tracks->offset) : 0.0;
    double speed = absolute(start->speed[SIGNAL_ORDERS]);
    int k;
    r->strength = r->rise = r->bend = r->gained = r->gained_rise = r->gained_bend = 0.0;
    for (k = SIGNAL_ORDERS - 1; k >= 0; k--) {
        r->bend = r->bend * length + 2.0 * r->rise;
        r->rise = r->rise * length + r->strength;
        r->strength = r->strength * length + bound_of(start->signal[k]);
    }
    for (k = SIGNAL_ORDERS; k > 0; k--) {
        r->gained_bend = r->gained_bend * length + 2.0 * r->gained_rise;
        r->gained_rise = r->gained_rise * length + r->gained;
        r->gained = r->gained * length + k * absolute(start->speed[k]);
        speed = speed * length + absolute(start->speed[k - 1]);
    }
    r->strength += offset * (speed * speed + r->gained);
    r->rise += offset * (2.0 * speed * r->gained + r->gained_rise);
    r->bend += offset * (2.0 * (r->gained * r->gained + speed * r->gained_rise) + r->gained_bend);
}

/* The greatest lever of any weight, and what w' carries it along by in N. */
static void find_largest(const Machine *m, double *lever, double *carried)
{
    int w;
    *lever = *carried = 0.0;
    for (w = 0; w < m->weight_count; w++) {
        *lever = larger(*lever, m->weights[w].lever);
        *carried = larger(*carried, m->weights[w].lever * m->weights[w].roll + 1.0);
    }
}

/* Of N, at most: its size P, what it changes by with time and with an angle, how it bends with time, and the slope of
   that with an angle. */
typedef struct {
    double size, rise, slope, bend, turn;
} Bounds;

static Bounds bounds_of(const Relaxation *r, const Machine *m)
{
    double lever, carried;
    Bounds found;
    find_largest(m, &lever, &carried);
    found.size = lever * r->strength + carried * r->gained;
    found.rise = lever * r->rise + carried * r->gained_rise;
    found.slope = lever * r->strength;
    found.bend = lever * r->bend + carried * r->gained_bend;
    found.turn = lever * r->rise;
    return found;
}

static double greatest_speed(const Machine *m, const Bounds *bounds, int w)
{
    return larger(absolute(phase_rate(m, w)), bounds->size / m->weights[w].damping_rate);
}

bool relaxation_is_straight(const Relaxation *r, const Machine *m, double length, double tolerance)
{
    const Bounds bounds = bounds_of(r, m);
    double speed = 0.0, drag = infinity(), bend;
    int w;
    for (w = 0; w < m->weight_count; w++) {
        speed = larger(speed, greatest_speed(m, &bounds, w));
        drag = smaller(drag, m->weights[w].damping_rate);
    }
    bend = bounds.bend + (2.0 * bounds.turn + bounds.slope * speed) * speed;
    return 0.5 * bend * length * length <= tolerance * drag * drag;
}

/* Whether a function stays above `least` that changes by at most so much in the unit of time. */
static bool stays_above(const Radau *rule, const double *values, double least, double change, double length)
{
    const double *nodes = rule->nodes;
    int i;
    for (i = 0; i < rule->stages; i++) {
        const double time = (nodes[i] - (i ? nodes[i - 1] : 0.0)) * length;
        if (!(0.5 * (values[i] + values[i + 1] - change * time) > least)) {
            return false;
        }
    }
    return true;
}

/* -- contacts ---------------------------------------------------------------------------------------------- */

static bool stays_apart(const Relaxation *r, const Machine *m, const Bounds *bounds, int w, double length)
{
    const int ahead = m->phase->weights[w].ahead;
    const double *own = r->angles + w * RELAXED_TIMES, *other = r->angles + ahead * RELAXED_TIMES;
    double gaps[RELAXED_TIMES];
    int i;
    gaps[0] = phase_gap(m, w);
    for (i = 1; i <= r->now->rule->stages; i++) {
        gaps[i] = gaps[0] + (other[i] - other[0]) - (own[i] - own[0]);
    }
    return stays_above(r->now->rule, gaps, GAP_KEPT, greatest_speed(m, bounds, w) + greatest_speed(m, bounds, ahead), length);
}

/* Whether the first `count` weights of a group press on the weights ahead of them.  The press is N of these weights less
   N of the whole group, each weighted by its share. */
static bool stays_pressed(const Relaxation *r, const Machine *m, const Bounds *bounds, const PhaseGroup *group,
                          int count, double length)
{
    const double change = bounds->rise + bounds->slope * greatest_speed(m, bounds, group->first);
    double presses[RELAXED_TIMES], part = 0.0;
    int i, j, w = group->first;
    for (j = 0; j < count; j++, w = m->phase->weights[w].ahead) {
        part += m->weights[w].share / group->share;
    }
    for (i = 0; i <= r->now->rule->stages; i++) {
        presses[i] = 0.0;
        for (j = 0, w = group->first; j < group->size; j++, w = m->phase->weights[w].ahead) {
            presses[i] += m->weights[w].share / group->share * (j < count ? 1.0 - part : -part) *
                          r->pushes[w * RELAXED_TIMES + i];
        }
    }
    return stays_above(r->now->rule, presses, PRESS_KEPT * bounds->size, 2.0 * part * (1.0 - part) * change, length);
}

bool relaxation_keeps_contacts(const Relaxation *r, const Machine *m, double length)
{
    const struct Phase *phase = m->phase;
    const Bounds bounds = bounds_of(r, m);
    int w, g, k;
    for (w = 0; w < m->weight_count; w++) {
        if (phase->weights[w].ahead >= 0 && !phase->weights[w].joined && !stays_apart(r, m, &bounds, w, length)) {
            return false;
        }
    }
    for (g = 0; g < phase->group_count; g++) {
        const PhaseGroup *group = phase->groups + g;
        for (k = 1; k < group->size && !phase->weights[group->first].lasts; k++) {
            if (!stays_pressed(r, m, &bounds, group, k, length)) {
                return false;
            }
        }
    }
    return true;
}
