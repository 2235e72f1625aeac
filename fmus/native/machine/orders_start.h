/* Where a machine's series start: directions, what is known of order 0, and the factors of the matrix. */
#ifndef AUTOBALANCER_ORDERS_START_H
#define AUTOBALANCER_ORDERS_START_H

#include "machine/machine.h"
#include "machine/orders_beside.h"
#ifndef SIDE_BY_SIDE
#include "machine/phase.h"
#endif

#ifndef SIDE_BY_SIDE
static IN_LINE void start_beside(Machine *m, double angle)
{
    WeightsBeside *beside = m->beside;
    int t, w;
    for (t = 0; t < m->track_count; t++) {
        for (w = m->tracks[t].first; w < m->tracks[t].end; w++) {
            beside->track_of[w] = t;
        }
    }
    for (w = m->weight_count; w % LANES; w++) {
        beside->track_of[w] = beside->track_of[w - 1];
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
static IN_LINE Number angle_in_rotor(const Machine *m, int weight)
{
    return pair_at(m->motion[m->stations + weight / 2], weight % 2);
}

/* Directions of the rotor, and of few weights behind it: at once, where there are lanes. */
static IN_LINE void find_directions(const Machine *m, Number angle, Pair *directions)
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
static IN_LINE void start_weights(Machine *m, Number angle, Number turning, const Pair *directions, bool is_simple)
{
    int w;
    for (w = 0; w < m->weight_count; w++) {
        SeriesWeight *weight = m->weights + w;
        const Number turned = angle_in_rotor(m, w), rate = pair_at(m->velocity[m->stations + w / 2], w % 2);
        weight->rate[0] = pair_both(turning + rate);
        series_weight_start(weight, directions ? directions[w] : pair_direction(angle + turned));
        if (!is_simple && weight->race) {
            series_race_start(weight, turned, rate, m->speed[0]);
        }
    }
}

/* is_beside: the weights are expanded side by side; is_simple: it is a machine of expand_simple. */
static IN_LINE void start_series(Machine *m, Number angle, bool is_beside, bool is_simple)
{
    const int n = m->stations;
    const bool are_few = !is_beside && m->weight_count > 0 && m->weight_count < LANES;
    Pair directions[LANES];
    Number turning = m->speed[0];
    int i;
#ifndef SIDE_BY_SIDE
    if (!is_simple && m->from_rotor) {
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
        start_weights(m, angle, turning, are_few ? directions + 1 : NULL, is_simple);
    }
    for (i = 0; i < n; i++) {
        m->motion[m->width + i] = m->velocity[i];
    }
#ifndef SIDE_BY_SIDE
    if (!is_simple && m->carried) { /* there are no unknowns */
        return;
    }
#endif
    machine_set_carrier(m);
#ifndef SIDE_BY_SIDE
    if (!is_simple && m->phase) {
        phase_factorise(m);
        return;
    }
#endif
    if (is_simple) {
        machine_factorise_planar(m);
        return;
    }
    machine_factorise(m);
}

#endif
