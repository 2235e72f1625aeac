/* The weights of one machine side by side, in a recurrence from order to order. */
#ifndef AUTOBALANCER_ORDERS_BESIDE_H
#define AUTOBALANCER_ORDERS_BESIDE_H

#include <string.h>

#include "machine/machine.h"

#ifndef SIDE_BY_SIDE /* lanes are of machines, or of weights */

/* The two numbers of a vector of a track. */
static IN_LINE void tell_track(Pair vector, double *of_tracks, int track)
{
    of_tracks[2 * track] = pair_x(vector);
    of_tracks[2 * track + 1] = pair_y(vector);
}

/* What was found of a weight. */
static IN_LINE Pair found_beside(const WeightsBeside *beside, unsigned weight)
{
    Pair found;
    memcpy(&found, beside->found + 2 * weight, sizeof found);
    return found;
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
        Pair force = pair_nothing();
        for (w = track->first; w < track->end; w++) {
            force = pair_sum(force, found_beside(beside, (unsigned)w));
        }
        machine_push_track(m, track, force);
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

#endif
