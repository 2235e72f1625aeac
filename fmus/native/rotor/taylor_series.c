/* The Taylor series of a stretch, and how long that may be. */
#include "rotor/taylor_series.h"

#include "base/elementary.h"
#include "base/matrix.h"

static const double REACH = 0.5;
static const double ROUNDING_OF_TERMS = 1e-17; /* of the largest term of a stretch */

/* -- cubic springs and stops ------------------------------------------------------------------------ */

RestraintSeries taylor_restraint(const TaylorStep *method, int number)
{
    return restraint_series_in(
        method->restraint_data + (size_t)number * restraint_series_size(RESTRAINT_TERMS), RESTRAINT_TERMS);
}

double *taylor_stop_states(const TaylorStep *method, double *slider_states)
{
    return slider_states + SLIDER_DOUBLES * method->holds.slider_count;
}

/* Add coefficient k of the accelerations by cubic springs and stops over a stretch h. */
static void add_restraints(TaylorStep *method, const double *slider_states, int k, double h, const double *motion)
{
    const Holds *holds = &method->holds;
    const int n = method->half / 2, count = holds->cubic_count + holds->stop_count;
    const double *stop_state = slider_states + SLIDER_DOUBLES * holds->slider_count;
    int j, i;
    for (j = 0; j < count; j++) {
        const int number = j - holds->cubic_count;
        RestraintSeries series = taylor_restraint(method, j);
        double force[2] = {0.0, 0.0}, across[2];
        if (number < 0) {
            restraint_displacement(holds->cubics[j].rows, n, motion, across);
            restraint_displace(&series, k, across);
            cubic_series_force(holds->cubics + j, &series, k, force);
        } else {
            Stop stop = holds->stops[number];
            if (k == 0) {
                restraint_displacement(stop.rows, n, motion, across);
                restraint_displace(&series, 0, across);
            }
            restraint_displacement(stop.rows, n, motion + method->half, across);
            across[0] *= h / (k + 1);
            across[1] *= h / (k + 1);
            restraint_displace(&series, k + 1, across);
            stop.damping /= h;
            if (stop_state[STOP_DOUBLES * number + STOP_STATE] == STOP_PRESSES) {
                stop_series_force(&stop, &series, k, force);
            } else if (stop_state[STOP_DOUBLES * number + STOP_STATE] == STOP_BEYOND) {
                stop_series_pressure(&stop, &series, k);
            }
        }
        for (i = 0; i < method->half; i++) {
            method->rate[i] += method->answers[j * method->half + i] * force[i % 2];
        }
    }
}

double taylor_part_in_reach(const TaylorStep *method)
{
    static const double SHORTER = 0.9;
    const int half = method->half;
    double part = 1.0;
    int which, k, i;
    if (!method->holds.cubic_count && !method->holds.stop_count) {
        return part;
    }
    for (which = 0; which < 2; which++) {
        double size = 0.0, last = 0.0;
        for (k = 0; k <= TERMS; k++) {
            for (i = 0; i < half; i++) {
                const double term = absolute(method->series[k * method->length + which * half + i]);
                size = larger(size, term);
                last = k >= TERMS - 1 ? larger(last, term) : last;
            }
        }
        while (last > ROUNDING_OF_TERMS * size) {
            int power;
            part *= SHORTER;
            for (power = 0; power < TERMS - 1; power++) {
                last *= SHORTER;
            }
        }
    }
    return part;
}

/* -- stretches -------------------------------------------------------------------------------------- */

double taylor_stretch(const TaylorStep *method, const Excitation *excitation, double t)
{
    const Spin now = spin_after(&excitation->spin, t);
    const double *norms = method->norms, *rates = now.rates;
    const double w = absolute(now.speed);
    const double rate = square_root(norms[0] + w * norms[1]) + norms[2] + w * norms[3] + w;
    double h = REACH / (rate + square_root(absolute(rates[0])));
    while (h * h * h *
               (absolute(rates[1]) +
                h * (absolute(rates[2]) / 2.0 + h * absolute(rates[3]) / 6.0)) >
           REACH * REACH * REACH) {
        h *= 0.5;
    }
    return h;
}

/* Whether a slider is held by a constraint: rigid, and it sticks. */
static bool is_fixed(const TaylorStep *method, const double *slider_states, int j)
{
    return slider_is_rigid(method->sliders + j) && slider_states[SLIDER_DOUBLES * j + SLIPS] == 0.0;
}

/* Forces of rigid sliders that stick, from the rates without them, which become 0 there. */
static int hold_fixed(TaylorStep *method, const double *slider_states, double *rate, double *forces)
{
    const int m = method->count;
    int i, j, row = 0, fixed = 0;
    for (j = 0; j < m; j++) {
        fixed += is_fixed(method, slider_states, j);
    }
    for (i = 0; i < m && fixed; i++) {
        const int place = slider_place(method->sliders + i);
        int column = 0;
        if (!is_fixed(method, slider_states, i)) {
            continue;
        }
        for (j = 0; j < m; j++) {
            if (is_fixed(method, slider_states, j)) {
                method->mobility[row * fixed + column++] = method->push[place * m + j];
            }
        }
        method->hold[row++] = -rate[place];
    }
    if (fixed && matrix_solve(1, fixed, 1, method->mobility, method->hold)) {
        return 1;
    }
    for (j = 0, row = 0; j < m; j++) {
        if (is_fixed(method, slider_states, j)) {
            forces[j] = method->hold[row++];
            for (i = 0; i < method->dof; i++) {
                rate[i] += method->push[i * m + j] * forces[j];
            }
        }
    }
    for (j = 0; j < m; j++) {
        if (is_fixed(method, slider_states, j)) {
            rate[slider_place(method->sliders + j)] = 0.0;
        }
    }
    return 0;
}

/* Coefficients k of the sliders' forces, but of those that `hold_fixed` finds. */
static void set_forces(TaylorStep *method, const double *slider_states, int k, double *motion)
{
    double *forces = method->forces + k * method->count;
    int j;
    for (j = 0; j < method->count; j++) {
        const Slider *slider = method->sliders + j;
        const double *own = slider_states + SLIDER_DOUBLES * j;
        const int sticks = own[SLIPS] == 0.0;
        if (k) {
            const int pulls = sticks && slider->stiffness > 0.0 && !slider_is_loose(slider, own);
            forces[j] = pulls ? -slider->stiffness * slider_along(slider, method->half / 2, motion) : 0.0;
        } else if (sticks && slider_is_rigid(slider)) {
            forces[j] = motion[method->half + slider_place(slider)] = 0.0;
        } else {
            forces[j] = own[HOLDS];
        }
    }
}

/* Coefficient k of the acceleration, without the sliders that stick. */
static void set_rate(TaylorStep *method, const SpinSeries *spin, int k, double h, const double *slider_states,
                     const double *motion)
{
    const int parts = method->parts, dof = method->dof, m = method->count;
    const int length = method->length, width = length / parts;
    /* a rotor may be the same at every speed */
    const int changes = method->norms[1] > 0.0 || method->norms[3] > 0.0;
    const double *forces = method->forces + k * m;
    double *rate = method->rate;
    int i, j, back;
    matrix_product(parts, dof, width, 1, method->matrix, motion, rate);
    for (i = 0; i < method->half && !k; i++) {
        rate[i] += method->gravity[i % 2];
    }
    for (i = 0; i < dof && m; i++) {
        for (j = 0; j < m; j++) {
            rate[i] += method->push[i * m + j] * forces[j];
        }
    }
    for (back = 1; back < SPEED_TERMS && back <= k && changes; back++) {
        if (spin->speed[back] != 0.0) {
            matrix_product(parts, dof, width, 1, method->per_speed, motion - back * length,
                           method->faster);
            add_multiple(1, method->half, spin->speed + back, method->faster, rate);
        }
    }
    add_restraints(method, slider_states, k, h, motion);
}

int taylor_set_series(TaylorStep *method, const double *state, const double *slider_states,
                      const Excitation *excitation, double t, double h, int terms, Failure *failure)
{
    const int half = method->half, length = method->length;
    const SpinSeries spin = spin_series(&excitation->spin, t, h);
    double *motion = method->series;
    int i, k;
    fill_pushes(excitation, &spin, t, h, terms, motion + 2 * half, length, method->turn);
    copy_doubles((size_t)method->dof * length, method->still, method->matrix);
    add_multiple(1, method->dof * length, spin.speed, method->per_speed, method->matrix);
    copy_doubles(2 * (size_t)half, state, motion);
    for (k = 0; k <= terms; k++, motion += length) {
        const double factor = h / (k + 1);
        set_forces(method, slider_states, k, motion);
        set_rate(method, &spin, k, h, slider_states, motion);
        if (hold_fixed(method, slider_states, method->rate, method->forces + k * method->count)) {
            return fail(failure, SINGULAR_MATRIX);
        }
        for (i = 0; i < half && k < terms; i++) {
            motion[length + i] = factor * motion[half + i];
            motion[length + half + i] = factor * method->rate[i];
        }
    }
    return FINE;
}
