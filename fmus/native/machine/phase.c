/* Memory of a phase, and its groups. */
#include "machine/phase.h"

#include "base/elementary.h"
#include "constants.h"

struct Phase *phase_allocate(Unit *unit, int stations, int weights, int sliders)
{
    enum { COEFFICIENTS = MOST_ORDER + 3 };
    const size_t unknowns = 2 * (size_t)stations + 1;
    struct Phase *phase = unit_allocate(unit, 1, sizeof *phase);
    int k, missing = !phase;
    if (missing) {
        return NULL;
    }
    phase->weights = unit_allocate(unit, (size_t)weights + 1, sizeof *phase->weights);
    phase->groups = unit_allocate(unit, (size_t)weights + 1, sizeof *phase->groups);
    phase->sliders = unit_allocate(unit, (size_t)sliders + 1, sizeof *phase->sliders);
    phase->series = unit_allocate(unit, COEFFICIENTS, sizeof(double));
    missing = !phase->weights || !phase->groups || !phase->sliders || !phase->series;
    for (k = 0; k < weights && !missing; k++) {
        PhaseWeight *weight = phase->weights + k;
        PhaseGroup *group = phase->groups + k;
        weight->alone = unit_allocate(unit, COEFFICIENTS, sizeof(double));
        weight->load = unit_allocate(unit, COEFFICIENTS, sizeof(double));
        group->row = unit_allocate(unit, unknowns, sizeof(double));
        group->action = unit_allocate(unit, unknowns, sizeof(double));
        missing |= !weight->alone || !weight->load || !group->row || !group->action;
    }
    for (k = 0; k < sliders && !missing; k++) {
        phase->sliders[k].held = unit_allocate(unit, unknowns, sizeof(double));
        phase->sliders[k].hold = unit_allocate(unit, COEFFICIENTS, sizeof(double));
        missing |= !phase->sliders[k].held || !phase->sliders[k].hold;
    }
    return missing ? NULL : phase;
}

double phase_angle(const Machine *m, int weight)
{
    return pair_at(m->motion[m->stations + weight / 2], weight % 2);
}

double phase_rate(const Machine *m, int weight)
{
    return pair_at(m->velocity[m->stations + weight / 2], weight % 2);
}

double phase_gap(const Machine *m, int weight)
{
    const PhaseWeight *one = m->phase->weights + weight;
    return modulo(phase_angle(m, one->ahead) - phase_angle(m, weight), TAU) - one->spacing;
}

/* Whether a weight moves as one with that ahead. */
static int is_linked(const struct Phase *phase, int weight)
{
    const PhaseWeight *one = phase->weights + weight;
    return one->joined && one->slip == phase->weights[one->ahead].slip;
}

static int is_resting(const Machine *m, int weight)
{
    const PhaseWeight *one = m->phase->weights + weight;
    return one->grip > 0.0 && one->slip == 0.0;
}

/* A group of the weight and all that are linked ahead of it. */
static void add_group(Machine *m, int weight)
{
    struct Phase *phase = m->phase;
    PhaseGroup *group = phase->groups + phase->group_count;
    int last = weight;
    group->first = weight;
    group->size = 1;
    group->rests = is_resting(m, weight);
    group->share = m->weights[weight].share;
    phase->weights[weight].group = phase->group_count++;
    /* the size ends what a state that was forged may link */
    while (is_linked(phase, last) && phase->weights[last].ahead != weight && group->size < m->weight_count) {
        last = phase->weights[last].ahead;
        group->size++;
        group->share += m->weights[last].share;
        phase->weights[last].group = phase->weights[weight].group;
    }
}

void phase_group(Machine *m)
{
    struct Phase *phase = m->phase;
    int k;
    phase->group_count = 0;
    for (k = 0; k < m->weight_count; k++) {
        phase->weights[k].begins = 1;
        phase->weights[k].group = -1;
    }
    for (k = 0; k < m->weight_count; k++) {
        if (is_linked(phase, k)) {
            phase->weights[phase->weights[k].ahead].begins = 0;
        }
    }
    for (k = 0; k < m->weight_count; k++) {
        if (phase->weights[k].begins) {
            add_group(m, k);
        }
    }
    for (k = 0; k < m->weight_count; k++) { /* closed rings begin anywhere */
        if (phase->weights[k].group < 0) {
            add_group(m, k);
        }
    }
}
