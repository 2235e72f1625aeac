/* Series of a machine in one phase. */
#include "machine/phase.h"

#include "base/elementary.h"

/* The number that multiplies an unknown in Re(a p*). */
static double pressed(const Machine *m, const MachineTrack *track, const SeriesWeight *weight, int unknown)
{
    const Pair p = weight->unit[0];
    if (unknown < 2 * m->stations) {
        return track->row[unknown / 2] * pair_at(p, unknown % 2);
    }
    return pair_crossed(pair_product(track->offset, m->spin[0]), p);
}

/* -- the matrix ------------------------------------------------------------------------------ */

/* The rows of a group: means of those of its weights.  Their shares change along a race that is not round. */
static void fill_rows(const Machine *m, PhaseGroup *group)
{
    const struct Phase *phase = m->phase;
    const int size = m->unknowns;
    int j, i, w = group->first;
    group->share = m->weights[w].share;
    for (j = 1, w = phase->weights[w].ahead; j < group->size; j++, w = phase->weights[w].ahead) {
        group->share += m->weights[w].share;
    }
    w = group->first;
    for (i = 0; i < size; i++) {
        group->row[i] = group->action[i] = 0.0;
    }
    for (j = 0; j < group->size; j++, w = phase->weights[w].ahead) {
        const PhaseWeight *own = phase->weights + w;
        const MachineTrack *track = m->tracks + own->track;
        const SeriesWeight *weight = m->weights + w;
        const double part = weight->share / group->share, grip = own->slip * own->side * own->grip;
        for (i = 0; i < size; i++) {
            const double along = part * machine_coupled(m, track, weight, i);
            group->row[i] += along;
            group->action[i] += along;
            if (grip != 0.0) {
                group->action[i] -= part * grip * pressed(m, track, weight, i);
            }
        }
    }
}

/* What a group that rests adds to a machine whose shaft's acceleration is unknown: it goes with it. */
static void add_resting(Machine *m, const PhaseGroup *group)
{
    const struct Phase *phase = m->phase;
    const int size = m->unknowns, shaft = size - 1;
    int i, j, w = group->first;
    for (j = 0; j < group->size; j++, w = phase->weights[w].ahead) {
        const SeriesWeight *weight = m->weights + w;
        for (i = 0; i < size; i++) {
            const double along =
                weight->moment * machine_coupled(m, m->tracks + phase->weights[w].track, weight, i);
            m->matrix[i * size + shaft] += along;
            m->matrix[shaft * size + i] += along;
        }
        m->matrix[shaft * size + shaft] += weight->moment / weight->lever;
    }
}

/* The torque on the shaft of resistance, in so far as the load depends on the unknowns. */
static void add_shaft_resistance(Machine *m)
{
    const struct Phase *phase = m->phase;
    const int size = m->unknowns, shaft = size - 1;
    int i, w;
    for (w = 0; w < m->weight_count; w++) {
        const PhaseWeight *own = phase->weights + w;
        const double grip = own->slip * own->side * own->grip * m->weights[w].moment;
        for (i = 0; i < size && grip != 0.0; i++) {
            m->matrix[shaft * size + i] += grip * pressed(m, m->tracks + own->track, m->weights + w, i);
        }
    }
}

/* Rows of sliders that stick: their acceleration is known. */
static void hold_sliders(Machine *m)
{
    const struct Phase *phase = m->phase;
    const int size = m->unknowns;
    int j, i;
    for (j = 0; j < phase->slider_count; j++) {
        PhaseSlider *slider = phase->sliders + j;
        double *row = m->matrix + slider->place * size;
        if (slider->slip == 0.0 && slider->stiffness == 0.0) {
            for (i = 0; i < size; i++) {
                slider->held[i] = row[i];
                row[i] = i == slider->place ? 1.0 : 0.0;
            }
        }
    }
}

void phase_factorise(Machine *m)
{
    const struct Phase *phase = m->phase;
    const int size = m->unknowns, has_shaft = size > 2 * m->stations;
    double *a = m->matrix;
    int i, j, k;
    for (i = 0; i < size; i++) {
        for (j = 0; j < i; j++) {
            a[j * size + i] = a[i * size + j];
        }
    }
    for (k = 0; k < phase->group_count; k++) {
        PhaseGroup *group = phase->groups + k;
        if (group->rests) {
            if (has_shaft) {
                add_resting(m, group);
            }
            continue;
        }
        fill_rows(m, group);
        for (i = 0; i < size; i++) {
            for (j = 0; j < size; j++) {
                a[i * size + j] -= group->share * group->row[i] * group->action[j];
            }
        }
    }
    if (has_shaft) {
        add_shaft_resistance(m);
    }
    hold_sliders(m);
    for (k = 0; k < size; k++) { /* near to a mass matrix, so that no rows need be exchanged */
        a[k * size + k] = 1.0 / a[k * size + k];
        for (i = k + 1; i < size; i++) {
            a[i * size + k] *= a[k * size + k];
            for (j = k + 1; j < size; j++) {
                a[i * size + j] -= a[i * size + k] * a[k * size + j];
            }
        }
    }
}

void phase_solve(const Machine *m, double *b)
{
    const int size = m->unknowns;
    const double *a = m->matrix;
    int i, k;
    for (i = 0; i < size; i++) {
        for (k = 0; k < i; k++) {
            b[i] -= a[i * size + k] * b[k];
        }
    }
    for (i = size - 1; i >= 0; i--) {
        for (k = i + 1; k < size; k++) {
            b[i] -= a[i * size + k] * b[k];
        }
        b[i] *= a[i * size + i];
    }
}

/* -- right-hand sides -------------------------------------------------------------------------- */

double phase_turning(const Machine *m, const SeriesWeight *weight, int k)
{
    const double rate = pair_x(weight->rate[k]);
    return m->from_rotor && k <= m->speed_order ? rate + m->speed[k] : rate;
}

/* Load of order k, in so far as it does not wait for the acceleration of that order. */
static double known_load(const Machine *m, const MachineTrack *track, const SeriesWeight *weight, double radius, int k)
{
    double turning = 0.0, pulled = pair_crossed(pair_turned_back(track->known), weight->unit[0]);
    int j;
    for (j = 0; j <= k; j++) {
        turning += phase_turning(m, weight, j) * phase_turning(m, weight, k - j);
    }
    for (j = 0; j < k; j++) {
        pulled += pair_crossed(track->pull[j], weight->unit[k - j]);
    }
    return radius * turning - pulled;
}

/* Give each weight the free acceleration of its group. */
static void average(Machine *m, int k)
{
    const struct Phase *phase = m->phase;
    int g, j, w;
    for (g = 0; g < phase->group_count; g++) {
        const PhaseGroup *group = phase->groups + g;
        double sum = 0.0;
        for (j = 0, w = group->first; j < group->size; j++, w = phase->weights[w].ahead) {
            sum += m->weights[w].share * phase->weights[w].free;
        }
        sum = group->rests ? machine_carried_along(m, k) : sum / group->share;
        for (j = 0, w = group->first; j < group->size; j++, w = phase->weights[w].ahead) {
            m->weights[w].free = sum;
        }
    }
}

void phase_push_weights(Machine *m, int k, Pair spun_twice)
{
    const struct Phase *phase = m->phase;
    const int n = m->stations;
    const double carried = machine_carried_along(m, k);
    int t, w, i;
    for (t = 0; t < m->track_count; t++) {
        MachineTrack *track = m->tracks + t;
        track->known = track->is_off ? pair_product(track->offset, spun_twice) : pair_of(0.0, 0.0);
        for (w = track->first; w < track->end; w++) {
            PhaseWeight *own = phase->weights + w;
            SeriesWeight *weight = m->weights + w;
            machine_advance_weight(m, track, w, k, carried, false);
            own->free = weight->free;
            if (own->grip > 0.0) {
                own->load[k] = known_load(m, track, weight, own->radius, k);
                own->free -= own->slip * own->side * own->grip * weight->lever * own->load[k];
            }
        }
    }
    average(m, k);
    for (t = 0; t < m->track_count; t++) {
        const MachineTrack *track = m->tracks + t;
        Pair force = pair_both(0.0);
        for (w = track->first; w < track->end; w++) {
            force = pair_sum(force, machine_weight_force(m->weights + w, k, false));
        }
        for (i = 0; i < n; i++) {
            m->right[2 * i] += track->row[i] * pair_x(force);
            m->right[2 * i + 1] += track->row[i] * pair_y(force);
        }
    }
}

void phase_push_shaft(Machine *m, int k)
{
    const struct Phase *phase = m->phase;
    double *torque = m->right + 2 * m->stations;
    int w;
    for (w = 0; w < m->weight_count; w++) {
        const PhaseWeight *own = phase->weights + w;
        const SeriesWeight *weight = m->weights + w;
        if (phase->groups[own->group].rests) {
            *torque += weight->moment / weight->lever * own->free;
        } else if (own->grip > 0.0) {
            *torque += own->slip * own->side * own->grip * weight->moment * own->load[k];
        }
    }
}

bool phase_slider_is_loose(const PhaseSlider *slider)
{
    return slider->stroke > 0.0 && slider->slip == 0.0 && slider->side == 0;
}

double phase_slider_along(const Machine *m, const PhaseSlider *slider, const Pair *coefficients)
{
    double sum = 0.0;
    int i;
    if (!slider->row) {
        return pair_at(coefficients[slider->place / 2], slider->place % 2);
    }
    for (i = 0; i < m->stations - m->waves; i++) {
        sum += slider->row[2 * i + slider->axis] * pair_at(coefficients[i], slider->axis);
    }
    return sum;
}

/* Push the stations by the force of a slider. */
static void push_by_slider(Machine *m, const PhaseSlider *slider, double force)
{
    int i;
    if (!slider->row) {
        m->right[slider->place] += force;
        return;
    }
    for (i = 0; i < m->stations - m->waves; i++) {
        m->right[2 * i + slider->axis] += slider->row[2 * i + slider->axis] * force;
    }
}

void phase_push_sliders(Machine *m, int k)
{
    const struct Phase *phase = m->phase;
    int j;
    for (j = 0; j < phase->slider_count; j++) {
        PhaseSlider *slider = phase->sliders + j;
        const int place = slider->place, sticks = slider->slip == 0.0;
        slider->hold[k] = k == 0 ? slider->force : 0.0;
        if (sticks && slider->stiffness > 0.0 && k > 0 && !phase_slider_is_loose(slider)) {
            slider->hold[k] = -slider->stiffness * phase_slider_along(m, slider, m->motion + k * m->width);
        }
        if (sticks && slider->stiffness == 0.0) {
            slider->known = m->right[place];
            m->right[place] = k == 0 ? -pair_at(m->gravity, place % 2) : 0.0;
        } else {
            push_by_slider(m, slider, slider->hold[k]);
        }
    }
}

/* -- coefficients ------------------------------------------------------------------------------ */

static void take_sliders(Machine *m, int k)
{
    const struct Phase *phase = m->phase;
    int j, i;
    for (j = 0; j < phase->slider_count; j++) {
        PhaseSlider *slider = phase->sliders + j;
        if (slider->slip == 0.0 && slider->stiffness == 0.0) {
            double force = -slider->known;
            for (i = 0; i < m->unknowns; i++) {
                force += slider->held[i] * m->right[i];
            }
            slider->hold[k] = force;
        }
    }
}

/* Accelerations that the weights of a track would have alone, of order k. */
static void take_track(Machine *m, MachineTrack *track, int k)
{
    const struct Phase *phase = m->phase;
    const Pair pull = pair_turned_back(machine_take_pull(m, track, k));
    int w;
    for (w = track->first; w < track->end; w++) {
        PhaseWeight *own = phase->weights + w;
        const SeriesWeight *weight = m->weights + w;
        const Pair along = pair_times(pull, weight->along);
        double pulled = pair_x(along) + pair_y(along);
        if (m->drive.motor) {
            pulled -= weight->roll * m->right[2 * m->stations];
        }
        if (own->grip > 0.0) {
            const double lighter = pair_crossed(pull, weight->unit[0]);
            pulled -= own->slip * own->side * own->grip * lighter;
            own->load[k] -= lighter;
        }
        own->alone[k] = own->free - weight->lever * pulled;
    }
}

void phase_take(Machine *m, int k, double speed_gained)
{
    const struct Phase *phase = m->phase;
    const double carried = m->drive.motor ? m->right[2 * m->stations] : machine_carried_along(m, k);
    int t, g, j, w;
    take_sliders(m, k);
    for (t = 0; t < m->track_count; t++) {
        take_track(m, m->tracks + t, k);
    }
    for (g = 0; g < phase->group_count; g++) {
        const PhaseGroup *group = phase->groups + g;
        double sum = 0.0;
        for (j = 0, w = group->first; j < group->size; j++, w = phase->weights[w].ahead) {
            sum += m->weights[w].share * phase->weights[w].alone[k];
        }
        sum = group->rests ? carried : sum / group->share;
        for (j = 0, w = group->first; j < group->size; j++, w = phase->weights[w].ahead) {
            machine_take_weight(m, w, k, sum, speed_gained, m->tracks[phase->weights[w].track].pull[k], false);
        }
    }
}
