/* The recurrence of a machine's series from order to order, put in line where it is used. */
#ifndef AUTOBALANCER_ORDERS_H
#define AUTOBALANCER_ORDERS_H

#include "machine/machine.h"
#include "machine/orders_beside.h"
#ifndef SIDE_BY_SIDE /* machines with events go on alone */
#include "machine/phase.h"
#include "machine/restraints.h"
#include "machine/rings.h"
#endif
#ifndef HAS_TWO_WEIGHTS /* of lanes/two_weights.h */
typedef void TwoWeights;
#endif

/* What w' leads E'' to without that of order k, and with it where it is prescribed. */
static IN_LINE Pair spun(const Machine *m, int k)
{
    const int last = k < m->speed_order ? k : m->speed_order;
    Pair sum = pair_scaled(m->spin[k + 1], m->speed[0]);
    int j;
    for (j = 1; j <= last; j++) {
        sum = pair_add_scaled(sum, m->spin[k + 1 - j], m->speed[j]);
    }
    if (!m->drive.motor && k < m->speed_order) {
        sum = pair_add_scaled(sum, m->spin[0], m->speed[k + 1]);
    }
    return pair_scaled(pair_turned(sum), number_of(k + 1));
}

/* What bearings that change with the speed pull by w, of order k. */
static IN_LINE Pair sloped(Machine *m, int i, int k)
{
    const int n = m->stations;
    const Pair *q = m->motion + k * m->width, *v = m->velocity + k * m->width;
    Pair sum = pair_zero();
    int j;
    for (j = 0; j < n; j++) {
        const int at = i * n + j;
        sum = pair_add_times(sum, m->stiffness_slope[at], q[j]);
        sum = pair_add_times(sum, m->damping_slope[at], v[j]);
        sum = pair_add_times(sum, m->cross_stiffness_slope[at], pair_swapped(q[j]));
        sum = pair_add_times(sum, m->cross_damping_slope[at], pair_swapped(v[j]));
    }
    m->sloped[k * n + i] = sum;
    return machine_times_speed(m, m->sloped + i, n, k);
}

/* Forces on the stations of order k, apart from the weights'. */
static IN_LINE void push_stations(Machine *m, int k, Pair spun_twice, bool is_plain)
{
    const int n = m->stations;
    const Pair *q = m->motion + k * m->width, *v = m->velocity + k * m->width;
    int i, j;
    for (i = 0; i < n; i++) {
        Pair sum = pair_negative(pair_product(m->unbalance[i], spun_twice));
        for (j = 0; j < n; j++) {
            const Pair sprung = pair_times(m->stiffness[i * n + j], q[j]);
            sum = pair_difference(sum, pair_add_times(sprung, m->damping[i * n + j], v[j]));
        }
        for (j = 0; j < n && m->crossed; j++) {
            const Pair sprung = pair_times(m->cross_stiffness[i * n + j], pair_swapped(q[j]));
            sum = pair_difference(sum, pair_add_times(sprung, m->cross_damping[i * n + j], pair_swapped(v[j])));
        }
        if (m->varies) {
            sum = pair_difference(sum, sloped(m, i, k));
        }
        if (m->turns) {
            Pair turning = pair_zero();
            for (j = 0; j < n; j++) {
                const Pair damped = pair_scaled(q[j], m->internal_damping[i * n + j]);
                turning = pair_sum(turning, pair_add_scaled(damped, v[j], m->gyroscopic[i * n + j]));
            }
            m->turning[k * n + i] = turning;
            sum = pair_sum(sum, pair_turned(machine_times_speed(m, m->turning + i, n, k)));
            if (m->drive.motor) {
                m->swept[k * n + i] = machine_times_speed(m, m->motion + i, m->width, k);
            }
        }
        if (k < SIGNAL_ORDERS) {
            sum = pair_sum(sum, m->push[k * n + i]);
        }
#ifndef SIDE_BY_SIDE
        if (!is_plain && m->waves && machine_is_wave(m, i)) {
            sum = pair_sum(sum, rings_push(m, i, k));
        }
#endif
        m->right[2 * i] = pair_x(sum);
        m->right[2 * i + 1] = pair_y(sum);
    }
}

static IN_LINE void push_weights(Machine *m, int k, Pair spun_twice, bool is_plain)
{
    const Number carried = machine_carried_along(m, k);
    int t, w;
    for (t = 0; t < m->track_count; t++) {
        MachineTrack *track = m->tracks + t;
        Pair force = pair_nothing();
        track->known = track->is_off ? pair_product(track->offset, spun_twice) : pair_zero();
        for (w = track->first; w < track->end; w++) {
            machine_advance_weight(m, track, w, k, carried, is_plain);
            force = pair_sum(force, machine_weight_force(m->weights + w, k, is_plain));
        }
        machine_push_track(m, track, force);
    }
}

/* Coefficients of order k from the solution; the motion's of k + 2 but for the weights of k + 1. */
static IN_LINE void take_stations(Machine *m, int k)
{
    const int n = m->stations, falling = k == 0 ? n - m->waves : 0;
    Pair *v = m->velocity + (k + 1) * m->width, *q = m->motion + (k + 2) * m->width;
    int i;
    for (i = 0; i < n; i++) {
        const Pair a = pair_of(m->right[2 * i], m->right[2 * i + 1]);
        m->acceleration[k * n + i] = a;
        v[i] = pair_scaled(i < falling ? pair_sum(a, m->gravity) : a, number_of(m->per[k + 1]));
        q[i] = pair_scaled(v[i], number_of(m->per[k + 2]));
    }
}

static IN_LINE void take_weights(Machine *m, int k, Number speed_gained, bool is_plain)
{
    const int n = m->stations;
    int t, w;
    for (t = 0; t < m->track_count; t++) {
        MachineTrack *track = m->tracks + t;
        const Pair a = machine_take_pull(m, track, k); /* the rest is in 'free' already */
        for (w = track->first; w < track->end; w++) {
            SeriesWeight *weight = m->weights + w;
            Number pulled = series_weight_pulled(weight, a);
            if (m->drive.motor) {
                pulled -= weight->roll * m->right[2 * n];
            }
            machine_take_weight(m, w, k, weight->free - weight->lever * pulled, speed_gained, track->pull[k],
                                is_plain);
        }
    }
}

static IN_LINE void take_angles(Machine *m, int k)
{
    int w;
    for (w = m->stations; w < m->width; w++) {
        m->motion[(k + 1) * m->width + w] = pair_scaled(m->velocity[k * m->width + w], number_of(m->per[k + 1]));
    }
}

#ifndef SIDE_BY_SIDE
/* A of order k where it is told. */
static IN_LINE void carry_station(Machine *m, int k)
{
    Pair sum = m->from_rotor && k < SIGNAL_ORDERS ? m->carried->signal[k] : pair_zero();
    int j;
    for (j = 0; j <= k && j < SIGNAL_ORDERS && !m->from_rotor; j++) {
        sum = pair_sum(sum, pair_product(m->carried->signal[j], m->spin[k - j]));
    }
    m->right[0] = pair_x(sum);
    m->right[1] = pair_y(sum);
}
#endif

/* The unknowns of order k. */
static IN_LINE void solve_order(Machine *m, int k)
{
#ifndef SIDE_BY_SIDE
    if (m->carried) {
        carry_station(m, k);
        return;
    }
#endif
    machine_solve(m, m->right);
}

/* What restrains the rotor, what holds together, and what sticks, once all else is known. */
static IN_LINE void push_events(Machine *m, int k)
{
#ifndef SIDE_BY_SIDE
    if (m->restraints) {
        restraints_push(m, k);
    }
    if (m->phase && m->drive.motor) {
        phase_push_shaft(m, k);
    }
    if (m->phase) {
        phase_push_sliders(m, k);
    }
#endif
}

static IN_LINE bool has_phase(const Machine *m)
{
#ifdef SIDE_BY_SIDE
    return false;
#else
    return m->phase;
#endif
}

static IN_LINE bool is_carried(const Machine *m)
{
#ifdef SIDE_BY_SIDE
    return false;
#else
    return m->carried;
#endif
}

static IN_LINE bool sees_from_rotor(const Machine *m)
{
    return is_carried(m) && m->from_rotor;
}

static IN_LINE void push_plain_weights(Machine *m, int k, Pair spun_twice, TwoWeights *two)
{
#ifdef HAS_TWO_WEIGHTS
    if (two) {
        m->tracks->known = pair_zero();
        two_weights_advance(two, k, m->tracks->pull, m->tracks->known, numbers_of_pair(m->velocity[k * m->width + m->stations]),
                            machine_carried_along(m, k));
        machine_push_track(m, m->tracks, pairs_added(two_weights_force(two)));
        return;
    }
#endif
#ifndef SIDE_BY_SIDE
    if (m->beside) {
        push_beside(m, k, spun_twice);
        return;
    }
#endif
    push_weights(m, k, spun_twice, true);
}

/* Push all but the stations, and solve for the unknowns of order k. */
static IN_LINE void push_and_solve(Machine *m, int k, Pair spun_twice, bool is_plain, TwoWeights *two)
{
    if (is_plain) {
        push_plain_weights(m, k, spun_twice, two);
        machine_solve_factors(m, m->right);
        return;
    }
#ifndef SIDE_BY_SIDE
    if (m->phase) {
        phase_push_weights(m, k, spun_twice);
    }
#endif
    if (!has_phase(m)) {
        push_weights(m, k, spun_twice, false);
    }
    if (m->drive.motor) {
        shaft_push(m, k);
    }
    push_events(m, k);
    solve_order(m, k);
}

static IN_LINE void take_all_weights(Machine *m, int k, Number speed_gained, bool is_plain, TwoWeights *two)
{
#ifdef HAS_TWO_WEIGHTS
    if (two) {
        const NumberOfTwo pulled = two_weights_pulled(two, machine_take_pull(m, m->tracks, k));
        two_weights_finish(two, k, two->free - two->lever * pulled, m->per + k + 1);
        m->velocity[(k + 1) * m->width + m->stations] = pair_of_numbers(pairs_x(two->rate[k + 1]) - speed_gained);
        return;
    }
#endif
#ifndef SIDE_BY_SIDE
    if (!is_plain && m->phase) {
        phase_take(m, k, speed_gained);
        return;
    }
    if (is_plain && m->beside) {
        take_beside(m, k, speed_gained);
        return;
    }
#endif
    take_weights(m, k, speed_gained, is_plain);
}

/* E'' of order k without what waits for w'. */
static IN_LINE Pair turn_twice(const Machine *m, int k)
{
#ifndef SIDE_BY_SIDE
    if (m->from_rotor) {
        return m->tracks->is_off ? machine_turn_twice(m, k) : pair_zero();
    }
#endif
    return spun(m, k);
}

/* The recurrence from order to order.  Of a plain machine (is_plain_machine) no function that is not in line gets to
   see m, so that it may lie in registers.  two: its weights, where they are two side by side; else NULL. */
static IN_LINE void go_through_orders(Machine *m, int order, bool is_plain, TwoWeights *two)
{
    int k;
    for (k = 0; k <= order - 2; k++) {
        Pair spun_twice = is_plain ? spun(m, k) : turn_twice(m, k);
        Number gained = !m->drive.motor && k < m->speed_order ? m->speed[k + 1] : number_of(0.0);
        if (is_plain || !is_carried(m)) {
            push_stations(m, k, spun_twice, is_plain);
        }
        push_and_solve(m, k, spun_twice, is_plain, two);
        take_stations(m, k);
        if (!is_plain && m->drive.motor) {
            gained = shaft_take(m, k);
        }
        take_all_weights(m, k, gained, is_plain, two);
        take_angles(m, k);
        if (m->drive.motor) {
            spun_twice = pair_add_scaled(spun_twice, pair_turned(m->spin[0]), gained * (double)(k + 1));
        }
        m->spin[k + 2] = !is_plain && sees_from_rotor(m) ? pair_zero() : pair_scaled(spun_twice, number_of(m->per[k + 1] * m->per[k + 2]));
    }
    for (k = m->stations; k < m->width; k++) { /* the last of the weights' angles */
        m->motion[order * m->width + k] = pair_scaled(m->velocity[(order - 1) * m->width + k], number_of(m->per[order]));
    }
}

#endif
