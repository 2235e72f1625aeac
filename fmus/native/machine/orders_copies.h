/* Copies of the recurrence from order to order for plain machines, whose motion is not told and who have no motor, no lobes,
   no rings, no restraints and no events. */
#ifndef AUTOBALANCER_ORDERS_COPIES_H
#define AUTOBALANCER_ORDERS_COPIES_H

#include "machine/orders.h"

enum { MOST_OF_COPIES = 3 }; /* stations of a plain machine that has one */

/* The same for plain machines of so many stations, a copy of its own.  No store to a series can change `here`: the
   compiler need not read it again. */
static IN_LINE void go_through_plain(const Machine *m, int order, int stations, bool is_beside)
{
    Machine here = *m;
    here.stations = stations;
    here.unknowns = 2 * stations;
    here.drive.motor = NULL;
    here.beside = is_beside ? m->beside : NULL;
    go_through_orders(&here, order, true, NULL);
}

#ifdef HAS_COPIES

/* Whether it is a planar machine with two weights on a track that is not off, on bearings without cross effects. */
static bool is_simple_machine(const Machine *m)
{
    return m->stations == 1 && m->track_count == 1 && m->weight_count == 2 && !m->tracks->is_off && !m->turns &&
           !m->crossed && !m->varies;
}

/* The same for such a machine: what is known of it is not looked up, and its weights may lie in registers too. */
static IN_LINE void go_through_simple(const Machine *m, int order)
{
    Machine here = *m;
    MachineTrack track = *m->tracks;
#ifdef HAS_TWO_WEIGHTS
    TwoWeights weights, *two = &weights;
    two_weights_take(two, m->weights);
#else
    SeriesWeight weights[2] = {m->weights[0], m->weights[1]};
    TwoWeights *two = NULL;
    here.weights = weights;
#endif
    here.stations = here.track_count = 1;
    here.unknowns = here.weight_count = here.width = 2;
    here.turns = track.first = track.is_off = 0;
    here.crossed = here.varies = false;
    here.drive.motor = NULL;
    here.beside = NULL;
    here.tracks = &track;
    track.end = 2;
    go_through_orders(&here, order, true, two);
}

#endif

/* The same by a copy, where this machine has one.  From LEAST_ORDER on the weights' own series are left as they were: a
   reaction reads those of a shorter expansion (reaction.c). */
static bool go_through_copy(const Machine *m, int order, bool is_beside)
{
#ifdef HAS_COPIES
    if (order >= LEAST_ORDER && is_simple_machine(m)) {
        go_through_simple(m, order);
        return true;
    }
#endif
    switch (m->stations) {
    case 1:
        go_through_plain(m, order, 1, is_beside);
        return true;
#ifndef SIDE_BY_SIDE /* where of more the numbers themselves take the time */
    case 2:
        go_through_plain(m, order, 2, is_beside);
        return true;
    case MOST_OF_COPIES:
        go_through_plain(m, order, MOST_OF_COPIES, is_beside);
        return true;
#endif
    }
    return false;
}

#endif
