#include "machine/relaxation.h"

#include "base/elementary.h"
#include "base/matrix.h"
#include "machine/phase.h"

enum { MOST_ITERATIONS = 12, MOST_TERMS = 120 };
#define LEFT_BY_ITERATION 0.02 /* of the tolerance */
#define SLOWEST_ITERATION 0.5  /* what one leaves of the one before, at most */
#define SUMMED_FALL 20.0       /* of d t: beyond, integrals follow from each other without a loss of digits */
#define CLEAR_PART 0.05        /* of e^{-d t}: below, the polynomial has nearly all of it */

static int allocate_rule(Unit *unit, RelaxedRule *made, const Radau *rule, int weights)
{
    const int n = rule->stages;
    int i, j, k;
    made->rule = rule;
    made->beyond = scaled_by_power(8.0, 3 - 2 * n); /* Chebyshev's polynomial of the degree s - 1 */
    made->of = unit_allocate(unit, (size_t)weights, sizeof *made->of);
    for (k = 0; k < n; k++) { /* the slope of the polynomial through the integrals up to the points */
        for (j = 0; j < n; j++) {
            double sum = 0.0;
            for (i = 0; i < n; i++) {
                sum += rule->powers[k * n + i] * rule->matrix[i * n + j];
            }
            made->powers[k][j] = (k + 1) * sum;
        }
    }
    return !made->of;
}

int relaxation_allocate(Unit *unit, Relaxation *r, int weights)
{
    const size_t count = (size_t)weights;
    r->ends = unit_allocate(unit, count, sizeof(double));
    r->angles = unit_allocate(unit, RELAXED_TIMES * count, sizeof(double));
    r->pushes = unit_allocate(unit, RELAXED_TIMES * count, sizeof(double));
    return allocate_rule(unit, &r->few, &RADAU_THREE, weights) || allocate_rule(unit, &r->many, &RADAU_SEVEN, weights) ||
           !r->ends || !r->angles || !r->pushes;
}

/* -- what a drag makes of N ------------------------------------------------------------------------------- */

/* Integrals of e^{-d (t - s)} (s/h)^k ds up to t = share h. */
static void integrate_powers(int powers, double drag, double length, double share, double *to)
{
    const double time = share * length, fallen = drag * time, left = natural_exp(-fallen);
    double power = 1.0;
    int j, k;
    for (k = 0; k < powers; k++, power *= share) {
        double term = 1.0, sum = 0.0;
        if (fallen > SUMMED_FALL) {
            to[k] = ((k ? power : 1.0 - left) - (k ? k / length * to[k - 1] : 0.0)) / drag;
            continue;
        }
        for (j = 0; j < MOST_TERMS && term > 1e-17 * sum; j++) { /* none is negative */
            sum += term / (j + k + 1);
            term *= fallen / (j + 1);
        }
        to[k] = time * power * left * sum;
    }
}

/* A row of what theta or theta' has by the values of a polynomial, where `fallen` is what it has by N = e^{-d t}:
   that part is taken out of the values. */
static void take_fall(int points, const Relaxed *made, double fallen, double *row, double *first)
{
    double kept = 0.0;
    int j;
    for (j = 0; j < points; j++) {
        kept += row[j] * made->fall[j];
    }
    *first = (fallen - kept) * made->first_part;
    for (j = 0; j < points; j++) {
        row[j] += (fallen - kept) * made->part[j];
    }
}

/* The part of e^{-d t} in N, by its values at the start and the points. */
static void find_part(const RelaxedRule *by, Relaxed *made)
{
    double start = 0.0;
    int j;
    for (j = 0; j < by->rule->stages; j++) {
        start += by->powers[0][j] * made->fall[j];
    }
    made->first_part = 1.0 - start > CLEAR_PART ? 1.0 / (1.0 - start) : 0.0;
    for (j = 0; j < by->rule->stages; j++) {
        made->part[j] = -by->powers[0][j] * made->first_part;
    }
}

static void prepare(const RelaxedRule *by, Relaxed *made, double drag, double length)
{
    const int n = by->rule->stages;
    const double *nodes = by->rule->nodes;
    double integrals[RELAXED_POINTS];
    int i, j, k;
    made->drag = drag;
    made->length = length;
    made->reach = 0.0;
    for (i = 0; i < n; i++) {
        made->fall[i] = natural_exp(-drag * nodes[i] * length);
    }
    find_part(by, made);
    for (i = 0; i < n; i++) {
        const double time = nodes[i] * length;
        double power = 1.0, reach = 0.0;
        integrate_powers(n, drag, length, nodes[i], integrals);
        made->coasted[i] = integrals[0];
        made->steady[i] = (time - integrals[0]) / drag;
        for (j = 0; j < n; j++) {
            made->places[i][j] = made->speeds[j] = 0.0;
        }
        for (k = 0; k < n; k++, power *= nodes[i]) {
            const double place = (time * power / (k + 1) - integrals[k]) / drag;
            for (j = 0; j < n; j++) {
                made->places[i][j] += place * by->powers[k][j];
                made->speeds[j] += integrals[k] * by->powers[k][j]; /* of the last point in the end */
            }
        }
        take_fall(n, made, (integrals[0] - time * made->fall[i]) / drag, made->places[i], &made->first[i]);
        for (j = 0; j < n; j++) {
            reach += absolute(made->places[i][j]);
        }
        made->reach = larger(made->reach, reach);
    }
    take_fall(n, made, length * made->fall[n - 1], made->speeds, &made->first_speed);
}

/* -- N ------------------------------------------------------------------------------------------------------ */

/* How the plane moves at the start and the points. */
static void watch_plane(Relaxation *r, Machine *m, double length)
{
    const Carried start = *m->carried;
    const MachineTrack *track = m->tracks;
    int i;
    for (i = 0; i <= r->now->rule->stages; i++) {
        machine_carry(m, &start, i ? r->now->rule->nodes[i - 1] * length : 0.0);
        r->felt[i] = m->carried->signal[0];
        if (track->is_off) {
            m->speed_order = m->carried->speed_order;
            r->felt[i] = pair_sum(r->felt[i], pair_product(track->offset, machine_turn_twice(m, 0)));
        }
        r->spun[i] = m->speed[1];
    }
    machine_carry(m, &start, 0.0);
}

static double push(const Relaxation *r, SeriesWeight *weight, int point, double angle)
{
    weight->rate[0] = pair_zero();
    series_weight_start(weight, angle);
    series_weight_advance(weight, 0, NULL, r->felt[point], 0.0, r->spun[point]);
    return weight->free - r->spun[point];
}

/* One weight, or some that touch, of which each is ahead of the one before. */
typedef struct {
    int first, size;
    double share; /* sum of m/kappa */
    double lever; /* the largest */
} Body;

static int member_after(const Machine *m, int weight)
{
    return m->phase ? m->phase->weights[weight].ahead : weight + 1;
}

/* N of a body whose first weight is at this angle. */
static double push_body(const Relaxation *r, const Machine *m, const Body *body, int point, double angle)
{
    const double start = r->angles[body->first * RELAXED_TIMES];
    double sum = 0.0;
    int j, w = body->first;
    for (j = 0; j < body->size; j++, w = member_after(m, w)) {
        SeriesWeight *weight = m->weights + w;
        const double found = push(r, weight, point, angle + (r->angles[w * RELAXED_TIMES] - start));
        r->pushes[w * RELAXED_TIMES + point] = found;
        sum += body->size > 1 ? weight->share / body->share * found : found;
    }
    return sum;
}

/* -- a step --------------------------------------------------------------------------------------------------- */

static double row_by(int points, const double *row, const double *values)
{
    double sum = 0.0;
    int j;
    for (j = 0; j < points; j++) {
        sum += row[j] * values[j];
    }
    return sum;
}

/* What is left out, about: the last power, and what the part of e^{-d t} does in its turn. */
static double error_of(const Relaxation *r, const Relaxed *by, const double *values, double first, double speed,
                       double slope)
{
    const int n = r->now->rule->stages;
    const double square = by->drag * by->drag, fallen = absolute(speed - first / by->drag) / by->drag;
    const double part = by->first_part * first + row_by(n, by->part, values), *powers = r->now->powers[n - 1];
    const double last = row_by(n, powers, values) - part * row_by(n, powers, by->fall);
    return (r->now->beyond * absolute(last) + absolute(part) * (slope / square + fallen)) / square;
}

/* Move one body; its error [rad]. */
static double move_body(Relaxation *r, const Machine *m, const Body *body, const Relaxed *by, double speed,
                        double enough)
{
    const int n = r->now->rule->stages, w = body->first;
    const double angle = r->angles[w * RELAXED_TIMES], slope = body->lever * r->strength;
    const double first = push_body(r, m, body, 0, angle);
    double values[RELAXED_POINTS], angles[RELAXED_POINTS], before = infinity();
    int i, k;
    for (i = 0; i < n; i++) {
        angles[i] = angle + by->coasted[i] * speed + by->steady[i] * first;
    }
    for (k = 0; k < MOST_ITERATIONS; k++) {
        double moved = 0.0, left;
        for (i = 0; i < n; i++) {
            values[i] = push_body(r, m, body, i + 1, angles[i]);
        }
        for (i = 0; i < n; i++) {
            const double found = angle + by->coasted[i] * speed + by->first[i] * first + row_by(n, by->places[i], values);
            moved = absolute(found - angles[i]) <= moved ? moved : absolute(found - angles[i]); /* no number too */
            angles[i] = found;
        }
        left = smaller(by->reach * slope, moved / (k ? before : 0.0)); /* the first is what it leaves at most */
        if (moved <= enough || (left < 1.0 && moved * left <= enough * (1.0 - left))) {
            copy_doubles((size_t)n, angles, r->angles + w * RELAXED_TIMES + 1);
            r->ends[w] = by->fall[n - 1] * speed + by->first_speed * first + row_by(n, by->speeds, values);
            return error_of(r, by, values, first, speed, slope);
        }
        if (!(k < 1 || left <= SLOWEST_ITERATION)) {
            break;
        }
        before = moved;
    }
    return infinity();
}

/* Whether all weights of a body have the same drag. */
static bool are_alike(const Machine *m, const Body *body)
{
    int j, w = body->first;
    for (j = 1; j < body->size; j++) {
        w = member_after(m, w);
        if (m->weights[w].damping_rate != m->weights[body->first].damping_rate) {
            return false;
        }
    }
    return true;
}

/* Let all weights of a body move as its first does. */
static void follow_first(const Relaxation *r, const Machine *m, const Body *body)
{
    const double *leads = r->angles + body->first * RELAXED_TIMES;
    int i, j, w = body->first;
    for (j = 1; j < body->size; j++) {
        double *angles = r->angles + (w = member_after(m, w)) * RELAXED_TIMES;
        for (i = 1; i <= r->now->rule->stages; i++) {
            angles[i] = leads[i] + (angles[0] - leads[0]);
        }
        r->ends[w] = r->ends[body->first];
    }
}

static Body body_of(const Machine *m, int number)
{
    Body body = {number, 1, m->weights[number].share, m->weights[number].lever};
    if (m->phase) {
        const PhaseGroup *group = m->phase->groups + number;
        int j, w = group->first;
        body.first = w;
        body.size = group->size;
        body.share = group->share;
        for (j = 0, body.lever = 0.0; j < group->size; j++, w = m->phase->weights[w].ahead) {
            body.lever = larger(body.lever, m->weights[w].lever);
        }
    }
    return body;
}

/* Find where a rule leads the weights; the error over the tolerance, infinite where that is not sure. */
static double follow_rule(Relaxation *r, Machine *m, const RelaxedRule *rule, double length, double tolerance)
{
    const int bodies = m->phase ? m->phase->group_count : m->weight_count, first = m->stations;
    double worst = 0.0;
    Relaxed *by = rule->of;
    int b;
    r->now = rule;
    watch_plane(r, m, length);
    for (b = 0; b < bodies; b++) {
        const Body body = body_of(m, b);
        const double drag = m->weights[body.first].damping_rate;
        double error;
        if (!are_alike(m, &body)) {
            return infinity();
        }
        by = by->drag == drag && by->length == length ? by : rule->of + body.first;
        if (by->drag != drag || by->length != length) {
            prepare(rule, by, drag, length);
        }
        error = move_body(r, m, &body, by, pair_at(m->velocity[first + body.first / 2], body.first % 2),
                          LEFT_BY_ITERATION * tolerance);
        worst = error <= worst ? worst : error;
        if (!(worst <= tolerance)) {
            return worst / tolerance;
        }
        follow_first(r, m, &body);
    }
    return m->phase && !relaxation_keeps_contacts(r, m, length) ? infinity() : worst / tolerance;
}

double relaxation_step(Relaxation *r, Machine *m, double length, double tolerance)
{
    const int n = m->weight_count, first = m->stations;
    double error = infinity();
    int w;
    for (w = 0; w < n; w++) {
        r->angles[w * RELAXED_TIMES] = pair_at(m->motion[first + w / 2], w % 2);
    }
    relaxation_bound(r, m, length);
    if (relaxation_is_straight(r, m, length, tolerance)) {
        error = follow_rule(r, m, &r->few, length, tolerance);
    }
    error = error <= 1.0 ? error : follow_rule(r, m, &r->many, length, tolerance);
    for (w = 0; w < n && error <= 1.0; w++) {
        const double *angles = r->angles + w * RELAXED_TIMES;
        pair_set(&m->motion[first + w / 2], w % 2, angles[r->now->rule->stages]);
        pair_set(&m->velocity[first + w / 2], w % 2, r->ends[w]);
    }
    return error;
}
