/* The phase that holds from a state on: one complementarity problem of all accelerations.

   Contacts part or push, weights rest or slide, supports stick or slip.  Where one condition is violated the
   first that is changes sides, and the accelerations are computed anew: principal pivoting with the least
   index, which ends where the matrix of responses is a P-matrix (Murty 1974). */
#include "base/elementary.h"
#include "machine/phase.h"
#include "machine/restraints.h"

enum { MOST_PIVOTS = 400 };
#define HOLD_ROUNDING 1e-12 /* of a slider's limit: what it may hold beyond */

double phase_acceleration(const Machine *m, int weight)
{
    return pair_at(m->velocity[m->width + m->stations + weight / 2], weight % 2);
}

/* Change sides where the wall that carries a weight is not that of its load; whether any did. */
static int change_walls(Machine *m)
{
    int w, changed = 0;
    for (w = 0; w < m->weight_count; w++) {
        PhaseWeight *own = m->phase->weights + w;
        if (own->grip > 0.0 && own->side * own->load[0] < -phase_load_slack(m, w)) {
            own->side = -own->side;
            changed = 1;
        }
    }
    return changed;
}

/* The k-th weight of a group. */
static int member(const struct Phase *phase, const PhaseGroup *group, int k)
{
    int w = group->first;
    while (k-- > 0) {
        w = phase->weights[w].ahead;
    }
    return w;
}

/* Let `count` weights of a group that rests go one way, away from the others. */
static void let_go(struct Phase *phase, const PhaseGroup *group, int count, double way)
{
    const int first = way > 0.0 ? group->size - count : 0;
    int k;
    for (k = first; k < first + count; k++) {
        phase->weights[member(phase, group, k)].slip = way;
    }
    if (count < group->size) {
        phase->weights[member(phase, group, way > 0.0 ? first - 1 : count - 1)].joined = 0;
    }
}

/* Let go what cannot be held of a group that rests; whether something was. */
static int free_resting(Machine *m, const PhaseGroup *group)
{
    const double slack = phase_slack(m, group);
    double least = -slack, way = 0.0;
    int count = 0, k, ahead;
    for (k = 1; k <= group->size; k++) {
        for (ahead = 0; ahead < 2; ahead++) {
            double left = 0.0;
            phase_hold(m, group, k, ahead, 0, &left);
            if (left < least && (k == group->size || !m->phase->weights[group->first].lasts)) {
                least = left;
                count = k;
                way = ahead ? 1.0 : -1.0;
            }
        }
    }
    if (count) {
        let_go(m->phase, group, count, way);
    }
    return count > 0;
}

/* Stop a group that slides, from rest, against the way that it is taken to; whether it does. */
static int stop_sliding(Machine *m, const PhaseGroup *group)
{
    struct Phase *phase = m->phase;
    const double slip = phase->weights[group->first].slip, slack = phase_slack(m, group);
    int k;
    if (slip == 0.0 || phase_rate(m, group->first) != 0.0 ||
        slip * phase_acceleration(m, group->first) >= -slack) {
        return 0;
    }
    for (k = 0; k < group->size; k++) {
        phase->weights[member(phase, group, k)].slip = 0.0;
    }
    return 1;
}

/* Open the first contact of a group that pulls; whether there is one. */
static int open_contact(Machine *m, const PhaseGroup *group)
{
    struct Phase *phase = m->phase;
    int k, w = group->first;
    for (k = 1; k < group->size && !phase->weights[w].lasts; k++, w = phase->weights[w].ahead) {
        double pressure = 0.0;
        phase_press(m, group, k, 0, &pressure);
        if (pressure < -phase_slack(m, group)) {
            phase->weights[w].joined = 0;
            return 1;
        }
    }
    return 0;
}

/* Close the first contact that has been opened though its weights go towards each other. */
static int close_contact(Machine *m)
{
    struct Phase *phase = m->phase;
    int w;
    for (w = 0; w < m->weight_count; w++) {
        PhaseWeight *own = phase->weights + w;
        const int apart = own->ahead >= 0 && own->group != phase->weights[own->ahead].group;
        if (apart && own->touches && phase_acceleration(m, own->ahead) - phase_acceleration(m, w) <
                                         -phase_slack(m, phase->groups + own->group)) {
            const double slip = phase->weights[own->ahead].slip;
            own->joined = 1;
            if (own->slip != slip) { /* one rests: that which moves takes it along */
                const int from = own->slip == 0.0 ? w : own->ahead, with = own->slip == 0.0 ? own->ahead : w;
                const PhaseGroup *group = phase->groups + phase->weights[from].group;
                int k;
                for (k = 0; k < group->size; k++) {
                    phase->weights[member(phase, group, k)].slip = phase->weights[with].slip;
                }
            }
            return 1;
        }
    }
    return 0;
}

/* Let the first slider that holds too much go, or stick that would turn back; whether there is one. */
static int change_slider(Machine *m)
{
    struct Phase *phase = m->phase;
    int k;
    for (k = 0; k < phase->slider_count; k++) {
        PhaseSlider *slider = phase->sliders + k;
        const int is_rigid = slider->stiffness == 0.0;
        const double rate = phase_slider_along(m, slider, m->velocity);
        const double acceleration = phase_slider_along(m, slider, m->velocity + m->width);
        if (!is_rigid) {
            if (slider->slip == 0.0 && absolute(slider->force) > slider->limit * (1.0 + HOLD_ROUNDING)) {
                slider->slip = -copy_sign(1.0, slider->force);
                slider->force = copy_sign(slider->limit, slider->force);
                return 1;
            }
            if (slider->slip != 0.0 && slider->slip * (rate != 0.0 ? rate : acceleration) < 0.0) {
                slider->slip = 0.0;
                return 1;
            }
            continue;
        }
        if (slider->slip == 0.0 && absolute(slider->hold[0]) > slider->limit * (1.0 + HOLD_ROUNDING)) {
            slider->slip = -copy_sign(1.0, slider->hold[0]);
            slider->force = copy_sign(slider->limit, slider->hold[0]);
            return 1;
        }
        if (slider->slip != 0.0 && rate == 0.0 && slider->slip * acceleration < 0.0) {
            slider->slip = 0.0;
            slider->force = 0.0;
            return 1;
        }
    }
    return 0;
}

static int change_one(Machine *m)
{
    const struct Phase *phase = m->phase;
    int g;
    if (change_walls(m) || change_slider(m)) {
        return 1;
    }
    for (g = 0; g < phase->group_count; g++) {
        const PhaseGroup *group = phase->groups + g;
        if (group->rests ? free_resting(m, group) : (stop_sliding(m, group) || open_contact(m, group))) {
            return 1;
        }
    }
    return close_contact(m);
}

int phase_decide(Machine *m, double angle, int order)
{
    struct Phase *phase = m->phase;
    int w, pivot;
    if (m->restraints) {
        restraints_settle(m);
    }
    for (w = 0; w < m->weight_count; w++) {
        phase->weights[w].touches = phase->weights[w].joined;
    }
    for (pivot = 0; pivot < MOST_PIVOTS; pivot++) {
        phase_group(m);
        machine_expand(m, angle, order);
        if (!change_one(m)) {
            return 0;
        }
    }
    return 1;
}
