/* Compensated: one pass and no rollback; what a step missed is made good in the next one.  Twin of
   harness/master/schemes/compensated.py (and of explicit.py, for the loop that diverges). */
#include <string.h>

#include "composite.h"
#include "elementary.h"
#include "matrix.h"

enum { NODES = 12, LOST = 12, CALM = 4 };
static const double MISSED = 0.5, GROWN = 1e3;

/* Gauss and Legendre on 0 to 1, exact to degree 23: the upper half of points, and their shares. */
static const double POINT[NODES / 2] = {
    0.5626167042557344, 0.6839157494990901, 0.7936589771433087,
    0.8849513370971523, 0.9520586281852375, 0.9907803171233596};
static const double SHARE[NODES / 2] = {
    0.12457352290670139, 0.11674626826917740, 0.10158371336153296,
    0.08003916427167311, 0.05346966299765922, 0.023587668193255914};

void compensated_begin(Composite *c, double step)
{
    const int e = 4 * c->exchanges, p = 4 * c->planes;
    c->course->missed_step = 0.0;
    c->course->largest = c->course->largest_before = 0.0;
    c->course->lost = c->course->calm = 0.0;
    c->course->solved_step = step;
    matrix_product(1, p, e, e, c->wide, c->solution, c->solution + e * e);
}

static Complex plus(Complex a, double factor, Complex b)
{
    return complex_sum(a, complex_scaled(factor, b));
}

/* Cubic over a step that gives a free mass what it missed in the step before. */
static void carry(Carried *carried, double turn, double past, double step)
{
    static const double shape[SIGNAL_ORDERS][2] = {
        {1.0, 0.0}, {0.0, 1.0}, {-6.0, -4.0}, {12.0, 6.0}};
    const double ratio = step / past;
    Complex missed[4], given[4]; /* (2, 2): impulse and its moment, per value and slope */
    double power = 1.0;
    int k, i;
    if (carried->turn == turn && carried->past == past && carried->step == step) {
        return;
    }
    memset(missed, 0, sizeof missed);
    memset(given, 0, sizeof given);
    for (k = 0; k < NODES; k++) {
        const double s = k < NODES / 2 ? 1.0 - POINT[k] : POINT[k - NODES / 2];
        const double share = SHARE[k % (NODES / 2)], rest = 1.0 - s;
        const double rising[2] = {s * s * (3.0 - 2.0 * s), s * s * (s - 1.0)};
        const double falling[2] = {1.0 - rising[0], s * rest * rest};
        const Complex before = rect(share, turn * s);
        const Complex after = rect(share * ratio, turn * (1.0 + ratio * s));
        for (i = 0; i < 2; i++) {
            missed[i] = plus(missed[i], rising[i], before);
            missed[2 + i] = plus(missed[2 + i], rising[i] * (rest + ratio), before);
            given[i] = plus(given[i], falling[i], after);
            given[2 + i] = plus(given[2 + i], falling[i] * ratio * rest, after);
        }
    }
    matrix_solve(2, 2, 2, (double *)given, (double *)missed);
    for (k = 0; k < SIGNAL_ORDERS; k++, power *= step) {
        for (i = 0; i < 2; i++) {
            const Complex value = complex_scaled(shape[k][0], missed[i]);
            const Complex sum = plus(value, shape[k][1], missed[2 + i]);
            carried->rows[k][i] = complex_of(sum.re / power, sum.im / power);
        }
    }
    carried->turn = turn;
    carried->past = past;
    carried->step = step;
}

/* Signals over the step with what was missed in the past one added. */
static void make_good(const Carried *carried, const Missed *missed, int count, Complex *signals)
{
    int j, k;
    for (j = 0; j < count; j++, signals += SIGNAL_ORDERS) {
        for (k = 0; k < SIGNAL_ORDERS; k++) {
            const Complex *row = carried->rows[k];
            signals[k] = complex_sum(signals[k], complex_product(row[0], missed[j].value));
            signals[k] = complex_sum(signals[k], complex_product(row[1], missed[j].slope));
        }
    }
}

/* Compare the forces at the end of a step with those assumed for it; 1 with the reason where they
   diverge. */
static int diverges(Unit *unit, double step)
{
    const Composite *c = unit->own;
    Course *course = c->course;
    double worst = 0.0;
    Text *reason;
    int k;
    for (k = 0; k < c->exchanges; k++) {
        const Complex expected = knot_end(c->assumed + SIGNAL_ORDERS * k, SIGNAL_ORDERS, step).value;
        const Complex value = c->answers[k].value;
        const double missed = magnitude(complex_difference(value, expected));
        worst = missed <= worst ? worst : missed;
        course->largest = larger(course->largest, magnitude(value));
    }
    if (worst <= MISSED * course->largest) {
        course->calm += 1.0;
        course->lost = course->calm >= CALM ? 0.0 : course->lost;
        return 0;
    }
    if (course->lost == 0.0) {
        course->largest_before = course->largest;
    }
    course->calm = 0.0;
    course->lost += 1.0;
    if (course->lost < LOST || course->largest < GROWN * course->largest_before) {
        return 0;
    }
    reason = unit_reason(unit);
    text_put(reason, "compensated coupling diverges");
    composite_put_time(reason, course->time + step);
    text_put(reason, ": ");
    composite_name_forces(c, reason);
    text_put(reason, " differs from what was assumed for the step by ");
    text_rounded(reason, worst / course->largest, 3);
    text_put(reason, " of the largest force and grows; build with scheme = \"iterated\" or \"auto\"");
    return 1;
}

/* What forces and accelerations would have agreed, less those assumed and answered. */
static void solve(Composite *c, double step)
{
    const int e = 4 * c->exchanges, p = 4 * c->planes;
    int k;
    loop_rescale(c, e + p, step);
    for (k = 0; k < c->exchanges; k++) {
        const Knot expected = knot_end(c->assumed + SIGNAL_ORDERS * k, SIGNAL_ORDERS, step);
        Knot gap;
        gap.value = complex_difference(c->answers[k].value, expected.value);
        gap.slope = complex_difference(c->answers[k].slope, expected.slope);
        loop_pack(c, &gap, 1, step, c->residual + 4 * k);
    }
    matrix_product(1, e + p, e, 1, c->solution, c->residual, (double *)c->missed);
}

/* A signal's end with what was missed (value, and slope times step) added. */
static Knot righted(Knot end, Missed missed, double step)
{
    const Complex slope = complex_scaled(1.0 / step, missed.slope);
    end.value = complex_sum(end.value, missed.value);
    end.slope = complex_sum(end.slope, slope);
    return end;
}

int compensated_step(Unit *unit, double step, int jump)
{
    Composite *c = unit->own;
    Course *course = c->course;
    const double past = jump ? 0.0 : course->missed_step;
    const double speed = c->parts->unit->real[c->parts->drive];
    int k;
    for (k = 0; k < c->exchanges; k++) {
        signal_predicted(c->forces + k, SIGNAL_ORDERS, c->assumed + SIGNAL_ORDERS * k);
    }
    copy_doubles((size_t)(2 * SIGNAL_ORDERS * c->exchanges), &c->assumed->re, &c->sent->re);
    if (past > 0.0) {
        carry(c->carried, speed * past, past, step);
        make_good(c->carried, c->missed, c->exchanges, c->sent);
    }
    if (composite_rotor_pass(unit, c->sent, step)) {
        return 1;
    }
    for (k = 0; k < c->planes; k++) {
        knot_hermite(&c->accelerations[k].now, c->ends + k, SIGNAL_ORDERS, step,
                     c->felt + SIGNAL_ORDERS * k);
    }
    if (past > 0.0) {
        carry(c->carried + 1, 0.0, past, step);
        make_good(c->carried + 1, c->missed + c->exchanges, c->planes, c->felt);
    }
    if (composite_balancer_pass(unit, c->felt, step) || diverges(unit, step)) {
        return 1;
    }
    solve(c, step);
    for (k = 0; k < c->exchanges; k++) {
        const Knot end = knot_end(c->assumed + SIGNAL_ORDERS * k, SIGNAL_ORDERS, step);
        c->answers[k] = righted(end, c->missed[k], step);
    }
    for (k = 0; k < c->planes; k++) {
        c->ends[k] = righted(c->ends[k], c->missed[c->exchanges + k], step);
    }
    course->missed_step = jump ? 0.0 : step;
    return composite_accept(unit, c->ends, c->answers, step);
}
