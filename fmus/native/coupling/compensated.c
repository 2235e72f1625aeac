/* Compensated: one pass and no rollback; what a step missed is made good in the next one.  For separate
   FMUs: harness/master/schemes/compensated.py. */
#include <string.h>

#include "base/elementary.h"
#include "base/matrix.h"
#include "constants.h"
#include "coupling/composite.h"

enum { GAUSS_NODES = 12, MOST_COMPONENTS = 3 };

/* Gauss and Legendre on 0 to 1, exact to degree 23: the upper half of points, and their shares. */
static const double POINT[GAUSS_NODES / 2] = {
    0.5626167042557344, 0.6839157494990901, 0.7936589771433087,
    0.8849513370971523, 0.9520586281852375, 0.9907803171233596};
static const double SHARE[GAUSS_NODES / 2] = {
    0.12457352290670139, 0.11674626826917740, 0.10158371336153296,
    0.08003916427167311, 0.05346966299765922, 0.023587668193255914};

void compensated_begin(Composite *c, double step)
{
    const int e = c->orders * c->exchanges, p = c->orders * c->planes;
    c->course->compensated.compensated_step = 0.0;
    c->course->loop.largest = 0.0;
    c->course->loop.solved_step = step;
    matrix_product(1, p, e, e, c->wide, c->solution, c->solution + e * e);
}

static Complex plus(Complex a, double factor, Complex b)
{
    return complex_sum(a, complex_scaled(factor, b));
}

/* At s of a step of 1, what begins with each part of an end alone, and ends in nothing. */
static void falling_at(int parts, double s, double *falling)
{
    const double rest = 1.0 - s, square = rest * rest, cube = square * rest;
    if (parts == 2) {
        falling[0] = square * (1.0 + 2.0 * s);
        falling[1] = square * s;
    } else {
        falling[0] = cube * (1.0 + s * (3.0 + 6.0 * s));
        falling[1] = cube * s * (1.0 + 3.0 * s);
        falling[2] = cube * 0.5 * s * s;
    }
}

/* Moments about the end of this step of what was missed, and of what can be given, per part. */
static void moments(int parts, double turn, double ratio, Complex *residuals, Complex *given)
{
    int k, i, j;
    for (k = 0; k < GAUSS_NODES; k++) {
        const double s = k < GAUSS_NODES / 2 ? 1.0 - POINT[k] : POINT[k - GAUSS_NODES / 2];
        const double share = SHARE[k % (GAUSS_NODES / 2)], rest = 1.0 - s;
        const Complex before = rect(share, turn * s);
        const Complex after = rect(share * ratio, turn * (1.0 + ratio * s));
        double falling[MOST_COMPONENTS], mirrored[MOST_COMPONENTS], past = 1.0, now = 1.0;
        falling_at(parts, s, falling);
        falling_at(parts, rest, mirrored);
        for (i = 0; i < parts; i++, past *= rest + ratio, now *= ratio * rest) {
            for (j = 0; j < parts; j++) {
                const double rising = j == 1 ? -mirrored[j] : mirrored[j];
                residuals[parts * i + j] = plus(residuals[parts * i + j], rising * past, before);
                given[parts * i + j] = plus(given[parts * i + j], falling[j] * now, after);
            }
        }
    }
}

/* Signal over a step that gives a free mass what it missed in the step before. */
static void update_carried(Carried *carried, int parts, double turn, double past, double step)
{
    const Complex zero = {0.0, 0.0};
    const Knot nothing = {zero, zero, zero};
    Complex residuals[MOST_COMPONENTS * MOST_COMPONENTS], given[MOST_COMPONENTS * MOST_COMPONENTS];
    int k, i;
    if (carried->turn == turn && carried->past == past && carried->step == step) {
        return;
    }
    memset(residuals, 0, sizeof residuals);
    memset(given, 0, sizeof given);
    moments(parts, turn, step / past, residuals, given);
    matrix_solve(2, parts, parts, (double *)given, (double *)residuals);
    for (i = 0; i < parts; i++) {
        Complex signal[QUINTIC_ORDERS];
        const Knot start = {residuals[i], residuals[parts + i], parts > 2 ? residuals[2 * parts + i] : zero};
        double power = 1.0;
        knot_hermite(&start, &nothing, 2 * parts, 1.0, signal);
        for (k = 0; k < 2 * parts; k++, power *= step) {
            carried->rows[k][i] = complex_of(signal[k].re / power, signal[k].im / power);
        }
    }
    carried->turn = turn;
    carried->past = past;
    carried->step = step;
}

/* Signals over the step with what was missed in the past one added. */
static void make_good(const Carried *carried, int parts, const Complex *residuals, int count,
                      Complex *signals)
{
    int j, k, i;
    for (j = 0; j < count; j++, residuals += parts, signals += 2 * parts) {
        for (k = 0; k < 2 * parts; k++) {
            for (i = 0; i < parts; i++) {
                signals[k] = complex_sum(signals[k], complex_product(carried->rows[k][i], residuals[i]));
            }
        }
    }
}

/* What forces and accelerations would have agreed, less those assumed and answered. */
static void solve(Composite *c, double step)
{
    const int o = c->orders, e = o * c->exchanges, p = o * c->planes;
    int k;
    loop_rescale(c, e + p, step);
    for (k = 0; k < c->exchanges; k++) {
        const Knot expected = knot_end(c->assumed + o * k, o, step);
        Knot gap;
        gap.value = complex_difference(c->answers[k].value, expected.value);
        gap.slope = complex_difference(c->answers[k].slope, expected.slope);
        gap.second = complex_difference(c->answers[k].second, expected.second);
        loop_pack(c, &gap, 1, step, c->residual + o * k);
    }
    matrix_product(1, e + p, e, 1, c->solution, c->residual, &c->residuals->re);
}

/* A signal's end with what was missed added, each part over its power of the step. */
static Knot righted(Knot end, int parts, const Complex *residuals, double step)
{
    end.value = plus(end.value, 1.0, residuals[0]);
    end.slope = plus(end.slope, 1.0 / step, residuals[1]);
    if (parts > 2) {
        end.second = plus(end.second, 1.0 / step / step, residuals[2]);
    }
    return end;
}

/* Go on from the end of a step as long as the one before: what is continued is the quintic that was
   assumed, bent so that it has the value, slope and second derivative found, and the value and second
   derivative of a step before, and the second derivative of two. */
static void bend(Signal *signal, const Complex *assumed, double step)
{
    static const double bending[3][3] = {
        {-7.5, 7.5, -27.0 / 16.0}, {0.0, 0.0, 1.0}, {45.0, -45.0, 105.0 / 8.0}};
    const Knot extrapolated = knot_end(assumed, QUINTIC_ORDERS, step);
    Complex residuals[3] = {
        complex_difference(signal->now.value, extrapolated.value),
        complex_scaled(step, complex_difference(signal->now.slope, extrapolated.slope)),
        complex_scaled(step * step, complex_difference(signal->now.second, extrapolated.second))};
    double power = step * step * step;
    int k, i;
    for (k = 0; k < 3; k++, power *= step) {
        signal->last[3 + k] = assumed[3 + k];
        for (i = 0; i < 3; i++) {
            signal->last[3 + k] = plus(signal->last[3 + k], bending[k][i] / power, residuals[i]);
        }
    }
    signal->prediction_error = magnitude(residuals[0]);
}

/* Right the ends of all signals, and go on from there. */
static int accept(Unit *unit, double past, double step)
{
    Composite *c = unit->own;
    const int o = c->orders, parts = o / 2, bends = o == QUINTIC_ORDERS && past == step;
    int k;
    for (k = 0; k < c->exchanges; k++) {
        const Knot end = knot_end(c->assumed + o * k, o, step);
        c->answers[k] = righted(end, parts, c->residuals + parts * k, step);
    }
    for (k = 0; k < c->planes; k++) {
        signal_predicted(c->accelerations + k, o, c->plane_signals + o * k);
        c->ends[k] = righted(c->ends[k], parts, c->residuals + parts * (c->exchanges + k), step);
    }
    if (composite_accept(unit, c->ends, c->answers, step)) {
        return 1;
    }
    for (k = 0; k < c->exchanges && bends; k++) {
        bend(c->forces + k, c->assumed + o * k, step);
    }
    for (k = 0; k < c->planes && bends; k++) {
        bend(c->accelerations + k, c->plane_signals + o * k, step);
    }
    return 0;
}

int compensated_step(Unit *unit, double step, int jump)
{
    Composite *c = unit->own;
    Course *course = c->course;
    const int o = c->orders, parts = o / 2;
    const double past = jump ? 0.0 : course->compensated.compensated_step;
    const double speed = c->parts->unit->real[c->parts->drive];
    int k;
    for (k = 0; k < c->exchanges; k++) {
        signal_predicted(c->forces + k, o, c->assumed + o * k);
    }
    copy_doubles((size_t)(2 * o * c->exchanges), &c->assumed->re, &c->sent->re);
    if (past > 0.0) {
        update_carried(c->carried, parts, speed * past, past, step);
        make_good(c->carried, parts, c->residuals, c->exchanges, c->sent);
    }
    if (composite_rotor_pass(unit, c->sent, step)) {
        return 1;
    }
    for (k = 0; k < c->planes; k++) {
        Complex *plane_signals = c->plane_signals + o * k;
        if (jump && o == QUINTIC_ORDERS) {
            knot_leading(c->ends + k, step, plane_signals);
        } else {
            knot_hermite(&c->accelerations[k].now, c->ends + k, o, step, plane_signals);
        }
    }
    if (past > 0.0) {
        update_carried(c->carried + 1, parts, 0.0, past, step);
        make_good(c->carried + 1, parts, c->residuals + parts * c->exchanges, c->planes, c->plane_signals);
    }
    if (composite_balancer_pass(unit, c->plane_signals, step)) {
        return 1;
    }
    solve(c, step);
    course->compensated.compensated_step = jump ? 0.0 : step;
    return accept(unit, past, step);
}
