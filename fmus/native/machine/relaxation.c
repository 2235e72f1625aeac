#include "machine/relaxation.h"

#include "base/elementary.h"
#include "base/matrix.h"
#include "machine/phase.h"

enum { MOST_ITERATIONS = 12 };
#define LEFT_BY_ITERATION 0.02 /* of the tolerance */
#define SLOWEST_ITERATION 0.5  /* what one leaves of the one before, at most */

int relaxation_allocate(Unit *unit, Relaxation *r, int weights)
{
    const size_t count = (size_t)weights;
    r->ends = unit_allocate(unit, count, sizeof(double));
    r->angles = unit_allocate(unit, RELAXED_TIMES * count, sizeof(double));
    r->pushes = unit_allocate(unit, RELAXED_TIMES * count, sizeof(double));
    return relaxation_allocate_rule(unit, &r->few, &RADAU_THREE, weights) ||
           relaxation_allocate_rule(unit, &r->many, &RADAU_SEVEN, weights) || !r->ends || !r->angles || !r->pushes;
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
            relaxation_prepare(rule, by, drag, length);
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
