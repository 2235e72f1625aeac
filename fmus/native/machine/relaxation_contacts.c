/* What is sure of contacts in a step under heavy drag, though only some points of it are known.

   A gap, or what presses two weights on each other, that is far enough above 0 at two points stays there between them.
   What they err by needs no room: it is what a weight would move by within the tolerance. */
#include "base/elementary.h"
#include "machine/phase.h"
#include "machine/relaxation.h"

/* -- contacts ---------------------------------------------------------------------------------------------- */

static void limit_apart(Relaxation *r, const Machine *m, int w, double length)
{
    const int ahead = m->phase->weights[w].ahead;
    const double *own = r->angles + w * RELAXED_TIMES, *other = r->angles + ahead * RELAXED_TIMES;
    double gaps[RELAXED_TIMES];
    int i;
    gaps[0] = phase_gap(m, w);
    for (i = 1; i <= r->now->rule->stages; i++) {
        gaps[i] = gaps[0] + (other[i] - other[0]) - (own[i] - own[0]);
    }
    relaxation_limit_above(r, gaps, 0.0, r->fastest[w] + r->fastest[ahead], length);
}

/* How long the first `count` weights of a group press on the weights ahead of them.  The press is N of these weights less
   N of the whole group, each weighted by its share. */
static void limit_pressed(Relaxation *r, const Machine *m, const RelaxedBounds *bounds, const PhaseGroup *group,
                          int count, double length)
{
    const double fastest = r->fastest[group->first], change = relaxation_change(r, m, group, bounds, fastest);
    double presses[RELAXED_TIMES], part = 0.0;
    int i, j, w = group->first;
    for (j = 0; j < count; j++, w = m->phase->weights[w].ahead) {
        part += m->weights[w].share / group->share;
    }
    for (i = 0; i <= r->now->rule->stages; i++) {
        presses[i] = 0.0;
        for (j = 0, w = group->first; j < group->size; j++, w = m->phase->weights[w].ahead) {
            presses[i] += m->weights[w].share / group->share * (j < count ? 1.0 - part : -part) *
                          r->pushes[w * RELAXED_TIMES + i];
        }
    }
    part = 2.0 * part * (1.0 - part);
    relaxation_limit_above(r, presses, part * relaxation_turned(r, m, group, fastest), part * change, length);
}

void relaxation_limit_contacts(Relaxation *r, const Machine *m, const RelaxedBounds *bounds, double length)
{
    const struct Phase *phase = m->phase;
    int w, g, k;
    for (w = 0; w < m->weight_count; w++) {
        if (phase->weights[w].ahead >= 0 && !phase->weights[w].joined) {
            limit_apart(r, m, w, length);
        }
    }
    for (g = 0; g < phase->group_count; g++) {
        const PhaseGroup *group = phase->groups + g;
        for (k = 1; k < group->size && !group->rests && !phase->weights[group->first].lasts; k++) {
            limit_pressed(r, m, bounds, group, k, length);
        }
    }
}
