/* The unknowns of a machine's series: what they are multiplied by, and what follows from them. */
#include "machine/machine.h"

IN_LINE Pair machine_coupled_station(const MachineTrack *track, const SeriesWeight *weight, int station)
{
    return pair_scaled(pair_turned(weight->along), track->row[station]);
}

Number machine_coupled_shaft(const Machine *m, const MachineTrack *track, const SeriesWeight *weight)
{
    /* Re((e E)* p) */
    return pair_crossed(weight->along, pair_turned(pair_product(track->offset, m->spin[0]))) - weight->roll;
}

Number machine_coupled(const Machine *m, const MachineTrack *track, const SeriesWeight *weight, int unknown)
{
    return unknown < 2 * m->stations ? pair_at(machine_coupled_station(track, weight, unknown / 2), unknown % 2)
                                     : machine_coupled_shaft(m, track, weight);
}

/* Add what weights on races that are not round have on the row of the shaft. */
static void add_races(const Machine *m, Number *shaft)
{
    const int n = m->stations;
    int t, w, j;
    for (t = 0; t < m->track_count; t++) {
        const MachineTrack *track = m->tracks + t;
        for (w = track->first; w < track->end && track->lobes; w++) {
            const SeriesWeight *weight = m->weights + w;
            const Pair swept = series_race_swept(weight);
            for (j = 0; j < n; j++) {
                shaft[2 * j] += track->row[j] * pair_x(swept);
                shaft[2 * j + 1] += track->row[j] * pair_y(swept);
            }
            shaft[2 * n] += series_race_inertia(weight, pair_product(track->offset, m->spin[0]));
        }
    }
}

IN_LINE void machine_set_carrier(Machine *m)
{
    const int n = m->stations, size = m->unknowns;
    Number *a = m->matrix;
    int i, j;
    for (i = 0; i < 2 * n; i++) {
        for (j = 0; j <= i; j++) {
            a[i * size + j] = i % 2 == j % 2 ? m->mass[i / 2 * n + j / 2] : number_of(0.0);
        }
    }
    if (size > 2 * n) {
        for (j = 0; j < n; j++) {
            const Pair pulled = pair_turned(pair_product(m->unbalance[j], m->spin[0]));
            a[2 * n * size + 2 * j] = pair_x(pulled);
            a[2 * n * size + 2 * j + 1] = pair_y(pulled);
        }
        a[2 * n * size + 2 * n] = m->drive.inertia;
        add_races(m, a + 2 * n * size);
    }
}

IN_LINE Number machine_carried_along(const Machine *m, int k)
{
    return m->drive.motor || k >= m->speed_order ? number_of(0.0) : m->speed[k + 1] * (double)(k + 1);
}

IN_LINE void machine_push_track(Machine *m, const MachineTrack *track, Pair force)
{
    int i;
    for (i = 0; i < m->stations; i++) {
        m->right[2 * i] += track->row[i] * pair_x(force);
        m->right[2 * i + 1] += track->row[i] * pair_y(force);
    }
}

IN_LINE Pair machine_take_pull(Machine *m, MachineTrack *track, int k)
{
    const int n = m->stations;
    Pair a = track->known;
    int i;
    for (i = 0; i < n; i++) {
        a = pair_add_scaled(a, m->acceleration[k * n + i], track->row[i]);
    }
    if (m->drive.motor && track->is_off) {
        a = pair_add_scaled(a, pair_product(track->offset, pair_turned(m->spin[0])), m->right[2 * n]);
    }
    track->pull[k] = pair_turned_back(a);
    return pair_difference(a, track->known);
}

IN_LINE void machine_take_weight(Machine *m, int w, int k, Number acceleration, Number speed_gained, Pair pull, bool is_plain)
{
    SeriesWeight *weight = m->weights + w;
#ifndef SIDE_BY_SIDE
    if (!is_plain && m->from_rotor) {
        acceleration -= speed_gained * (k + 1);
        speed_gained = 0.0;
    }
#endif
    series_weight_finish(weight, k, acceleration, m->per + k + 1);
    if (!is_plain && weight->race) {
        const Number spun = speed_gained * (double)(k + 1);
        series_race_finish(weight, k, acceleration, spun, m->drive.motor ? spun : number_of(0.0), pull);
    }
    pair_set(&m->velocity[(k + 1) * m->width + m->stations + w / 2], w % 2, pair_x(weight->rate[k + 1]) - speed_gained);
}

IN_LINE void machine_advance_weight(Machine *m, const MachineTrack *track, int w, int k, Number carried, bool is_plain)
{
    SeriesWeight *weight = m->weights + w;
    const Number speed = pair_at(m->velocity[k * m->width + m->stations + w / 2], w % 2);
    if (!is_plain && weight->race) {
        const Turning rotor = {m->speed, m->speed_order};
        series_race_advance(weight, k, track->known, speed, carried, rotor);
    } else {
        series_weight_advance(weight, k, track->pull, track->known, speed, carried);
    }
}

IN_LINE Pair machine_weight_force(const SeriesWeight *weight, int k, bool is_plain)
{
    return !is_plain && weight->race ? pair_scaled(series_race_known(weight, k), -weight->race->mass)
                                     : series_weight_force(weight);
}

IN_LINE Pair machine_times_speed(const Machine *m, const Pair *series, int stride, int k)
{
    const int last = k < m->speed_order ? k : m->speed_order;
    Pair sum = pair_scaled(series[k * stride], m->speed[0]);
    int j;
    for (j = 1; j <= last; j++) {
        sum = pair_add_scaled(sum, series[(k - j) * stride], m->speed[j]);
    }
    return sum;
}
