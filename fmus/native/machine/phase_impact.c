/* Impacts of weights as events of the whole machine: rotor and weights jump together. */
#include "base/elementary.h"
#include "base/matrix.h"
#include "contact/impact_law.h"
#include "contact/track.h"
#include "machine/phase.h"

#define LOWEST_BOUNCE_OF_PAIR 1e-9 /* rad: less than what the surfaces of real weights yield in contact */
#define EQUAL_RATES_OF_PAIR 1e-12  /* of the largest rate: rounding of the impact law */

size_t phase_impact_doubles(int stations, int weights)
{
    const size_t unknowns = 2 * (size_t)stations + 1;
    return impact_doubles(weights) + unknowns * (unknowns + 1);
}

static double closing_of(const Machine *m, int w)
{
    return phase_rate(m, w) - phase_rate(m, m->phase->weights[w].ahead);
}

static int touches(const Machine *m, int w)
{
    const PhaseWeight *own = m->phase->weights + w;
    return own->ahead >= 0 && !own->joined && phase_gap(m, w) <= m->phase->grain * TOUCHING_ANGLE;
}

int phase_approaches(const Machine *m)
{
    int w;
    for (w = 0; w < m->weight_count; w++) {
        if (touches(m, w) && closing_of(m, w) > 0.0) {
            return 1;
        }
    }
    return 0;
}

/* Rates jump as seen from the shaft where its speed is prescribed, else as seen from outside. */
static double turning_of(const Machine *m)
{
    return m->drive.motor ? m->speed[0] : 0.0;
}

/* Weights and the pairs of them that take part; of a ring that is closed the last follows from the others. */
static void fill_impact(const Machine *m, Impact *impact)
{
    const struct Phase *phase = m->phase;
    int w;
    for (w = 0; w < m->weight_count; w++) {
        const PhaseWeight *own = phase->weights + w;
        impact->rate[w] = turning_of(m) + phase_rate(m, w);
        const int closes_ring = own->lasts && phase->groups[own->group].first == own->ahead;
        if (own->ahead >= 0 && !closes_ring && (own->joined || touches(m, w))) {
            const ImpactPair pair = {w, own->ahead, own->lasts, 0, own->touch.restitution, 0.0};
            impact->pairs[impact->contacts++] = pair;
        }
    }
}

/* Jumps of all rates by unit impulses between the weights of each pair, on a machine that is free. */
static void fill_answers(Machine *m, double angle, Impact *impact, double *right)
{
    struct Phase *phase = m->phase;
    Carried *carried = m->carried;
    const int c = impact->contacts, size = m->unknowns;
    const bool is_held = carried && !(m->mass[0] > 0.0);
    int j, side, i, w;
    m->phase = NULL;
    m->carried = NULL;
    machine_start(m, angle);
    for (j = 0; j < c; j++) {
        const int pushed[2] = {impact->pairs[j].behind, impact->pairs[j].ahead};
        for (w = 0; w < m->weight_count; w++) {
            impact->jumps[w * c + j] = 0.0;
        }
        for (i = 0; i < size; i++) {
            right[i] = 0.0;
        }
        for (side = 0; side < 2; side++) {
            const SeriesWeight *weight = m->weights + pushed[side];
            const double free = (side ? 1.0 : -1.0) * weight->lever / weight->moment;
            impact->jumps[pushed[side] * c + j] += free;
            for (i = 0; i < size; i++) {
                right[i] -= weight->moment * free *
                            machine_coupled(m, m->tracks + phase->weights[pushed[side]].track, weight, i);
            }
        }
        machine_solve(m, right);
        for (i = 0; i < size && is_held; i++) {
            right[i] = 0.0;
        }
        for (w = 0; w < m->weight_count; w++) {
            const MachineTrack *track = m->tracks + phase->weights[w].track;
            for (i = 0; i < size; i++) {
                impact->jumps[w * c + j] -=
                    m->weights[w].lever * machine_coupled(m, track, m->weights + w, i) * right[i];
            }
        }
    }
    m->phase = phase;
    m->carried = carried;
}

static void set_rates(Machine *m, const Impact *impact)
{
    int w;
    for (w = 0; w < m->weight_count; w++) {
        pair_set(&m->velocity[m->stations + w / 2], w % 2, impact->rate[w] - turning_of(m));
    }
}

/* Let rotor and shaft jump with the weights, whose rates have jumped to those of the impact; 1: the mass
   is singular. */
static int push_carrier(Machine *m, const Impact *impact, double *right)
{
    const int size = m->unknowns, n = m->stations;
    double *matrix = right + size;
    int i, j, w;
    machine_set_carrier(m);
    for (i = 0; i < size; i++) {
        right[i] = 0.0;
        for (j = 0; j < size; j++) {
            matrix[i * size + j] = m->matrix[j <= i ? i * size + j : j * size + i];
        }
    }
    for (w = 0; w < m->weight_count; w++) {
        const MachineTrack *track = m->tracks + m->phase->weights[w].track;
        const double jump = impact->rate[w] - (turning_of(m) + phase_rate(m, w));
        for (i = 0; i < size; i++) {
            right[i] -= m->weights[w].moment * jump * machine_coupled(m, track, m->weights + w, i);
        }
    }
    if (matrix_solve(1, size, 1, matrix, right)) {
        return 1;
    }
    for (i = 0; i < n; i++) {
        m->velocity[i] = pair_sum(m->velocity[i], pair_of(right[2 * i], right[2 * i + 1]));
    }
    m->speed[0] += size > 2 * n ? right[2 * n] : 0.0;
    set_rates(m, impact);
    return 0;
}

/* One rate for all weights of a group, but for rounding so already. */
static void level_rates(Machine *m)
{
    const struct Phase *phase = m->phase;
    const int n = m->stations;
    int g, j, w;
    for (g = 0; g < phase->group_count; g++) {
        const PhaseGroup *group = phase->groups + g;
        double rate = 0.0;
        for (j = 0, w = group->first; j < group->size; j++, w = phase->weights[w].ahead) {
            rate += m->weights[w].share / group->share * phase_rate(m, w);
        }
        for (j = 0, w = group->first; j < group->size && group->size > 1; j++, w = phase->weights[w].ahead) {
            pair_set(&m->velocity[n + w / 2], w % 2, rate);
        }
    }
}

/* Set contacts by rates, and which way weights slide. */
static void set_contacts(Machine *m, const Impact *impact)
{
    struct Phase *phase = m->phase;
    double rounding = 0.0;
    int j, w;
    for (w = 0; w < m->weight_count; w++) {
        rounding = larger(rounding, EQUAL_RATES_OF_PAIR * absolute(impact->rate[w]));
        phase->weights[w].joined = phase->weights[w].lasts;
    }
    for (j = 0; j < impact->contacts; j++) {
        if (absolute(impact_opening(impact, j)) <= rounding) {
            phase->weights[impact->pairs[j].behind].joined = 1;
        }
    }
    for (w = 0; w < m->weight_count; w++) {
        phase->weights[w].slip = 0.0;
    }
    phase_group(m);
    level_rates(m);
    for (w = 0; w < m->weight_count; w++) {
        PhaseWeight *own = phase->weights + w;
        const double rate = phase_rate(m, w);
        own->slip = own->grip > 0.0 && rate != 0.0 ? copy_sign(1.0, rate) : 0.0;
    }
}

/* No friction holds against an impact; springs keep their force. */
static void free_sliders(Machine *m)
{
    struct Phase *phase = m->phase;
    int k;
    for (k = 0; k < phase->slider_count; k++) {
        PhaseSlider *slider = phase->sliders + k;
        const double rate = phase_slider_along(m, slider, m->velocity);
        if (slider->stiffness == 0.0) {
            slider->slip = rate != 0.0 ? copy_sign(1.0, rate) : 0.0;
            slider->force = -slider->slip * slider->limit;
        } else if (slider->slip * rate < 0.0) {
            slider->slip = 0.0;
        }
    }
}

/* Pairs that open so slowly that they would come back after less than is followed last from now on; how
   many. */
static int end_bounces(Machine *m, Impact *impact)
{
    int j, low = 0;
    for (j = 0; j < impact->contacts; j++) {
        ImpactPair *pair = impact->pairs + j;
        const double opening = impact_opening(impact, j);
        const double closing = phase_acceleration(m, pair->behind) - phase_acceleration(m, pair->ahead);
        if (!pair->lasting && !m->phase->weights[pair->behind].joined && opening > 0.0 &&
            opening * opening <= 2.0 * closing * m->phase->grain * LOWEST_BOUNCE_OF_PAIR) {
            pair->lasting = 1;
            low++;
        }
    }
    return low;
}

int phase_collide(Machine *m, double angle, double *memory, Failure *failure)
{
    Impact impact = impact_begin(m->weight_count, memory);
    double *right = memory + impact_doubles(m->weight_count);
    phase_group(m);
    fill_impact(m, &impact);
    fill_answers(m, angle, &impact, right);
    do {
        if (impact_solve(&impact, failure)) {
            return 1;
        }
        if (m->carried) { /* the host of the weights adds up these impulses itself */
            set_rates(m, &impact);
        } else if (push_carrier(m, &impact, right)) {
            return fail(failure, "the rotor's mass matrix is singular");
        }
        set_contacts(m, &impact);
        free_sliders(m);
        if (phase_decide(m, angle, INSTANT_ORDER)) {
            return fail(failure, "no solution was found for which weights touch and what sticks behind an impact");
        }
    } while (end_bounces(m, &impact));
    return 0;
}
