/* Weights of a track in a phase: what does not change of them, and who stands before whom. */
#include "base/elementary.h"
#include "constants.h"
#include "contact/spacing.h"
#include "machine/phase.h"

void phase_take_track(Machine *m, int number, const Track *track)
{
    const MachineTrack *made = m->tracks + number;
    int w;
    for (w = made->first; w < made->end; w++) {
        PhaseWeight *own = m->phase->weights + w;
        own->track = number;
        own->lasts = track->full;
        own->radius = track->weights.track_radius;
        own->touch = track_touch(track);
        own->grip = own->touch.resistance;
    }
}

void phase_order_track(const Machine *m, const Track *track, int first)
{
    PhaseWeight *all = m->phase->weights + first;
    const int n = track->weights.count;
    int j, k;
    for (k = 0; k < n; k++) {
        all[k].within = modulo(phase_angle(m, first + k), TAU);
    }
    for (k = 0; k < n; k++) {
        const double at = all[k].within;
        double nearest_ahead = infinity();
        int ahead = -1;
        /* who is ahead: among equals the next by number */
        for (j = 1; j < n && track->solid; j++) {
            const int other = k + j < n ? k + j : k + j - n;
            const double there = all[other].within;
            const int wraps = there < at || (there == at && other < k);
            const double apart = there - at + (wraps ? TAU : 0.0);
            if (apart < nearest_ahead) {
                nearest_ahead = apart;
                ahead = other;
            }
        }
        all[k].ahead = ahead < 0 ? -1 : first + ahead;
        if (ahead >= 0) {
            const Weights one = weights_single(&track->weights, k), next = weights_single(&track->weights, ahead);
            all[k].spacing = track->weights.each
                                 ? 2.0 * half_angle(0.5 * (one.radius + next.radius), one.track_radius)
                                 : 2.0 * track->alpha;
        }
    }
}
