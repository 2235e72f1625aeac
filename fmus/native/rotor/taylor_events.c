/* What changes first in a stretch, and what that changes. */
#include "rotor/taylor_series.h"

#include "base/elementary.h"
#include "rotor/first_fall.h"

static const double LIMIT_ROUNDING = 1e-12; /* of a limit: a force so near to it has reached it */

/* One quantity's coefficients, times `sign`, plus `base`. */
static void read_column(const double *from, int stride, double sign, double base, double *to)
{
    int k;
    for (k = 0; k <= TERMS; k++) {
        to[k] = sign * from[k * stride];
    }
    to[0] += base;
}

/* The coefficients of a slider's displacement, or with `first` of its rate, times `sign`. */
static void read_way(const TaylorStep *method, const Slider *slider, int first, double sign, double *to)
{
    int k;
    for (k = 0; k <= TERMS; k++) {
        to[k] = sign * slider_along(slider, method->half / 2, method->series + k * method->length + first);
    }
}

/* Acceleration by all limits at the place of a slider. */
static double limit_acceleration(const TaylorStep *method, int j)
{
    const Slider *slider = method->sliders + j;
    double limits = 0.0, mobility = 0.0;
    int k;
    for (k = 0; k < method->count; k++) {
        const Slider *other = method->sliders + k;
        const int beside = !other->row && !slider->row && slider_place(other) == slider_place(slider);
        limits += k == j || beside ? other->limit : 0.0;
    }
    for (k = 0; k < method->half; k++) {
        mobility += slider_share(slider, k) * method->push[k * method->count + j];
    }
    return mobility * limits;
}

static void keep_first(const double *function, const double *rounding, int number, double *first, int *which)
{
    const double found = find_first_fall(function, TERMS + 1, *first, rounding);
    if (found < *first) {
        *first = found;
        *which = number;
    }
}

/* Ends of the free strokes, and springs that become slack behind them. */
static void look_at_strokes(const TaylorStep *method, const double *slider_states, double *first, int *which)
{
    static const double none[3] = {0.0, 0.0, 0.0};
    const int m = method->count;
    double function[TERMS + 1];
    int j, side;
    for (j = 0; j < m; j++) {
        const Slider *slider = method->sliders + j;
        const double *own = slider_states + SLIDER_DOUBLES * j;
        for (side = -1; side <= 1 && slider_is_loose(slider, own); side += 2) {
            read_way(method, slider, 0, -side, function);
            function[0] = larger(0.0, slider->stroke - side * own[PLAY]);
            keep_first(function, none, j, first, which);
        }
        if (slider->stroke > 0.0 && own[SLIPS] == 0.0 && own[SIDE] != 0.0) {
            read_column(method->forces + j, m, -own[SIDE], 0.0, function);
            function[0] = larger(0.0, function[0]);
            keep_first(function, none, j, first, which);
        }
    }
}

/* Stops that are touched or let go; they are numbered behind the sliders. */
static void look_at_stops(const TaylorStep *method, const double *slider_states, double *first, int *which)
{
    const Holds *holds = &method->holds;
    const double *own = slider_states + SLIDER_DOUBLES * holds->slider_count;
    double function[TERMS + 1];
    int j, k;
    for (j = 0; j < holds->stop_count; j++, own += STOP_DOUBLES) {
        const Stop *stop = holds->stops + j;
        const RestraintSeries series = taylor_restraint(method, holds->cubic_count + j);
        const double square = stop->gap * stop->gap, way = own[STOP_STATE] == STOP_APART ? 1.0 : -1.0;
        const double of_square[3] = {LIMIT_ROUNDING * square, 0.0, 0.0};
        double of_force[3] = {0.0, 0.0, 0.0};
        if (own[STOP_STATE] != STOP_PRESSES) {
            for (k = 0; k <= TERMS; k++) {
                function[k] = -way * restraint_square(&series, k);
            }
            function[0] += way * square;
            keep_first(function, of_square, holds->slider_count + j, first, which);
        }
        if (own[STOP_STATE] != STOP_APART) {
            const double sign = own[STOP_STATE] == STOP_PRESSES ? 1.0 : -1.0;
            read_column(series.pressure, 1, sign, 0.0, function);
            of_force[0] = LIMIT_ROUNDING * stop->stiffness * series.distance[0];
            keep_first(function, of_force, holds->slider_count + j, first, which);
        }
    }
}

double taylor_first_event(const TaylorStep *method, const double *slider_states,
                               double stretch, double until, int *which)
{
    const int m = method->count;
    double function[TERMS + 1], first = until;
    int j, side;
    *which = -1;
    look_at_strokes(method, slider_states, &first, which);
    look_at_stops(method, slider_states, &first, which);
    for (j = 0; j < m; j++) {
        const double *own = slider_states + SLIDER_DOUBLES * j;
        const double limit = method->sliders[j].limit, slips = own[SLIPS];
        if (slider_is_loose(method->sliders + j, own)) {
            continue;
        }
        /* where a slider starts from rest the first acceleration may be rounding, too */
        const double still = LIMIT_ROUNDING * stretch * limit_acceleration(method, j);
        const double sticking[3] = {LIMIT_ROUNDING * limit, 0.0,
                                    0.5 * still * stretch * method->sliders[j].stiffness};
        const double slipping[3] = {0.0, still, 0.0};
        for (side = 0; side < (slips != 0.0 ? 1 : 2) && limit > 0.0; side++) {
            double found;
            if (slips != 0.0) {
                read_way(method, method->sliders + j, method->half, slips, function);
            } else {
                read_column(method->forces + j, m, side ? 1.0 : -1.0, limit, function);
            }
            found = find_first_fall(function, TERMS + 1, first, slips != 0.0 ? slipping : sticking);
            if (found < first) {
                first = found;
                *which = j;
            }
        }
    }
    return first;
}

/* -- changes ------------------------------------------------------------------------------------------ */

/* A stop is in this state from now on. */
static void turn_stop(double *stop_state, int state)
{
    stop_state[STOP_TOUCHES] += state == STOP_PRESSES && stop_state[STOP_STATE] != STOP_PRESSES;
    stop_state[STOP_STATE] = state;
}

void taylor_settle_stops(const TaylorStep *method, const double *state, double *slider_states)
{
    double *stop_state = taylor_stop_states(method, slider_states);
    int k;
    for (k = 0; k < method->holds.stop_count; k++, stop_state += STOP_DOUBLES) {
        const Stop *stop = method->holds.stops + k;
        double across[2], rate[2];
        restraint_displacement(stop->rows, method->half / 2, state, across);
        restraint_displacement(stop->rows, method->half / 2, state + method->half, rate);
        turn_stop(stop_state, stop_state_of(stop, across, rate, (int)stop_state[STOP_STATE]));
    }
}

void taylor_change_stop(const TaylorStep *method, const double *state, double *slider_states, int j)
{
    const Stop *stop = method->holds.stops + j;
    double *own = taylor_stop_states(method, slider_states) + STOP_DOUBLES * j, across[2], rate[2], beyond;
    restraint_displacement(stop->rows, method->half / 2, state, across);
    restraint_displacement(stop->rows, method->half / 2, state + method->half, rate);
    beyond = hypotenuse(across[0], across[1]) - stop->gap;
    if (own[STOP_STATE] == STOP_APART) {
        turn_stop(own, STOP_PRESSES);
    } else if (own[STOP_STATE] == STOP_PRESSES) {
        turn_stop(own, beyond > LIMIT_ROUNDING * stop->gap ? STOP_BEYOND : STOP_APART);
    } else { /* back inside, or pressing once more */
        turn_stop(own, beyond > LIMIT_ROUNDING * stop->gap ? STOP_PRESSES : STOP_APART);
    }
}
