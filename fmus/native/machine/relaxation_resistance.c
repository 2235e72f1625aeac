/* Rolling resistance in a step under heavy drag: what it does to N, and that no weight comes to rest or sets off.

   A weight that rolls by s = -1 or 1 against its resistance, on the wall sigma, has

       N = N0 - s sigma mu/(kappa R) (L0 + R (2 w + theta') theta'),   L0 = R w^2 - Re(a p*)

   where N0 and L0 have no theta'.  While s N is above 0, so is s theta': it goes on.  One that rests has N0 within
   mu/(kappa R) of its load. */
#include "base/elementary.h"
#include "machine/relaxation.h"

enum { MOST_NARROWINGS = 3 };

double relaxation_resist(const Relaxation *r, const Machine *m, int w, int point, double speed, double found)
{
    const PhaseWeight *own = m->phase->weights + w;
    const double turning = r->turning[point], acts = own->slip * own->side * relaxation_grip(m, w);
    double *load = r->loads + w * RELAXED_TIMES + point, *push = r->pushes + w * RELAXED_TIMES + point;
    *load = own->radius * turning * turning - pair_crossed(pair_turned_back(r->felt[point]), m->weights[w].unit[0]);
    *push = found - acts * *load;
    return *push - acts * own->radius * (2.0 * turning + speed) * speed;
}

/* -- bounds ------------------------------------------------------------------------------------------------- */

/* The greatest mu/(kappa R) in a group. */
static double greatest_grip(const Machine *m, const PhaseGroup *group)
{
    double most = 0.0;
    int j, w = group->first;
    for (j = 0; j < group->size; j++, w = m->phase->weights[w].ahead) {
        most = larger(most, relaxation_grip(m, w));
    }
    return most;
}

double relaxation_turned(const Relaxation *r, const Machine *m, const PhaseGroup *group, double fastest)
{
    return greatest_grip(m, group) * m->phase->weights[group->first].radius * (2.0 * r->spin + fastest) * fastest;
}

/* What L0 of a weight changes by with time, at most. */
static double change_of_load(const Relaxation *r, const Machine *m, const PhaseGroup *group, double fastest)
{
    return 2.0 * m->phase->weights[group->first].radius * r->spin * r->gained + r->rise + r->strength * fastest;
}

double relaxation_change(const Relaxation *r, const Machine *m, const PhaseGroup *group, const RelaxedBounds *bounds,
                         double fastest)
{
    const double grip = greatest_grip(m, group);
    const double change = bounds->rise + bounds->slope * fastest;
    return grip > 0.0 ? change + grip * change_of_load(r, m, group, fastest) : change;
}

/* What drives a group as one, at the start or a point. */
static double push_on_group(const Relaxation *r, const Machine *m, const PhaseGroup *group, int point)
{
    double sum = 0.0;
    int j, w = group->first;
    for (j = 0; j < group->size; j++, w = m->phase->weights[w].ahead) {
        sum += m->weights[w].share / group->share * r->pushes[w * RELAXED_TIMES + point];
    }
    return sum;
}

/* theta' of a group that resistance holds or acts against, at most. */
static double rolls_at_most(const Relaxation *r, const Machine *m, const PhaseGroup *group, const RelaxedBounds *bounds,
                            double length)
{
    const Radau *rule = r->now->rule;
    const double start = absolute(phase_rate(m, group->first)), drag = m->weights[group->first].damping_rate;
    double fastest = larger(start, bounds->size / drag), pushed = 0.0, apart = 0.0;
    int i, k;
    if (group->rests) {
        return 0.0;
    }
    for (i = 0; i <= rule->stages; i++) {
        pushed = larger(pushed, absolute(push_on_group(r, m, group, i)));
        apart = larger(apart, i > 1 ? rule->nodes[i - 1] - rule->nodes[i - 2] : rule->nodes[0]);
    }
    for (k = 0; k < MOST_NARROWINGS; k++) {
        const double most = pushed + relaxation_turned(r, m, group, fastest) +
                            0.5 * apart * length * relaxation_change(r, m, group, bounds, fastest);
        fastest = smaller(fastest, larger(start, most / drag));
    }
    return fastest;
}

void relaxation_find_fastest(Relaxation *r, const Machine *m, const RelaxedBounds *bounds, double length)
{
    int w;
    for (w = 0; w < m->weight_count; w++) {
        const PhaseWeight *own = m->phase->weights + w;
        r->fastest[w] = own->grip > 0.0 ? rolls_at_most(r, m, m->phase->groups + own->group, bounds, length)
                                        : relaxation_greatest_speed(m, bounds, w);
    }
}

/* -- what lasts ------------------------------------------------------------------------------------------- */

static void limit_wall(Relaxation *r, const Machine *m, int w, double length)
{
    const PhaseWeight *own = m->phase->weights + w;
    const PhaseGroup *group = m->phase->groups + own->group;
    const double fastest = r->fastest[w];
    const double turned = own->radius * (2.0 * r->spin + fastest) * fastest;
    double loads[RELAXED_TIMES];
    int i;
    for (i = 0; i <= r->now->rule->stages; i++) {
        loads[i] = own->side * r->loads[w * RELAXED_TIMES + i];
    }
    relaxation_limit_above(r, loads, turned, change_of_load(r, m, group, fastest), length);
}

static void limit_rolling(Relaxation *r, const Machine *m, const PhaseGroup *group, const RelaxedBounds *bounds,
                          double length)
{
    const double fastest = r->fastest[group->first], slip = m->phase->weights[group->first].slip;
    double pushes[RELAXED_TIMES];
    int i;
    for (i = 0; i <= r->now->rule->stages; i++) {
        pushes[i] = slip * push_on_group(r, m, group, i);
    }
    relaxation_limit_above(r, pushes, relaxation_turned(r, m, group, fastest),
                           relaxation_change(r, m, group, bounds, fastest), length);
}

/* How long resistance holds `count` weights of a group, from its last (ahead) or first on, as phase_hold has it. */
static void limit_rest(Relaxation *r, const Machine *m, const PhaseGroup *group, int count, int ahead,
                       const RelaxedBounds *bounds, double length)
{
    const double way = ahead ? 1.0 : -1.0;
    double holds[RELAXED_TIMES] = {0.0};
    int i, j, w = group->first;
    for (j = 0; j < group->size; j++, w = m->phase->weights[w].ahead) {
        const double share = m->weights[w].share / group->share, limit = m->phase->weights[w].side * relaxation_grip(m, w);
        for (i = 0; i <= r->now->rule->stages && (ahead ? j >= group->size - count : j < count); i++) {
            holds[i] += share * (limit * r->loads[w * RELAXED_TIMES + i] - way * r->pushes[w * RELAXED_TIMES + i]);
        }
    }
    relaxation_limit_above(r, holds, 0.0, relaxation_change(r, m, group, bounds, 0.0), length);
}

void relaxation_limit_rolling(Relaxation *r, const Machine *m, const RelaxedBounds *bounds, double length)
{
    const struct Phase *phase = m->phase;
    int g, k, w;
    for (w = 0; w < m->weight_count; w++) {
        if (phase->weights[w].grip > 0.0) {
            limit_wall(r, m, w, length);
        }
    }
    for (g = 0; g < phase->group_count; g++) {
        const PhaseGroup *group = phase->groups + g;
        if (phase->weights[group->first].slip != 0.0) {
            limit_rolling(r, m, group, bounds, length);
        }
        for (k = phase->weights[group->first].lasts ? group->size : 1; k <= group->size && group->rests; k++) {
            limit_rest(r, m, group, k, 0, bounds, length);
            limit_rest(r, m, group, k, 1, bounds, length);
        }
    }
}
