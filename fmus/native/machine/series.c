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

static void start_any(Machine *m, Number angle, bool is_beside)
{
    start_series(m, angle, is_beside, false);
}

void machine_start(Machine *m, Number angle)
{
    start_any(m, angle, false);
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

/* A library has the copies in lanes/copies.c. */
#if defined(HAS_LANES) && !defined(SIDE_BY_SIDE)
#define EXPAND_SIMPLE m->lanes->expand_simple
#define GO_THROUGH_COPY m->lanes->go_through
#else
#define EXPAND_SIMPLE expand_simple
#define GO_THROUGH_COPY go_through_copy
#endif

void machine_expand(Machine *m, Number angle, int order)
{
    const bool has_copy = m->stations <= MOST_OF_COPIES && is_plain_machine(m);
    bool is_beside = false;
    m->speed_order = m->drive.motor ? 0 : !number_is_zero(m->speed[1]);
#ifndef SIDE_BY_SIDE
    if (m->carried) {
        m->speed_order = m->carried->speed_order;
    }
    is_beside = has_copy && m->beside && order >= LEAST_ORDER;
#endif
#ifdef HAS_COPIES
    if (has_copy && is_simple_machine(m, order)) {
        EXPAND_SIMPLE(m, angle, order);
        return;
    }
#endif
    start_any(m, angle, is_beside);
    if (has_copy) {
        GO_THROUGH_COPY(m, order, is_beside);
        return;
    }
#ifndef SIDE_BY_SIDE
    if (m->waves) {
        rings_expand_root(m, order);
    }
#endif
    go_through_orders(m, order, false, NULL);
}
