/* A step of weights by themselves, from event to event. */
#include "base/elementary.h"
#include "base/matrix.h"
#include "constants.h"
#include "machine/carried.h"

enum { LEAST_CARRIED_ORDER = 5, MOST_CARRIED_ORDER = 24, MOST_TRIALS = 6, MOST_AT_ONCE = 40, MOST_WITH_EVENTS = 100000 };
#define CARRIED_TERM 1e-13  /* rad: the last terms of a step by series */
#define CARRIED_ERROR 1e-11 /* rad: of a step by collocation */
#define STIFF_TURN 16.0     /* of the drag's rate by a step: from here on collocation is worth it */
#define LEAST_FALL 3.0      /* of the slowest drag's rate by a step: from here on relaxation is worth it */
#define NEARER 0.125        /* of a step in which something is near: the next that is tried */
#define FARTHER 8.0         /* times a step in which nothing was: the next that is tried */
#define FALL_TO_EVENT 8.0   /* of the fastest drag's rate by a step by series to something near, at most */
#define LEAST_ADVANCE 1e-13 /* of a step, where events follow each other at once */

/* -- how the motion goes on and how far that is right ----------------------------------------------------------- */

/* Whether resistance holds all weights: nothing falls then as drag lets it. */
static bool all_rest(const Machine *m)
{
    int g;
    for (g = 0; m->phase && g < m->phase->group_count; g++) {
        if (!m->phase->groups[g].rests) {
            return false;
        }
    }
    return m->phase != NULL;
}

/* What begins the terms of the angles of order k + 2 over a length [rad]: the signal's and w' of order k, about; and
   what they grow by with each order, times it. */
static double first_terms(const CarriedWeights *c, double length, double *begun)
{
    const Machine *m = &c->step;
    const Carried *now = m->carried;
    const double lever = weights_lever(&c->track->weights), w = absolute(now->speed[0]);
    const double drag = all_rest(m) ? 0.0 : c->fastest * m->per_rate;
    double rate = 0.0, power = length * length, sum = 0.0;
    int k;
    for (k = 0; k < m->weight_count; k++) {
        rate = larger(rate, absolute(phase_rate(m, k)));
    }
    for (k = 0; k < SIGNAL_ORDERS; k++, power *= length) {
        begun[k] = power * (lever * (absolute(pair_x(now->signal[k])) + absolute(pair_y(now->signal[k]))) +
                            (k + 1) * absolute(now->speed[k + 1]));
        sum += begun[k];
    }
    power = length * length;
    begun[0] += power * (lever * magnitude(c->track->offset) * w * w + drag * rate);
    return length * (rate + drag + (m->from_rotor ? 0.0 : w)) +
           square_root(sum + power * lever * magnitude(c->track->offset) * w * w);
}

/* The order from which on terms are nothing. */
static int order_of(const CarriedWeights *c, double length)
{
    double begun[SIGNAL_ORDERS], term = 0.0;
    const double turn = first_terms(c, length, begun);
    int k;
    for (k = 2; k < MOST_CARRIED_ORDER; k++) {
        term = term * turn / k + (k - 2 < SIGNAL_ORDERS ? begun[k - 2] / (k * (k - 1)) : 0.0);
        if (term < CARRIED_TERM && k >= LEAST_CARRIED_ORDER) {
            return k + 1;
        }
    }
    return k;
}

/* A step of at most this length by collocation, in place of a series; 0: none is found. */
static double collocate(CarriedWeights *c, double angle, double length)
{
    Machine *m = &c->step;
    int k;
    collocation_start(&c->collocation, m, &c->at, angle);
    for (k = 0; k < MOST_TRIALS && length * c->fastest * m->per_rate >= STIFF_TURN; k++) {
        const double error = collocation_solve(&c->collocation, length, CARRIED_ERROR, 1.0);
        if (error <= 1.0) {
            collocation_write(&c->collocation, length, m);
            return length;
        }
        length *= smaller(collocation_factor(&c->collocation, error), 0.5);
    }
    return 0.0;
}

/* Move weights under heavy drag over a step of at most this length, in which nothing happens; 0: that is not worth it, and
   then whether that is because something is near. */
static double relax(CarriedWeights *c, double length, bool *is_near)
{
    Machine *m = &c->step;
    const double least = LEAST_FALL / (c->slowest * m->per_rate);
    const bool may = m->from_rotor && !all_rest(m);
    int k;
    *is_near = false;
    length = smaller(length, c->worth);
    for (k = 0; k < MOST_TRIALS && length >= least && may; k++) {
        const double moved = relaxation_step(&c->relaxation, m, length, least, CARRIED_ERROR);
        if (moved > 0.0) {
            c->worth = moved < length ? c->relaxation.unsure : FARTHER * c->worth;
            return moved;
        }
        *is_near = c->relaxation.sure == 0;
        length *= *is_near ? NEARER : 0.5;
    }
    return 0.0;
}

/* The motion from here on as a series, its order, and the length [machine's time] over which it is right; not above 0:
   there is none. */
static double expand_carried(CarriedWeights *c, double angle, double left, int *order)
{
    Machine *m = &c->step;
    double length = 0.0;
    if (c->fastest * m->per_rate * left >= STIFF_TURN && !all_rest(m)) {
        length = collocate(c, angle, left);
        *order = OF_POWERS;
    }
    if (length > 0.0) {
        return length;
    }
    *order = order_of(c, left);
    machine_expand(m, angle, *order);
    return smaller(left, machine_length(m, *order, CARRIED_TERM, infinity(), false));
}

/* -- who touches, and what sticks -------------------------------------------------------------------------- */

/* Impulse of a weight on its plane by a jump of its rate, in the axes of the machine. */
static Pair blow_of(const SeriesWeight *weight, double jump)
{
    return weight->race ? pair_scaled(weight->race->tangent[0], -weight->race->mass * jump)
                        : pair_scaled(pair_turned_back(weight->unit[0]), weight->moment * jump);
}

/* Add the impulses of collisions on the plane and on the shaft, by the jumps of all rates.  The plane answers later, and
   what weights feel of that is not in the torque that they state (find_plane_motion): it is part of the second. */
static void add_blows(const CarriedWeights *c, double angle, Moved *moved)
{
    const Machine *m = &c->step;
    const Pair centre = pair_product(m->tracks->offset, m->spin[0]);
    Pair whole = pair_zero(), answer;
    int w;
    for (w = 0; w < m->weight_count; w++) {
        whole = pair_sum(whole, blow_of(m->weights + w, (phase_rate(m, w) - c->rates[w]) * m->rate));
    }
    answer = pair_scaled(whole, c->track->mobility);
    for (w = 0; w < m->weight_count; w++) {
        const SeriesWeight *weight = m->weights + w;
        const double jump = (phase_rate(m, w) - c->rates[w]) * m->rate;
        const Weights one = weights_single(&c->track->weights, w);
        const Pair blow = pair_add_scaled(blow_of(weight, jump), answer, -one.mass);
        moved->turning += weight->race ? series_race_blow(weight, jump, pair_sum(centre, weight->race->place[0]), blow)
                                       : weight->moment * weight->roll * jump + pair_crossed(centre, blow);
    }
    whole = m->from_rotor ? pair_product(whole, pair_direction(angle)) : whole;
    moved->impulse = complex_sum(moved->impulse, complex_of(pair_x(whole), pair_y(whole)));
}

/* Let weights that approach collide, and add their impulses; else decide who touches and rests.  The rotor has turned
   by `angle`. */
static int meet_carried(CarriedWeights *c, double angle, Moved *moved, Failure *failure)
{
    Machine *m = &c->step;
    int w;
    if (!phase_approaches(m)) {
        return phase_decide(m, angle, INSTANT_ORDER)
                   ? fail(failure, "no solution was found for which weights touch and which stick")
                   : FINE;
    }
    for (w = 0; w < m->weight_count; w++) {
        c->rates[w] = phase_rate(m, w);
    }
    if (phase_collide(m, angle, c->impact, failure)) {
        return failure->code;
    }
    add_blows(c, angle, moved);
    return FINE;
}

/* What an event changes; whether it is one of those that are counted. */
static bool pass_carried(Machine *m, PhaseEvent event)
{
    const struct Phase *phase = m->phase;
    int j, w = event.which;
    if (event.kind == WEIGHT_STOPS) {
        const PhaseGroup *group = phase->groups + phase->weights[w].group;
        for (j = 0, w = group->first; j < group->size; j++, w = phase->weights[w].ahead) {
            pair_set(&m->velocity[1 + w / 2], w % 2, 0.0);
            phase->weights[w].slip = 0.0;
        }
    }
    return event.kind != WALL_CHANGES;
}

/* -- the ends of a step ------------------------------------------------------------------------------------- */

static bool keeps_still(const Machine *m, int w)
{
    return m->phase && m->phase->groups[m->phase->weights[w].group].rests;
}

/* Let the machine stand at a time of its series. */
static void stand_at(Machine *m, int order, double time)
{
    int column, w;
    for (column = 1; column < m->width; column++) {
        const Pair angles = machine_place(m, column, order, time);
        const Pair rates = machine_velocity(m, column, order, time);
        for (w = 2 * (column - 1); w < 2 * column && w < m->weight_count; w++) {
            if (!keeps_still(m, w)) { /* rounding must not make it creep */
                pair_set(&m->motion[column], w % 2, pair_at(angles, w % 2));
                pair_set(&m->velocity[column], w % 2, pair_at(rates, w % 2));
            }
        }
    }
    m->collocated_order = 0;
}

/* Write angles and speeds; what rests keeps both to the last digit. */
static void store_weights(const CarriedWeights *c, const Moved *moved)
{
    const Machine *m = &c->step;
    int w;
    for (w = 0; w < m->weight_count; w++) {
        moved->angles[w] = phase_angle(m, w);
        moved->speeds[w] = phase_rate(m, w) * m->rate;
        if (m->phase) {
            moved->contacts[w] = m->phase->weights[w].joined;
        }
    }
}

/* Exact distances and one rate in contacts. */
static int align_weights(const CarriedWeights *c, const Moved *moved, Failure *failure)
{
    WeightsInOrder weights;
    if (!c->track->solid) {
        return FINE;
    }
    if (order_weights(c->track, moved->angles, moved->speeds, moved->contacts, c->scratch, &weights, failure)) {
        return failure->code;
    }
    write_weights(&weights, moved->angles, moved->speeds, moved->contacts);
    return FINE;
}

/* Refuse a step in which weights would turn through too many radians, as far as can be seen, or for `turns` more. */
static int refuse_many(const CarriedWeights *c, const CentreMotion *plane, const double *speeds, double step, double turns,
                       Failure *failure)
{
    const Weights *weights = &c->track->weights;
    const double strength = magnitude(plane->signal[0]) + step * magnitude(plane->signal[1]);
    const double share = (1.0 - (weights->kappa - 1.0) * weights->radius / weights->track_radius) / weights->kappa;
    const double damping_rate = weights_damping_rate(weights);
    /* a run-up leaves free weights behind: they gain s w' * step, or what the drag lets them */
    const double gained = absolute(share * plane->spin.rates[0]) * (damping_rate * step < 1.0 ? step : 1.0 / damping_rate);
    const double largest = largest_of(weights->count, speeds);
    turns += step * (largest + square_root(strength * weights_lever(weights)) + gained) / TURN_PER_SUBSTEP;
    return turns < MAX_SUBSTEPS ? FINE : fail(failure, TOO_MANY_SUBSTEPS, turns, step, strength, largest);
}

/* -- the step ---------------------------------------------------------------------------------------------------- */

int carried_advance(CarriedWeights *c, const CentreMotion *plane, double step, bool stops, Moved *moved,
                    Failure *failure)
{
    Machine *m = &c->step;
    double whole, time = 0.0, angle = 0.0;
    int steps = 0, at_once = 0;
    moved->impulse = complex_of(0.0, 0.0);
    moved->turning = 0.0;
    moved->events = 0;
    moved->reached = step;
    c->worth = infinity();
    if (refuse_many(c, plane, moved->speeds, step, 0.0, failure) || align_weights(c, moved, failure)) {
        return failure->code;
    }
    carried_set_pace(c, absolute(plane->spin.speed) + 1.0 / step + largest_of(c->track->weights.count, moved->speeds));
    carried_load(c, plane->signal, SIGNAL_ORDERS, &plane->spin, moved->angles, moved->speeds, moved->contacts);
    if (m->phase && meet_carried(c, 0.0, moved, failure)) {
        return failure->code;
    }
    for (whole = step * m->rate; time < whole;) {
        PhaseEvent event = {NO_EVENT, 0};
        const double left = whole - time;
        bool is_near;
        int order = 0;
        double length = relax(c, left, &is_near);
        const bool relaxed = length > 0.0;
        if (!relaxed) {
            length = is_near ? smaller(left, FALL_TO_EVENT / (c->fastest * m->per_rate)) : left;
            c->worth = is_near ? FARTHER * length : infinity();
            length = expand_carried(c, angle, length, &order);
        }
        if (!(length > 0.0) || ++steps > (m->phase ? MOST_WITH_EVENTS : MAX_SUBSTEPS)) {
            return refuse_many(c, plane, moved->speeds, step, MAX_SUBSTEPS, failure);
        }
        if (m->phase && !relaxed) {
            event = phase_first_event(m, order, &length);
        }
        at_once = length > LEAST_ADVANCE * whole ? 0 : at_once + 1;
        length = at_once > MOST_AT_ONCE ? smaller(left, LEAST_ADVANCE * whole) : length;
        if (!relaxed) {
            stand_at(m, order, length);
        }
        time = length < left ? time + length : whole;
        angle = machine_carry(m, &c->start, time);
        if (event.kind != NO_EVENT) {
            const bool counts = pass_carried(m, event);
            if (meet_carried(c, angle, moved, failure)) {
                return failure->code;
            }
            moved->events += counts;
            if (counts && stops) {
                moved->reached = time < whole ? time * m->per_rate : step;
                break;
            }
        }
    }
    store_weights(c, moved);
    moved->impulse = complex_product(moved->impulse, rect(1.0, -angle));
    return FINE;
}
