/* Copies of the recurrence from order to order for plain machines, whose motion is not told and who have no motor, no lobes,
   no rings, no restraints and no events. */
#ifndef AUTOBALANCER_ORDERS_COPIES_H
#define AUTOBALANCER_ORDERS_COPIES_H

#include "machine/orders.h"
#include "machine/orders_start.h"

#ifdef SIDE_BY_SIDE
enum { MOST_OF_COPIES = 1 }; /* stations of a plain machine that has one: of more the numbers themselves take the time */
#else
enum { MOST_OF_COPIES = 3 };
#endif

/* Expand a plain machine of so many stations.  No store to a series can change `here`, which no function gets to see
   that is not in line: the compiler need not read it again. */
static IN_LINE void expand_stations(const Machine *m, int order, int stations, bool is_beside)
{
    Machine here = *m;
    here.drive.motor = NULL;
    here.stations = stations;
    here.unknowns = 2 * stations;
    here.beside = is_beside ? m->beside : NULL;
    go_through_orders(&here, order, true, NULL);
}

#ifdef HAS_COPIES

/* Whether it is a planar machine with two weights on a track that is not off, on bearings without cross effects.  From
   LEAST_ORDER on the weights' own series are left as they were: a reaction reads those of a shorter expansion
   (reaction.c). */
static bool is_simple_machine(const Machine *m, int order)
{
    return order >= LEAST_ORDER && m->stations == 1 && m->track_count == 1 && m->weight_count == 2 && !m->tracks->is_off &&
           !m->turns && !m->crossed && !m->varies;
}

/* Start and expand a simple machine: what is known of it is not looked up, and its weights may lie in registers too. */
static IN_LINE void expand_simple(Machine *m, Number angle, int order)
{
    Machine here;
    MachineTrack track = *m->tracks;
#ifdef HAS_TWO_WEIGHTS
    TwoWeights weights, *two = &weights;
    here = *m;
#else /* in lanes there are not registers for a start in line */
    SeriesWeight weights[2];
    TwoWeights *two = NULL;
    machine_start(m, angle);
    here = *m;
    here.weights = weights;
    weights[0] = m->weights[0];
    weights[1] = m->weights[1];
#endif
    here.stations = here.track_count = 1;
    here.unknowns = here.weight_count = here.width = 2;
    here.turns = track.first = track.is_off = 0;
    here.crossed = here.varies = false;
    here.drive.motor = NULL;
    here.beside = NULL;
    here.tracks = &track;
    track.end = 2;
#ifdef HAS_TWO_WEIGHTS
    start_series(&here, angle, false, true);
    two_weights_take(two, here.weights);
#endif
    go_through_orders(&here, order, true, two);
}

#endif

/* Expand a plain machine that has been started, of no more stations than MOST_OF_COPIES. */
static void go_through_copy(const Machine *m, int order, bool is_beside)
{
    switch (m->stations) {
    case 1:
        expand_stations(m, order, 1, is_beside);
        break;
#ifndef SIDE_BY_SIDE
    case 2:
        expand_stations(m, order, 2, is_beside);
        break;
    case MOST_OF_COPIES:
        expand_stations(m, order, MOST_OF_COPIES, is_beside);
        break;
#endif
    }
}

#endif
