/* Forces between the weights of a group, and what its resistance can still hold. */
#include "base/elementary.h"
#include "machine/phase.h"

double phase_slack(const Machine *m, const PhaseGroup *group)
{
    const PhaseWeight *first = m->phase->weights + group->first;
    const Pair pull = m->tracks[first->track].pull[0];
    return PULL_ROUNDING * group->size *
           (m->weights[group->first].lever * hypotenuse(pair_x(pull), pair_y(pull)) + absolute(m->speed[1]));
}

double phase_load_slack(const Machine *m, int weight)
{
    const PhaseWeight *own = m->phase->weights + weight;
    const double turning = phase_turning(m, m->weights + weight, 0);
    const Pair pull = m->tracks[own->track].pull[0];
    return PULL_ROUNDING * (own->radius * turning * turning + hypotenuse(pair_x(pull), pair_y(pull)));
}

void phase_press(const Machine *m, const PhaseGroup *group, int count, int order, double *series)
{
    const struct Phase *phase = m->phase;
    int j, w = group->first, k;
    double part = 0.0;
    for (j = 0; j < group->size; j++, w = phase->weights[w].ahead) {
        const double share = m->weights[w].share / group->share;
        part += j < count ? share : 0.0;
        for (k = 0; k <= order && j < count; k++) {
            series[k] += share * phase->weights[w].alone[k];
        }
    }
    for (j = 0, w = group->first; j < group->size; j++, w = phase->weights[w].ahead) {
        const double share = part * m->weights[w].share / group->share;
        for (k = 0; k <= order; k++) {
            series[k] -= share * phase->weights[w].alone[k];
        }
    }
}

void phase_hold(const Machine *m, const PhaseGroup *group, int count, int ahead, int order, double *series)
{
    const struct Phase *phase = m->phase;
    const double way = ahead ? 1.0 : -1.0;
    int j, w = group->first, k;
    for (j = 0; j < group->size; j++, w = phase->weights[w].ahead) {
        const PhaseWeight *own = phase->weights + w;
        const double share = m->weights[w].share / group->share;
        const double limit = own->side * own->grip * m->weights[w].lever;
        if (ahead ? j < group->size - count : j >= count) {
            continue;
        }
        for (k = 0; k <= order; k++) {
            const double lag = k <= m->speed_order - 1 ? m->speed[k + 1] * (k + 1) : 0.0;
            series[k] += share * (limit * own->load[k] - way * (own->alone[k] - lag));
        }
    }
}
