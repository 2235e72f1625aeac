#include "rotor/taylor_step.h"

#include "base/elementary.h"
#include "base/matrix.h"
#include "rotor/taylor_series.h"

enum { MOST_STRETCHES = 10000, MOST_SWEEPS = 10000 };
static const double SWEEP_CONVERGED = 1e-15;

int taylor_resolve(TaylorStep *method, const double *state, double *slider_states,
                   const Excitation *excitation, double t, Failure *failure)
{
    const int m = method->count, half = method->half;
    double *found = method->hold, *free = method->hold + m, *without = method->slider_states;
    int j, k, resting = 0, sweep, code, settled = 0;
    taylor_settle_stops(method, state, slider_states);
    copy_doubles(holds_doubles(&method->holds), slider_states, without);
    for (j = 0; j < m; j++) {
        const Slider *slider = method->sliders + j;
        method->limits[j] = 0.0;
        if (slider_is_rigid(slider) && (slider_states[SLIDER_DOUBLES * j + SLIPS] == 0.0 ||
                                        state[half + slider_place(slider)] == 0.0)) {
            method->limits[j] = slider->limit;
            without[SLIDER_DOUBLES * j + SLIPS] = 1.0; /* as if without them */
            without[SLIDER_DOUBLES * j + HOLDS] = 0.0;
            resting++;
        }
    }
    if (!resting) {
        return FINE;
    }
    code = taylor_set_series(method, state, without, excitation, t, 1.0, 1, failure);
    if (code) {
        return code;
    }
    for (j = 0; j < m; j++) {
        found[j] = 0.0;
        free[j] = method->series[method->length + half + slider_place(method->sliders + j)];
    }
    for (sweep = 0; sweep < MOST_SWEEPS && !settled; sweep++) {
        settled = 1;
        for (j = 0; j < m; j++) {
            const double *mobility = method->push + slider_place(method->sliders + j) * m;
            const double limit = method->limits[j], before = found[j];
            double rate = free[j];
            if (limit == 0.0) {
                continue; /* it is no rigid one at rest */
            }
            for (k = 0; k < m; k++) {
                rate += mobility[k] * found[k];
            }
            found[j] = smaller(larger(before - rate / mobility[j], -limit), limit);
            settled &= absolute(found[j] - before) <= SWEEP_CONVERGED * limit;
        }
    }
    for (j = 0; j < m; j++) {
        if (method->limits[j] > 0.0) {
            slider_states[SLIDER_DOUBLES * j + SLIPS] =
                absolute(found[j]) < method->limits[j] ? 0.0 : -copy_sign(1.0, found[j]);
            slider_states[SLIDER_DOUBLES * j + HOLDS] = found[j];
        }
    }
    return FINE;
}

/* Take the rounding of a rate that has come to 0 from the velocities. */
static void stop_at(const Slider *slider, int half, double *velocity)
{
    const double rate = slider_along(slider, half / 2, velocity);
    double square = 0.0;
    int k;
    for (k = 0; k < half; k++) {
        const double share = slider_share(slider, k);
        square += share * share;
    }
    for (k = 0; k < half; k++) {
        velocity[k] -= rate / square * slider_share(slider, k);
    }
}

/* The sliders after the event of slider j; `arrived`: by a motion, not at once. */
static int change_sliders(TaylorStep *method, double *state, double *slider_states,
                          const Excitation *excitation, double t, int j, int arrived, Failure *failure)
{
    const Slider *slider = method->sliders + j;
    double *friction = slider_states + SLIDER_DOUBLES * j;
    if (slider->stroke > 0.0 && friction[SLIPS] == 0.0 && absolute(friction[HOLDS]) < 0.5 * slider->limit) {
        /* at an end of the free stroke */
        const double was = friction[SIDE];
        friction[SIDE] = was != 0.0 ? 0.0 : copy_sign(1.0, friction[PLAY]);
        friction[PLAY] = (was != 0.0 ? was : friction[SIDE]) * slider->stroke;
        friction[HOLDS] = 0.0;
        return FINE;
    }
    if (friction[SLIPS] == 0.0) {
        friction[SLIPS] = -copy_sign(1.0, friction[HOLDS]);
        friction[HOLDS] = -friction[SLIPS] * slider->limit;
        return FINE;
    }
    friction[SLIPS] = 0.0;
    stop_at(slider, method->half, state + method->half);
    return arrived && slider_is_rigid(slider)
               ? taylor_resolve(method, state, slider_states, excitation, t, failure)
               : FINE;
}

static double value_at(const double *from, int stride, double s)
{
    double total = 0.0;
    int k;
    for (k = TERMS; k >= 0; k--) {
        total = total * s + from[k * stride];
    }
    return total;
}

/* What is remembered of sliders and stops at a fraction of a stretch. */
static void remember(const TaylorStep *method, double fraction, double *slider_states)
{
    const Holds *holds = &method->holds;
    double *own = slider_states;
    int k;
    for (k = 0; k < holds->slider_count; k++, own += SLIDER_DOUBLES) {
        own[HOLDS] = value_at(method->forces + k, method->count, fraction);
        if (slider_is_loose(holds->sliders + k, own)) {
            int i;
            for (i = 0; i < method->half; i++) {
                const double *column = method->series + i, share = slider_share(holds->sliders + k, i);
                if (share != 0.0) {
                    own[PLAY] += share * (value_at(column, method->length, fraction) - column[0]);
                }
            }
        }
    }
    for (k = 0; k < holds->stop_count; k++, own += STOP_DOUBLES) {
        if (own[STOP_STATE] == STOP_PRESSES) {
            const double *pressure = taylor_restraint(method, holds->cubic_count + k).pressure;
            own[STOP_LARGEST] = larger(own[STOP_LARGEST], largest_of_series(pressure, TERMS, fraction));
        }
    }
}

int taylor_advance(TaylorStep *method, double *state, double *slider_states,
                   const Excitation *excitation, double step, int stops, double *reached,
                   Failure *failure)
{
    const Holds *holds = &method->holds;
    double time = 0.0;
    int count, k, code = taylor_resolve(method, state, slider_states, excitation, 0.0, failure);
    for (count = 0; count < MOST_STRETCHES && !code; count++) {
        /* no longer than what is left: forces of short steps may have any slope */
        const double stretch = smaller(taylor_stretch(method, excitation, time), step - time);
        double fraction, until;
        int last = stretch == step - time;
        int which;
        code = taylor_set_series(method, state, slider_states, excitation, time, stretch, TERMS, failure);
        if (code) {
            return code;
        }
        until = taylor_part_in_reach(method);
        last &= until == 1.0;
        fraction = taylor_first_event(method, slider_states, stretch, until, &which);
        remember(method, fraction, slider_states);
        for (k = 0; k < 2 * method->half; k++) {
            state[k] = value_at(method->series + k, method->length, fraction);
        }
        if (which < 0 && last) {
            *reached = step;
            return FINE;
        }
        time += fraction * stretch;
        if (which >= 0) {
            if (which < holds->slider_count) {
                code = change_sliders(method, state, slider_states, excitation, time, which, fraction > 0.0, failure);
            } else {
                taylor_change_stop(method, state, slider_states, which - holds->slider_count);
            }
            if (stops) {
                *reached = time;
                return code;
            }
        }
    }
    return code ? code
                : fail(failure, "the rotor vibrates too fast, or its sliders change too often, for a "
                       "step of %6 s: %6 s reached in %u stretches; use smaller communication steps",
                       step, time, (unsigned long)MOST_STRETCHES);
}

int taylor_motion(TaylorStep *method, const double *state, const double *slider_states,
                  const Excitation *excitation, double t, double *rates, Failure *failure)
{
    static const double factorials[DERIVATIVES] = {1.0, 1.0, 2.0};
    const int half = method->half;
    const double *velocity = method->series + half;
    int i, k;
    const int code =
        taylor_set_series(method, state, slider_states, excitation, t, 1.0, DERIVATIVES - 1, failure);
    for (k = 0; k < DERIVATIVES && !code; k++, velocity += method->length, rates += half) {
        for (i = 0; i < half; i++) {
            rates[i] = factorials[k] * velocity[i];
        }
    }
    return code;
}

int taylor_plane_motion(TaylorStep *method, const double *state, double *slider_states,
                        const Excitation *excitation, double t, double *planes, Failure *failure)
{
    const int p = method->plane_count, n = method->half / 2;
    double *rates = method->faster + method->half;
    int k;
    const int code = taylor_motion(method, state, slider_states, excitation, t, rates, failure);
    for (k = 1; k < DERIVATIVES && !code; k++, planes += 2 * p) {
        combine_vectors(method->planes, p, n, rates + k * method->half, planes);
    }
    for (k = 0; k < method->count && !code; k++) {
        slider_states[SLIDER_DOUBLES * k + HOLDS] = method->forces[k];
    }
    return code;
}
