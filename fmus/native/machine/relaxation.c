#include "machine/relaxation.h"

#include "base/elementary.h"
#include "base/matrix.h"
#include "machine/phase.h"

enum { MOST_ITERATIONS = 12, MOST_OF_FEW = 2 /* points of three that are most of a step */ };
#define LEFT_BY_ITERATION 0.02 /* of the tolerance */
#define SLOWEST_ITERATION 0.5  /* what one leaves of the one before, at most */

int relaxation_allocate(Unit *unit, Relaxation *r, int weights)
{
    const size_t count = (size_t)weights;
    r->angles = unit_allocate(unit, RELAXED_TIMES * count, sizeof(double));
    r->speeds = unit_allocate(unit, RELAXED_TIMES * count, sizeof(double));
    r->pushes = unit_allocate(unit, RELAXED_TIMES * count, sizeof(double));
    r->loads = unit_allocate(unit, RELAXED_TIMES * count, sizeof(double));
    r->fastest = unit_allocate(unit, count, sizeof(double));
    return relaxation_allocate_rule(unit, &r->few, &RADAU_THREE, weights) ||
           relaxation_allocate_rule(unit, &r->many, &RADAU_SEVEN, weights) || !r->angles || !r->speeds || !r->pushes ||
           !r->loads || !r->fastest;
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
        r->turning[i] = m->speed[0];
        r->spun[i] = m->speed[1];
    }
    machine_carry(m, &start, 0.0);
}

/* N of a weight at a point, at this angle and theta'. */
static double push(const Relaxation *r, const Machine *m, int w, int point, double angle, double speed)
{
    SeriesWeight *weight = m->weights + w;
    double found;
    weight->rate[0] = pair_zero();
    series_weight_start(weight, pair_direction(angle));
    series_weight_advance(weight, 0, NULL, r->felt[point], 0.0, r->spun[point]);
    found = weight->free - r->spun[point];
    r->pushes[w * RELAXED_TIMES + point] = found;
    return m->phase && m->phase->weights[w].grip > 0.0 ? relaxation_resist(r, m, w, point, speed, found) : found;
}

/* One weight, or some that touch, of which each is ahead of the one before. */
typedef struct {
    int first, size;
    bool rests, rolls; /* held by resistance, or against it */
    double share;      /* sum of m/kappa */
    double lever;      /* the largest */
} Body;

static int member_after(const Machine *m, int weight)
{
    return m->phase ? m->phase->weights[weight].ahead : weight + 1;
}

/* N of a body whose first weight is at this angle. */
static double push_body(const Relaxation *r, const Machine *m, const Body *body, int point, double angle, double speed)
{
    const double start = r->angles[body->first * RELAXED_TIMES];
    double sum = 0.0;
    int j, w = body->first;
    for (j = 0; j < body->size; j++, w = member_after(m, w)) {
        const double found = push(r, m, w, point, angle + (r->angles[w * RELAXED_TIMES] - start), speed);
        sum += body->size > 1 ? m->weights[w].share / body->share * found : found;
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

/* What N of a body changes by with theta, theta' and its square, at most, where theta' is no more than so much. */
typedef struct {
    double by_angle, by_speed, by_square;
} Slopes;

static Slopes slopes_of(const Relaxation *r, const Machine *m, const Body *body, double fastest)
{
    Slopes found = {body->lever * r->strength, 0.0, 0.0};
    if (body->rolls) {
        const PhaseWeight *own = m->phase->weights + body->first;
        found.by_angle *= 1.0 + own->grip;
        found.by_speed = relaxation_by_speed(r, m, body->first, fastest);
        found.by_square = own->grip * body->lever * own->radius;
    }
    return found;
}

/* What is left out, about: the last power, and what the part of e^{-d t} does in its turn, by theta and by theta'. */
static double error_of(const Relaxation *r, const Relaxed *by, const double *values, double first, double speed,
                       const Slopes *slopes)
{
    const int n = r->now->rule->stages;
    const double square = by->drag * by->drag, fallen = absolute(speed - first / by->drag) / by->drag;
    const double part = by->first_part * first + row_by(n, by->part, values), *powers = r->now->powers[n - 1];
    const double last = row_by(n, powers, values) - part * row_by(n, powers, by->fall);
    const double turned = slopes->by_speed / by->drag;
    return (r->now->beyond * absolute(last) + absolute(part) * (slopes->by_angle / square + fallen + turned) +
            slopes->by_square * fallen * fallen * square) / square;
}

/* Places and speeds at the points from N there; what the places moved by, or what the speeds of a body that rolls did to
   them, at most. */
static double place_body(const Relaxation *r, const Relaxed *by, const Body *body, double first, const double *values)
{
    const int n = r->now->rule->stages;
    double *angles = r->angles + body->first * RELAXED_TIMES, *speeds = r->speeds + body->first * RELAXED_TIMES;
    double moved = 0.0;
    int i;
    for (i = 0; i < n; i++) {
        const double found = angles[0] + by->coasted[i] * speeds[0] + by->first[i] * first + row_by(n, by->places[i], values);
        moved = absolute(found - angles[i + 1]) <= moved ? moved : absolute(found - angles[i + 1]); /* no number too */
        angles[i + 1] = found;
    }
    for (i = 0; i < n; i++) {
        const double found = by->fall[i] * speeds[0] + by->first_speed[i] * first + row_by(n, by->speeds[i], values);
        const double off = body->rolls ? absolute(found - speeds[i + 1]) * by->reach / by->reach_speed : 0.0;
        moved = off <= moved ? moved : off;
        speeds[i + 1] = found;
    }
    return moved;
}

/* Move one body; its error [rad]. */
static double move_body(Relaxation *r, const Machine *m, const Body *body, const Relaxed *by, double enough)
{
    const int n = r->now->rule->stages;
    double *angles = r->angles + body->first * RELAXED_TIMES, *speeds = r->speeds + body->first * RELAXED_TIMES;
    const double first = push_body(r, m, body, 0, angles[0], speeds[0]);
    const Slopes slopes = slopes_of(r, m, body, larger(absolute(speeds[0]), absolute(first) / by->drag));
    double values[RELAXED_POINTS], before = infinity();
    int i, k;
    for (i = 0; i < n; i++) {
        angles[i + 1] = angles[0] + by->coasted[i] * speeds[0] + by->steady[i] * first;
        speeds[i + 1] = by->fall[i] * speeds[0] + by->coasted[i] * first;
    }
    for (k = 0; k < MOST_ITERATIONS; k++) {
        double moved, left;
        for (i = 0; i < n; i++) {
            values[i] = push_body(r, m, body, i + 1, angles[i + 1], speeds[i + 1]);
        }
        moved = place_body(r, by, body, first, values);
        left = smaller(by->reach * slopes.by_angle + by->reach_speed * slopes.by_speed,
                       moved / (k ? before : 0.0)); /* the first is what it leaves at most */
        if (moved <= enough || (left < 1.0 && moved * left <= enough * (1.0 - left))) {
            return error_of(r, by, values, first, speeds[0], &slopes);
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
    const double *leads = r->angles + body->first * RELAXED_TIMES, *speeds = r->speeds + body->first * RELAXED_TIMES;
    int i, j, w = body->first;
    for (j = 1; j < body->size; j++) {
        double *angles = r->angles + (w = member_after(m, w)) * RELAXED_TIMES;
        for (i = 1; i <= r->now->rule->stages; i++) {
            angles[i] = leads[i] + (angles[0] - leads[0]);
            r->speeds[w * RELAXED_TIMES + i] = speeds[i];
        }
    }
}

/* Keep a body where it rests. */
static void hold_body(const Relaxation *r, const Machine *m, const Body *body)
{
    int i, j, w = body->first;
    for (j = 0; j < body->size; j++, w = member_after(m, w)) {
        double *angles = r->angles + w * RELAXED_TIMES, *speeds = r->speeds + w * RELAXED_TIMES;
        for (i = 0; i <= r->now->rule->stages; i++) {
            angles[i] = angles[0];
            speeds[i] = 0.0;
            push(r, m, w, i, angles[0], 0.0);
        }
    }
}

static Body body_of(const Machine *m, int number)
{
    Body body = {number, 1, false, false, m->weights[number].share, m->weights[number].lever};
    if (m->phase) {
        const PhaseGroup *group = m->phase->groups + number;
        int j, w = group->first;
        body.first = w;
        body.size = group->size;
        body.rests = group->rests;
        body.rolls = m->phase->weights[w].slip != 0.0;
        body.share = group->share;
        for (j = 0, body.lever = 0.0; j < group->size; j++, w = m->phase->weights[w].ahead) {
            body.lever = larger(body.lever, m->weights[w].lever);
        }
    }
    return body;
}

/* Find where a rule leads one body; its error. */
static double follow_body(Relaxation *r, const Machine *m, const Body *body, Relaxed **by, double length, double tolerance)
{
    const double drag = m->weights[body->first].damping_rate;
    double error;
    if (body->rests) {
        hold_body(r, m, body);
        return 0.0;
    }
    if (!are_alike(m, body)) {
        return infinity();
    }
    *by = (*by)->drag == drag && (*by)->length == length ? *by : r->now->of + body->first;
    if ((*by)->drag != drag || (*by)->length != length) {
        relaxation_prepare(r->now, *by, drag, length);
    }
    error = move_body(r, m, body, *by, LEFT_BY_ITERATION * tolerance);
    follow_first(r, m, body);
    return error;
}

/* Find where a rule leads the weights, and how far it is sure that nothing happens; the error over the tolerance, infinite
   where the iteration does not come together. */
static double follow_rule(Relaxation *r, Machine *m, const RelaxedRule *rule, double length, double tolerance)
{
    const int bodies = m->phase ? m->phase->group_count : m->weight_count;
    double worst = 0.0;
    Relaxed *by = rule->of;
    int b;
    r->now = rule;
    r->sure = rule->rule->stages;
    watch_plane(r, m, length);
    for (b = 0; b < bodies; b++) {
        const Body body = body_of(m, b);
        const double error = follow_body(r, m, &body, &by, length, tolerance);
        worst = error <= worst ? worst : error;
        if (!(worst <= tolerance)) {
            return infinity();
        }
    }
    if (m->phase) {
        const RelaxedBounds bounds = relaxation_bounds_of(r, m);
        relaxation_find_fastest(r, m, &bounds, length);
        relaxation_limit_contacts(r, m, &bounds, length);
        relaxation_limit_rolling(r, m, &bounds, length);
    }
    return worst / tolerance;
}

double relaxation_step(Relaxation *r, Machine *m, double length, double least, double tolerance)
{
    const int n = m->weight_count, first = m->stations;
    double error = infinity();
    int w;
    for (w = 0; w < n; w++) {
        r->angles[w * RELAXED_TIMES] = pair_at(m->motion[first + w / 2], w % 2);
        r->speeds[w * RELAXED_TIMES] = pair_at(m->velocity[first + w / 2], w % 2);
    }
    relaxation_bound(r, m, length);
    if (relaxation_is_straight(r, m, length, tolerance)) {
        error = follow_rule(r, m, &r->few, length, tolerance);
    }
    if (!(error <= 1.0 && r->sure >= MOST_OF_FEW)) {
        error = follow_rule(r, m, &r->many, length, tolerance);
    }
    if (r->sure < r->now->rule->stages) {
        const double *nodes = r->now->rule->nodes, reached = r->sure ? nodes[r->sure - 1] : 0.0;
        r->unsure = (nodes[r->sure] - reached) * length;
        length *= reached;
        r->sure = length >= least ? r->sure : 0;
    }
    if (!(error <= 1.0 && r->sure)) {
        return 0.0;
    }
    for (w = 0; w < n; w++) {
        pair_set(&m->motion[first + w / 2], w % 2, r->angles[w * RELAXED_TIMES + r->sure]);
        pair_set(&m->velocity[first + w / 2], w % 2, r->speeds[w * RELAXED_TIMES + r->sure]);
    }
    return length;
}
