/* Bounds of what moves weights in a step under heavy drag, though only some points of it are known.

   Between two points a function changes by at most its greatest slope times the time.  With |N| at most P the speed of
   a weight is at most the larger of that at the start and P/d, which resistance makes no larger; and N changes by its own
   slope, that of the plane's acceleration, by the speed, and by its resistance. */
#include "base/elementary.h"
#include "machine/relaxation.h"

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
    r->spin = speed;
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

RelaxedBounds relaxation_bounds_of(const Relaxation *r, const Machine *m)
{
    double lever, carried;
    RelaxedBounds found;
    find_largest(m, &lever, &carried);
    found.size = lever * r->strength + carried * r->gained;
    found.rise = lever * r->rise + carried * r->gained_rise;
    found.slope = lever * r->strength;
    found.bend = lever * r->bend + carried * r->gained_bend;
    found.turn = lever * r->rise;
    return found;
}

double relaxation_greatest_speed(const Machine *m, const RelaxedBounds *bounds, int w)
{
    return larger(absolute(phase_rate(m, w)), bounds->size / m->weights[w].damping_rate);
}

double relaxation_grip(const Machine *m, int w)
{
    return m->phase ? m->phase->weights[w].grip * m->weights[w].lever : 0.0;
}

double relaxation_by_speed(const Relaxation *r, const Machine *m, int w, double fastest)
{
    return m->phase ? 2.0 * relaxation_grip(m, w) * m->phase->weights[w].radius * (r->spin + fastest) : 0.0;
}

/* How N bends with time, with what resistance adds, where it is `bend` without. */
static double bend_by_resistance(const Relaxation *r, const Machine *m, double bend, double fastest, double drag)
{
    double most = bend;
    int w;
    for (w = 0; w < m->weight_count && m->phase; w++) {
        const double by_turning = 2.0 * relaxation_grip(m, w) * m->phase->weights[w].radius;
        const double found = bend * (1.0 + m->phase->weights[w].grip) +
                             by_turning * (r->gained * r->gained + r->spin * r->gained_rise);
        most = larger(most, found * (1.0 + relaxation_by_speed(r, m, w, fastest) / drag));
    }
    return most;
}

bool relaxation_is_straight(const Relaxation *r, const Machine *m, double length, double tolerance)
{
    const RelaxedBounds bounds = relaxation_bounds_of(r, m);
    double speed = 0.0, drag = infinity(), bend;
    int w;
    for (w = 0; w < m->weight_count; w++) {
        speed = larger(speed, relaxation_greatest_speed(m, &bounds, w));
        drag = smaller(drag, m->weights[w].damping_rate);
    }
    bend = bounds.bend + (2.0 * bounds.turn + bounds.slope * speed) * speed;
    bend = bend_by_resistance(r, m, bend, speed, drag);
    return 0.5 * bend * length * length <= tolerance * drag * drag;
}

void relaxation_limit_above(Relaxation *r, const double *values, double least, double change, double length)
{
    const double *nodes = r->now->rule->nodes;
    int i;
    for (i = 0; i < r->sure; i++) {
        const double time = (nodes[i] - (i ? nodes[i - 1] : 0.0)) * length;
        if (!(0.5 * (values[i] + values[i + 1] - change * time) > least)) {
            r->sure = i;
        }
    }
}
