/* What ends a phase: the first fall of any of the functions that it keeps above 0, polynomials all of them. */
#include <string.h>

#include "base/elementary.h"
#include "base/polynomial_fall.h"
#include "machine/phase.h"
#include "machine/restraints.h"

#define GAP_SLACK 1e-14  /* rad: a gap closes when it is less than 0 by more than this */
#define RATE_SLACK 1e-15 /* of what a weight turns by in the machine's time: a rate that is rounding */
#define LIMIT_SLACK 2e-12 /* of a slider's limit: more than what is decided by */
#define MOST_CORRECTED 0.01 /* of the time up to which one looks: what is further off is no rounding of the step */
#define FORCE_SLACK 2.0 /* times the rounding of forces, which is decided by */

/* The search: the machine's step, and the first event so far. */
typedef struct {
    Machine *machine;
    int order;
    double until;
    PhaseEvent event;
} Search;

static double *cleared(const Search *search)
{
    double *series = search->machine->phase->series;
    memset(series, 0, (size_t)(search->order + 1) * sizeof *series);
    return series;
}

/* The series in the scratch, of this order, falls: an event; whether it is the first so far. */
static bool look(Search *search, int order, EventKind kind, int which)
{
    const double time = find_polynomial_fall(search->machine->phase->series, order, search->until);
    if (time >= 0.0 && (time < search->until || search->event.kind == NO_EVENT)) {
        search->until = time;
        search->event.kind = kind;
        search->event.which = which;
        return true;
    }
    return false;
}

static void look_at_gap(Search *search, int w)
{
    const Machine *m = search->machine;
    const PhaseWeight *own = m->phase->weights + w;
    double *series = m->phase->series;
    int k;
    for (k = 1; k <= search->order; k++) {
        const Pair *motion = m->motion + k * m->width + m->stations;
        series[k] = pair_at(motion[own->ahead / 2], own->ahead % 2) - pair_at(motion[w / 2], w % 2);
    }
    series[0] = larger(0.0, phase_gap(m, w)) + GAP_SLACK;
    look(search, search->order, GAP_SHUTS, w);
}

static void look_at_load(Search *search, int w)
{
    const Machine *m = search->machine;
    const PhaseWeight *own = m->phase->weights + w;
    const int order = search->order - 2;
    double *series = m->phase->series;
    int k;
    for (k = 0; k <= order; k++) {
        series[k] = own->side * own->load[k];
    }
    series[0] = larger(0.0, series[0]) + FORCE_SLACK * phase_load_slack(m, w);
    look(search, order, WALL_CHANGES, w);
}

static void look_at_rate(Search *search, const PhaseGroup *group)
{
    const Machine *m = search->machine;
    const int w = group->first, order = search->order - 1;
    const double slip = m->phase->weights[w].slip;
    double *series = m->phase->series;
    int k;
    for (k = 0; k <= order; k++) {
        series[k] = slip * pair_at(m->velocity[k * m->width + m->stations + w / 2], w % 2);
    }
    series[0] = larger(0.0, series[0]) + RATE_SLACK * absolute(m->speed[0]);
    look(search, order, WEIGHT_STOPS, w);
}

static void look_at_group(Search *search, int g)
{
    Machine *m = search->machine;
    const struct Phase *phase = m->phase;
    const PhaseGroup *group = phase->groups + g;
    const int order = search->order - 2, whole = phase->weights[group->first].lasts;
    const double slack = phase_slack(m, group);
    int k, ahead, w = group->first;
    for (k = 1; k <= group->size; k++, w = phase->weights[w].ahead) {
        for (ahead = 0; ahead < 2 && group->rests && (k == group->size || !whole); ahead++) {
            double *series = cleared(search);
            phase_hold(m, group, k, ahead, order, series);
            series[0] = larger(0.0, series[0]) + FORCE_SLACK * slack;
            look(search, order, WEIGHT_LETS_GO, w);
        }
        if (!group->rests && k < group->size && !whole) {
            double *series = cleared(search);
            phase_press(m, group, k, order, series);
            series[0] = larger(0.0, series[0]) + FORCE_SLACK * slack;
            look(search, order, CONTACT_PULLS, w);
        }
    }
    if (!group->rests && phase->weights[group->first].slip != 0.0) {
        look_at_rate(search, group);
    }
}

/* Whether a slider comes to either end of its free stroke. */
static void look_at_stroke(Search *search, int which)
{
    const Machine *m = search->machine;
    const PhaseSlider *slider = m->phase->sliders + which;
    double *series = m->phase->series, way;
    int k;
    for (way = -1.0; way <= 1.0; way += 2.0) {
        for (k = 1; k <= search->order; k++) {
            series[k] = -way * phase_slider_along(m, slider, m->motion + k * m->width);
        }
        series[0] = larger(0.0, slider->stroke - way * slider->play);
        look(search, search->order, STROKE_ENDS, which);
    }
}

static void look_at_slider(Search *search, int which)
{
    const Machine *m = search->machine;
    const PhaseSlider *slider = m->phase->sliders + which;
    const int order = search->order - 2;
    double *series = m->phase->series, way;
    int k;
    if (slider->slip != 0.0) {
        for (k = 0; k <= search->order - 1; k++) {
            series[k] = slider->slip * phase_slider_along(m, slider, m->velocity + k * m->width);
        }
        series[0] = larger(0.0, series[0]);
        look(search, search->order - 1, SLIDER_STOPS, which);
        return;
    }
    if (phase_slider_is_loose(slider)) {
        look_at_stroke(search, which);
        return;
    }
    if (slider->stroke > 0.0) {
        for (k = 0; k <= order; k++) {
            series[k] = -slider->side * slider->hold[k];
        }
        series[0] = larger(0.0, series[0]);
        look(search, order, STROKE_BEGINS, which);
    }
    for (way = -1.0; way <= 1.0; way += 2.0) {
        for (k = 0; k <= order; k++) {
            series[k] = way * slider->hold[k];
        }
        series[0] = larger(0.0, series[0] + slider->limit) + LIMIT_SLACK * slider->limit;
        look(search, order, SLIDER_LETS_GO, which);
    }
}

/* Displacement and its first two derivatives (2,) at a time of the step. */
static void displaced_at(const RestraintSeries *one, int order, double time, double *d, double *v, double *a)
{
    int k, axis;
    for (axis = 0; axis < 2; axis++) {
        d[axis] = v[axis] = a[axis] = 0.0;
        for (k = order; k >= 0; k--) {
            a[axis] = a[axis] * time + 2.0 * v[axis];
            v[axis] = v[axis] * time + d[axis];
            d[axis] = d[axis] * time + one->displacement[2 * k + axis];
        }
    }
}

/* The time of the event just found, up to which this force is not 0, of the displacement itself: the series of the
   distance's square and of the force lack products of high order, and so err as the step does. */
static void correct(Search *search, RestraintSeries *one, const Stop *force, double latest)
{
    enum { CORRECTIONS = 3 };
    int k;
    restraints_complete(search->machine, one, force->rows, search->order);
    for (k = 0; k < CORRECTIONS; k++) {
        double d[2], v[2], a[2], miss, slope;
        displaced_at(one, search->order, search->until, d, v, a);
        miss = stop_pressure(force, d, v);
        slope = stop_pressure_rate(force, d, v, a);
        if (!(absolute(miss) <= MOST_CORRECTED * latest * absolute(slope))) {
            return;
        }
        search->until = smaller(latest, larger(0.0, search->until - miss / slope));
    }
}

/* How far the square of a distance is below that of another one, `way` 1, or above it, -1. */
static void look_at_distance(Search *search, RestraintSeries *one, const double *rows, double limit, double way,
                             EventKind kind, int which)
{
    const Stop beyond = {rows, limit, 1.0, 0.0, 0};
    double *series = search->machine->phase->series;
    const double latest = search->until;
    int k;
    for (k = 0; k <= search->order; k++) {
        series[k] = -way * restraint_square(one, k);
    }
    series[0] = larger(0.0, series[0] + way * limit * limit);
    if (look(search, search->order, kind, which)) {
        correct(search, one, &beyond, latest);
    }
}

/* How far the force of a stop is above 0, `way` 1, or below it, -1. */
static void look_at_pressure(Search *search, MachineStop *one, double way, EventKind kind, int which)
{
    double *series = search->machine->phase->series;
    const double latest = search->until;
    const int order = search->order - 2;
    int k;
    for (k = 0; k <= order; k++) {
        series[k] = way * one->series.pressure[k];
    }
    series[0] = larger(0.0, series[0]);
    if (look(search, order, kind, which)) {
        correct(search, &one->series, &one->stop, latest);
    }
}

static void look_at_stop(Search *search, int which)
{
    Machine *m = search->machine;
    MachineStop *stop = m->restraints->stops + which;
    int k;
    if (stop->state == STOP_PRESSES) {
        look_at_pressure(search, stop, 1.0, STOP_LETS_GO, which);
        return;
    }
    restraints_complete(m, &stop->series, stop->stop.rows, search->order);
    if (stop->state == STOP_APART) {
        look_at_distance(search, &stop->series, stop->stop.rows, stop->stop.gap, 1.0, STOP_TOUCHED, which);
        return;
    }
    for (k = 0; k <= search->order - 2; k++) {
        stop_series_pressure(&stop->stop, &stop->series, k);
    }
    look_at_distance(search, &stop->series, stop->stop.rows, stop->stop.gap, -1.0, STOP_LEFT, which);
    look_at_pressure(search, stop, -1.0, STOP_TOUCHED, which);
}

static void look_at_restraints(Search *search)
{
    Machine *m = search->machine;
    int k;
    for (k = 0; k < m->restraints->stop_count; k++) {
        look_at_stop(search, k);
    }
    for (k = 0; k < m->restraints->cubic_count; k++) {
        MachineCubic *cubic = m->restraints->cubics + k;
        if (cubic->spring.limit > 0.0) {
            restraints_complete(m, &cubic->series, cubic->spring.rows, search->order);
            look_at_distance(search, &cubic->series, cubic->spring.rows, cubic->spring.limit, 1.0, SPRING_ENDS, k);
        }
    }
}

PhaseEvent phase_first_event(Machine *m, int order, double *length)
{
    const struct Phase *phase = m->phase;
    Search search = {m, order, *length, {NO_EVENT, 0}};
    int k;
    for (k = 0; k < m->weight_count; k++) {
        const PhaseWeight *own = phase->weights + k;
        if (own->ahead >= 0 && !own->joined) {
            look_at_gap(&search, k);
        }
        if (own->grip > 0.0) {
            look_at_load(&search, k);
        }
    }
    for (k = 0; k < phase->group_count; k++) {
        look_at_group(&search, k);
    }
    for (k = 0; k < phase->slider_count; k++) {
        look_at_slider(&search, k);
    }
    if (m->restraints) {
        look_at_restraints(&search);
    }
    *length = search.until;
    return search.event;
}
