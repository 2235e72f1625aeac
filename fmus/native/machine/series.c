/* A machine's series: their start, and the recurrence by what suits the machine. */
#include "machine/orders_copies.h"

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

#ifndef SIDE_BY_SIDE
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
#endif

/* The angle of a weight in the rotor. */
static Number angle_in_rotor(const Machine *m, int weight)
{
    return pair_at(m->motion[m->stations + weight / 2], weight % 2);
}

/* Directions of the rotor, and of few weights behind it: at once, where there are lanes. */
static void find_directions(const Machine *m, Number angle, Pair *directions)
{
    int w;
#if defined(HAS_LANES) && !defined(SIDE_BY_SIDE)
    double angles[LANES] = {angle};
    for (w = 0; w < m->weight_count; w++) {
        angles[w + 1] = angle + angle_in_rotor(m, w);
    }
    m->lanes->find_directions(angles, (double *)directions);
#else
    directions[0] = pair_direction(angle);
    for (w = 0; w < m->weight_count; w++) {
        directions[w + 1] = pair_direction(angle + angle_in_rotor(m, w));
    }
#endif
}

/* directions: of each weight; NULL: not yet found. */
static void start_weights(Machine *m, Number angle, Number turning, const Pair *directions)
{
    int w;
    for (w = 0; w < m->weight_count; w++) {
        SeriesWeight *weight = m->weights + w;
        const Number turned = angle_in_rotor(m, w), rate = pair_at(m->velocity[m->stations + w / 2], w % 2);
        weight->rate[0] = pair_both(turning + rate);
        series_weight_start(weight, directions ? directions[w] : pair_direction(angle + turned));
        if (weight->race) {
            series_race_start(weight, turned, rate, m->speed[0]);
        }
    }
}

/* `is_beside`: the weights are expanded side by side. */
static void start_series(Machine *m, Number angle, bool is_beside)
{
    const int n = m->stations;
    const bool are_few = !is_beside && m->weight_count > 0 && m->weight_count < LANES;
    Pair directions[LANES];
    Number turning = m->speed[0];
    int i;
#ifndef SIDE_BY_SIDE
    if (m->from_rotor) {
        angle = turning = 0.0;
    }
#endif
    if (are_few) {
        find_directions(m, angle, directions);
    }
    m->spin[0] = are_few ? directions[0] : pair_direction(angle);
    m->spin[1] = pair_scaled(pair_turned(m->spin[0]), turning);
#ifndef SIDE_BY_SIDE
    if (is_beside) {
        start_beside(m, angle);
    }
#endif
    if (!is_beside) {
        start_weights(m, angle, turning, are_few ? directions + 1 : NULL);
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

/* The recurrence of a plain machine, where it has a copy; libraries have them in lanes/copies.c. */
static bool go_through_plainly(const Machine *m, int order, bool is_beside)
{
#if defined(HAS_LANES) && !defined(SIDE_BY_SIDE)
    return m->lanes->go_through(m, order, is_beside);
#else
    return go_through_copy(m, order, is_beside);
#endif
}

void machine_expand(Machine *m, Number angle, int order)
{
    const bool is_plain = is_plain_machine(m);
    bool is_beside = false;
    m->speed_order = m->drive.motor ? 0 : !number_is_zero(m->speed[1]);
#ifndef SIDE_BY_SIDE
    if (m->carried) {
        m->speed_order = m->carried->speed_order;
    }
    is_beside = is_plain && m->beside && order >= LEAST_ORDER && m->stations <= MOST_OF_COPIES;
#endif
    start_series(m, angle, is_beside);
    if (is_plain && go_through_plainly(m, order, is_beside)) {
        return;
    }
#ifndef SIDE_BY_SIDE
    if (m->waves) {
        rings_expand_root(m, order);
    }
#endif
    go_through_orders(m, order, false, NULL);
}
