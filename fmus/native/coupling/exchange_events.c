#include "coupling/exchange_events.h"

#include <string.h>

#include "base/elementary.h"
#include "coupling/composite.h"
#include "coupling/exchange.h"
#include "machine/restraints.h"

#define AWAY 1.0             /* an indicator that falls at no time */
#define STOPPED 1e-9         /* of the rotor's speed: a weight that slides so slowly has come to rest */
#define SUPPORT_STOPPED 1e-9 /* of the largest displacement in the machine's time: the same of a support */
#define STOP_SLACK 4e-12 /* of a gap: more than the rounding by which states of stops are decided */
enum { INDICATOR_ORDER = 2 };

/* -- which there are ------------------------------------------------------------------------------ */

size_t exchange_indicators(const Unit *unit)
{
    const Composite *c = unit->own;
    size_t count;
    int k;
    if (unit->equations != &COMPOSITE_EQUATIONS) {
        return 0;
    }
    count = 2 * (size_t)c->parts->unit->layout.sizes.sliders + (size_t)c->parts->unit->layout.sizes.stops;
    for (k = 1; k < c->parts_without_motor; k++) {
        const Part *part = c->parts + k;
        count += (size_t)part->unit->layout.sizes.weights *
                 ((size_t)part_meets_as_built(unit, part) + 2 * (size_t)part_sticks_as_built(unit, part));
    }
    return count;
}

/* -- indicators ------------------------------------------------------------------------------------- */

static double gap_of(const Machine *m, int w)
{
    const PhaseWeight *own = m->phase->weights + w;
    const PhaseGroup *group = m->phase->groups + own->group;
    double pressure = 0.0;
    int k, v;
    if (own->ahead < 0 || own->lasts || (own->joined && group->rests)) {
        return AWAY;
    }
    if (!own->joined || m->phase->weights[own->ahead].group != own->group) {
        return phase_gap(m, w);
    }
    for (k = 1, v = group->first; v != w; v = m->phase->weights[v].ahead) {
        k++;
    }
    phase_press(m, group, k, 0, &pressure);
    return pressure + 2.0 * phase_slack(m, group);
}

/* What is left to hold the group of a weight that rests, or how fast one slides. */
static double slip_of(const Machine *m, int w)
{
    const PhaseWeight *own = m->phase->weights + w;
    const PhaseGroup *group = m->phase->groups + own->group;
    double least = AWAY;
    int k, ahead;
    if (!group->rests) {
        return own->slip * phase_rate(m, w);
    }
    for (k = 1; k <= group->size && group->first == w; k++) {
        for (ahead = 0; ahead < 2 && (k == group->size || !own->lasts); ahead++) {
            double left = 0.0;
            phase_hold(m, group, k, ahead, 0, &left);
            least = smaller(least, left + 2.0 * phase_slack(m, group));
        }
    }
    return least;
}

static double wall_of(const Machine *m, int w)
{
    const PhaseWeight *own = m->phase->weights + w;
    return own->side * own->load[0] + 2.0 * phase_load_slack(m, w);
}

static double slider_of(const Machine *m, const PhaseSlider *slider)
{
    if (slider->slip != 0.0) {
        return slider->slip * phase_slider_along(m, slider, m->velocity);
    }
    return slider->limit * (1.0 + 2e-12) - absolute(slider->hold[0]);
}

/* How far a stop is from its next event, over its gap: a distance, or the force over the stiffness. */
static double stop_of(const Machine *m, const MachineStop *one)
{
    const Stop *stop = &one->stop;
    const double full = stop->stiffness * stop->gap;
    double across[2], rate[2], beyond, pressure, slack;
    restraints_across(m, stop->rows, across, rate);
    beyond = hypotenuse(across[0], across[1]) / stop->gap - 1.0;
    pressure = stop_pressure(stop, across, rate) / full;
    slack = 2.0 * stop_rounding(stop, across, rate) / full;
    return one->state == STOP_APART     ? STOP_SLACK - beyond
           : one->state == STOP_PRESSES ? pressure + slack
                                        : smaller(beyond + STOP_SLACK, slack - pressure);
}

int exchange_events_look(Unit *unit, double *values)
{
    const Composite *c = unit->own;
    const Machine *m = &c->pieces.instant;
    const size_t sliders = 2 * (size_t)c->parts->unit->layout.sizes.sliders;
    size_t at;
    int k, w, first = 0;
    if (!exchange_indicators(unit)) {
        return 0;
    }
    if (one_piece_expand_instant(unit, INDICATOR_ORDER)) {
        return 1;
    }
    for (at = 0; at < sliders; at++) {
        values[at] = AWAY;
    }
    for (k = 0; m->phase && k < m->phase->slider_count; k++) {
        values[m->phase->sliders[k].number] = slider_of(m, m->phase->sliders + k);
    }
    for (k = 0; m->restraints && k < m->restraints->stop_count; k++) {
        values[at++] = stop_of(m, m->restraints->stops + k);
    }
    for (k = 1; k < c->parts_without_motor; k++) {
        const Part *part = c->parts + k;
        const int count = part_balls(part) ? part_balls(part)->count : 0;
        for (w = 0; w < count && part_meets_as_built(unit, part); w++) {
            values[at++] = m->phase ? gap_of(m, first + w) : AWAY;
        }
        for (w = 0; w < count && part_sticks_as_built(unit, part); w++) {
            const bool may = m->phase && m->phase->weights[first + w].grip > 0.0;
            values[at++] = may ? slip_of(m, first + w) : AWAY;
            values[at++] = may ? wall_of(m, first + w) : AWAY;
        }
        first += count;
    }
    return 0;
}

/* -- what follows ----------------------------------------------------------------------------------- */

/* Bring weights that a solver has pushed into each other apart. */
static void part_weights(const Composite *c, const Machine *m)
{
    int k, w, first = 0;
    for (k = 1; k < c->parts_without_motor; k++) {
        const Balls *balls = part_balls(c->parts + k);
        double *angles = c->parts[k].unit->memory;
        for (w = 0; balls && w < balls->count; w++) {
            const PhaseWeight *own = m->phase->weights + first + w;
            const double overlap = own->ahead >= 0 && !own->lasts ? -phase_gap(m, first + w) : 0.0;
            if (overlap > 0.0 && overlap < own->spacing) {
                angles[w] -= 0.5 * overlap;
                angles[own->ahead - first] += 0.5 * overlap;
            }
        }
        first += balls ? balls->count : 0;
    }
}

/* Stop weights and supports that no longer slide the way they did. */
static void stop_all(const Composite *c, const Machine *m)
{
    const double still = STOPPED * absolute(m->speed[0]);
    int k, w, first = 0;
    for (k = 1; k < c->parts_without_motor; k++) {
        const Balls *balls = part_balls(c->parts + k);
        for (w = 0; balls && w < balls->count; w++) {
            const double slip = m->phase->weights[first + w].slip;
            if (slip != 0.0 && slip * phase_rate(m, first + w) <= still) {
                one_piece_stop_weight(c, first + w);
            }
        }
        first += balls ? balls->count : 0;
    }
    for (k = 0; k < m->phase->slider_count; k++) {
        const PhaseSlider *slider = m->phase->sliders + k;
        const double rate = phase_slider_along(m, slider, m->velocity);
        if (slider->slip != 0.0 && slider->slip * rate <= SUPPORT_STOPPED * c->course->one_piece.largest) {
            one_piece_stop_slider(c, k);
        }
    }
}

int exchange_events_pass(Unit *unit, bool *changed)
{
    Composite *c = unit->own;
    OnePiece *one_piece = &c->course->one_piece;
    Machine *m = &c->pieces.step;
    double *before = c->pieces.before;
    if (!c->pieces.is_eventful) {
        return 0;
    }
    memcpy(before, c->states, c->state_count * sizeof(double));
    c->course->clock.time = unit->time;
    one_piece->speed = c->motor ? c->motor->unit->memory[ANGLE_SIZE] : composite_speed(c, unit->time);
    one_piece->acceleration = c->motor ? 0.0 : c->course->drive.acceleration;
    one_piece->pushed = unit->time - c->course->drive.pushed_at;
    one_piece->line = c->motor ? motor_line(c->motor->unit->own, one_piece->speed) : -1.0;
    one_piece_load(c, m, c->states, one_piece->speed, one_piece->acceleration);
    one_piece_load_phase(c, m, c->states);
    part_weights(c, m);
    stop_all(c, m);
    one_piece->undecided = 1.0;
    if (one_piece_meet(unit)) {
        return 1;
    }
    *changed = memcmp(before, c->states, c->state_count * sizeof(double)) != 0;
    return 0;
}
