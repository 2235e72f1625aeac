/* The recurrence of a machine's series. */
#include "base/elementary.h"
#include "machine/machine.h"
#ifndef SIDE_BY_SIDE /* machines with events go on alone */
#include "machine/phase.h"
#include "machine/restraints.h"
#include "machine/rings.h"
#endif

enum { MOST_OF_COPIES = 3 }; /* stations of a plain machine that has a copy of the recurrence */

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

#ifndef SIDE_BY_SIDE
Pair machine_turn_twice(const Machine *m, int k)
{
    double square = 0.0;
    int j;
    for (j = 0; j <= k && j <= m->speed_order; j++) {
        square += k - j <= m->speed_order ? m->speed[j] * m->speed[k - j] : 0.0;
    }
    return pair_of(-square, k < m->speed_order ? m->speed[k + 1] * (k + 1) : 0.0);
}
#endif

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

static IN_LINE void push_track(Machine *m, const MachineTrack *track, Pair force)
{
    int i;
    for (i = 0; i < m->stations; i++) {
        m->right[2 * i] += track->row[i] * pair_x(force);
        m->right[2 * i + 1] += track->row[i] * pair_y(force);
    }
}

static IN_LINE void push_weights(Machine *m, int k, Pair spun_twice, bool is_plain)
{
    const Number carried = machine_carried_along(m, k);
    int t, w;
    for (t = 0; t < m->track_count; t++) {
        MachineTrack *track = m->tracks + t;
        Pair force = pair_zero();
        track->known = track->is_off ? pair_product(track->offset, spun_twice) : force;
        for (w = track->first; w < track->end; w++) {
            machine_advance_weight(m, track, w, k, carried, is_plain);
            force = pair_sum(force, machine_weight_force(m->weights + w, k, is_plain));
        }
        push_track(m, track, force);
    }
}

/* The same of a simple machine. */
static IN_LINE void push_simple_weights(Machine *m, int k)
{
    const Pair *speed = m->velocity + k * m->width + 1;
    const Number speeds[MOST_TOGETHER] = {pair_x(*speed), pair_y(*speed)};
    MachineTrack *track = m->tracks;
    Pair force = pair_zero();
    int w;
    track->known = force;
    series_weights_advance(m->weights, MOST_TOGETHER, k, track->pull, force, speeds, machine_carried_along(m, k));
    for (w = 0; w < MOST_TOGETHER; w++) {
        force = pair_sum(force, series_weight_force(m->weights + w));
    }
    push_track(m, track, force);
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

/* -- weights side by side -------------------------------------------------------------------------------- */

#ifndef SIDE_BY_SIDE

/* The two numbers of a vector of a track. */
static IN_LINE void tell_track(Pair vector, double *of_tracks, int track)
{
    of_tracks[2 * track] = pair_x(vector);
    of_tracks[2 * track + 1] = pair_y(vector);
}

/* What was found of a weight. */
static IN_LINE Pair found_beside(const WeightsBeside *beside, unsigned weight)
{
    const double *found = beside->found + weight + weight / LANES * LANES;
    return pair_of(found[0], found[LANES]);
}

static void start_beside(Machine *m, double angle)
{
    WeightsBeside *beside = m->beside;
    int t, w;
    for (t = 0; t < m->track_count; t++) {
        for (w = m->tracks[t].first; w < m->tracks[t].end; w++) {
            beside->track_of[w] = t;
        }
    }
    beside->weights = m->weight_count;
    beside->by->start_beside(beside, &m->weights->moment, sizeof *m->weights / sizeof(double), angle, m->speed[0],
                             (const double *)(m->motion + m->stations), (const double *)(m->velocity + m->stations));
    for (w = 0; w < m->weight_count; w++) { /* for the matrix */
        m->weights[w].along = found_beside(beside, (unsigned)w);
    }
}

static IN_LINE void push_beside(Machine *m, int k, Pair spun_twice)
{
    const WeightsBeside *beside = m->beside;
    int t, w;
    for (t = 0; t < m->track_count; t++) {
        MachineTrack *track = m->tracks + t;
        track->known = track->is_off ? pair_product(track->offset, spun_twice) : pair_zero();
        tell_track(track->known, beside->known, t);
    }
    beside->by->push_beside(m->beside, k, (const double *)(m->velocity + k * m->width + m->stations),
                            machine_carried_along(m, k));
    for (t = 0; t < m->track_count; t++) {
        const MachineTrack *track = m->tracks + t;
        Pair force = pair_zero();
        for (w = track->first; w < track->end; w++) {
            force = pair_sum(force, found_beside(beside, (unsigned)w));
        }
        push_track(m, track, force);
    }
}

static IN_LINE void take_beside(Machine *m, int k, double speed_gained)
{
    const WeightsBeside *beside = m->beside;
    int t;
    for (t = 0; t < m->track_count; t++) {
        tell_track(machine_take_pull(m, m->tracks + t, k), beside->moved, t);
        tell_track(m->tracks[t].pull[k], beside->pull, t);
    }
    beside->by->take_beside(m->beside, k, speed_gained, m->per + k + 1,
                            (double *)(m->velocity + (k + 1) * m->width + m->stations));
}

#endif

/* -- the start --------------------------------------------------------------------------------------------- */

static void start_weights(Machine *m, Number angle, Number turning)
{
    const int n = m->stations;
    int t, w;
    for (t = 0; t < m->track_count; t++) {
        for (w = m->tracks[t].first; w < m->tracks[t].end; w++) {
            SeriesWeight *weight = m->weights + w;
            const Number turned = pair_at(m->motion[n + w / 2], w % 2), rate = pair_at(m->velocity[n + w / 2], w % 2);
            weight->rate[0] = pair_both(turning + rate);
            series_weight_start(weight, angle + turned);
            if (weight->race) {
                series_race_start(weight, turned, rate, m->speed[0]);
            }
        }
    }
}

/* `is_beside`: the weights are expanded side by side. */
static void start_series(Machine *m, Number angle, bool is_beside)
{
    const int n = m->stations;
    int i;
    Number turning = m->speed[0];
#ifndef SIDE_BY_SIDE
    if (m->from_rotor) {
        angle = turning = 0.0;
    }
#endif
    m->spin[0] = pair_direction(angle);
    m->spin[1] = pair_scaled(pair_turned(m->spin[0]), turning);
#ifndef SIDE_BY_SIDE
    if (is_beside) {
        start_beside(m, angle);
    }
#endif
    if (!is_beside) {
        start_weights(m, angle, turning);
    }
    for (i = 0; i < n; i++) {
        m->motion[m->width + i] = m->velocity[i];
    }
#ifndef SIDE_BY_SIDE
    if (m->carried) { /* there are no unknowns */
        return;
    }
#endif
    machine_set_carrier(m);
#ifndef SIDE_BY_SIDE
    if (m->phase) {
        phase_factorise(m);
        return;
    }
#endif
    machine_take_off_weights(m);
    machine_factorise(m);
}

void machine_start(Machine *m, Number angle)
{
    start_series(m, angle, false);
}

#ifndef SIDE_BY_SIDE
/* A of order k where it is told. */
static void carry_station(Machine *m, int k)
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
static void push_events(Machine *m, int k)
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

static bool has_phase(const Machine *m)
{
#ifdef SIDE_BY_SIDE
    return false;
#else
    return m->phase;
#endif
}

static bool is_carried(const Machine *m)
{
#ifdef SIDE_BY_SIDE
    return false;
#else
    return m->carried;
#endif
}

static bool sees_from_rotor(const Machine *m)
{
    return is_carried(m) && m->from_rotor;
}

static IN_LINE void push_plain_weights(Machine *m, int k, Pair spun_twice, bool is_simple)
{
    if (is_simple) {
        push_simple_weights(m, k);
        return;
    }
#ifndef SIDE_BY_SIDE
    if (m->beside) {
        push_beside(m, k, spun_twice);
        return;
    }
#endif
    push_weights(m, k, spun_twice, true);
}

/* Push all but the stations, and solve for the unknowns of order k. */
static IN_LINE void push_and_solve(Machine *m, int k, Pair spun_twice, bool is_plain, bool is_simple)
{
    if (is_plain) {
        push_plain_weights(m, k, spun_twice, is_simple);
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

static IN_LINE void take_all_weights(Machine *m, int k, Number speed_gained, bool is_plain)
{
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
   see m, so that it may lie in registers. */
static IN_LINE void go_through_orders(Machine *m, int order, bool is_plain, bool is_simple)
{
    int k;
    for (k = 0; k <= order - 2; k++) {
        Pair spun_twice = is_plain ? spun(m, k) : turn_twice(m, k);
        Number gained = !m->drive.motor && k < m->speed_order ? m->speed[k + 1] : number_of(0.0);
        if (is_plain || !is_carried(m)) {
            push_stations(m, k, spun_twice, is_plain);
        }
        push_and_solve(m, k, spun_twice, is_plain, is_simple);
        take_stations(m, k);
        if (!is_plain && m->drive.motor) {
            gained = shaft_take(m, k);
        }
        take_all_weights(m, k, gained, is_plain);
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

/* Whether a machine's motion is not told, and it has no motor, no lobes, no rings, no restraints and no events. */
static bool is_plain_machine(const Machine *m)
{
    int t;
    for (t = 0; t < m->track_count; t++) {
        if (m->tracks[t].lobes) {
            return false;
        }
    }
#ifndef SIDE_BY_SIDE
    if (m->carried || m->from_rotor || m->waves || m->restraints || m->phase) {
        return false;
    }
#endif
    return !m->drive.motor;
}

/* The same for plain machines of so many stations, a copy of its own.  No store to a series can change `here`: the
   compiler need not read it again. */
static IN_LINE void go_through_plain(const Machine *m, int order, int stations, bool is_beside)
{
    Machine here = *m;
    here.stations = stations;
    here.unknowns = 2 * stations;
    here.drive.motor = NULL;
    here.beside = is_beside ? m->beside : NULL;
    go_through_orders(&here, order, true, false);
}

#ifdef HAS_COPIES

/* Whether it is a planar machine with two weights on a track that is not off, on bearings without cross effects. */
static bool is_simple_machine(const Machine *m)
{
    return m->stations == 1 && m->track_count == 1 && m->weight_count == MOST_TOGETHER && !m->tracks->is_off && !m->turns &&
           !m->crossed && !m->varies;
}

/* The same for such a machine: what is known of it is not looked up, and its weights may lie in registers too. */
static void go_through_simple(const Machine *m, int order)
{
    Machine here = *m;
    MachineTrack track = *m->tracks;
    SeriesWeight weights[MOST_TOGETHER];
    int k;
    for (k = 0; k < MOST_TOGETHER; k++) {
        weights[k] = m->weights[k];
    }
    here.stations = here.track_count = 1;
    here.unknowns = here.weight_count = here.width = 2;
    here.turns = track.first = track.is_off = 0;
    here.crossed = here.varies = false;
    here.drive.motor = NULL;
    here.beside = NULL;
    here.tracks = &track;
    here.weights = weights;
    track.end = MOST_TOGETHER;
    go_through_orders(&here, order, true, true);
}

#endif

void machine_expand(Machine *m, Number angle, int order)
{
    bool is_plain, is_beside;
    m->speed_order = m->drive.motor ? 0 : !number_is_zero(m->speed[1]);
#ifndef SIDE_BY_SIDE
    if (m->carried) {
        m->speed_order = m->carried->speed_order;
    }
#endif
    is_plain = is_plain_machine(m);
    is_beside = is_plain && m->beside && order >= LEAST_ORDER && m->stations <= MOST_OF_COPIES;
    start_series(m, angle, is_beside);
#ifdef HAS_COPIES
    if (is_plain && is_simple_machine(m)) {
        go_through_simple(m, order);
        return;
    }
#endif
#ifdef SIDE_BY_SIDE
    if (is_plain && m->stations == 1) { /* of more the numbers themselves take the time */
        go_through_plain(m, order, 1, false);
        return;
    }
#else
    if (m->waves) {
        rings_expand_root(m, order);
    }
    switch (is_plain ? m->stations : 0) {
    case 1:
        go_through_plain(m, order, 1, is_beside);
        return;
    case 2:
        go_through_plain(m, order, 2, is_beside);
        return;
    case MOST_OF_COPIES:
        go_through_plain(m, order, MOST_OF_COPIES, is_beside);
        return;
    }
#endif
    go_through_orders(m, order, false, false);
}
