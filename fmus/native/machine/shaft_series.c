/* The row of the shaft in a machine's series: a motor of limited power. */
#include "machine/machine.h"

/* Torque of internal damping on the shaft of order k, Im(q* C_i (v - i w q)). */
static Number damped(Machine *m, int k)
{
    const int n = m->stations;
    const Pair *q = m->motion, *v = m->velocity + k * m->width;
    Number torque = number_of(0.0);
    int i, j;
    for (i = 0; i < n; i++) {
        Pair sheared = pair_zero();
        for (j = 0; j < n; j++) {
            const Pair past = pair_difference(v[j], pair_turned(m->swept[k * n + j]));
            sheared = pair_add_scaled(sheared, past, m->internal_damping[i * n + j]);
        }
        m->sheared[k * n + i] = sheared;
        for (j = 0; j <= k; j++) {
            torque += pair_crossed(q[j * m->width + i], m->sheared[(k - j) * n + i]);
        }
    }
    return torque;
}

/* Torque of the tracks' offsets without phi'' of order k, less that of a weight's mass. */
static Number off_centre(const Machine *m, const MachineTrack *track, const SeriesWeight *weight, int k)
{
    const Pair free = pair_turned(pair_add_scaled(weight->turned, weight->unit[0], weight->free));
    Number sum = pair_crossed(pair_product(track->offset, m->spin[0]), free);
    int j;
    for (j = 1; j <= k; j++) {
        const int second = k - j;
        sum += pair_crossed(pair_product(track->offset, m->spin[j]), weight->unit[second + 2]) *
               ((second + 1.0) * (second + 2.0));
    }
    return sum;
}

void shaft_push(Machine *m, int k)
{
    const MachineDrive *drive = &m->drive;
    const int n = m->stations;
    Number torque = drive->slope * m->speed[k] + (k == 0 ? drive->torque : number_of(0.0));
    int t, w, i, j;
    torque += m->turns ? damped(m, k) : number_of(0.0);
    for (j = 1; j <= k; j++) {
        for (i = 0; i < n; i++) {
            torque -= pair_crossed(pair_product(m->unbalance[i], m->spin[j]), m->acceleration[(k - j) * n + i]);
        }
    }
    for (t = 0; t < m->track_count; t++) {
        const MachineTrack *track = m->tracks + t;
        for (w = track->first; w < track->end; w++) {
            const SeriesWeight *weight = m->weights + w;
            if (weight->race) {
                torque += series_race_torque(weight, k, m->spin, track->offset, track->known);
                continue;
            }
            const Number back = track->is_off ? off_centre(m, track, weight, k) : number_of(0.0);
            torque += weight->torque * pair_at(m->velocity[k * m->width + n + w / 2], w % 2) +
                      weight->moment * (weight->roll * weight->free - back);
        }
    }
    m->right[2 * n] = torque;
}

Number shaft_take(Machine *m, int k)
{
    const Number gained = m->right[2 * m->stations] * m->per[k + 1];
    m->speed[k + 1] = gained;
    m->speed_order = k + 1;
    return gained;
}
