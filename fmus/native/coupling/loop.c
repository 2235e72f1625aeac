#include <string.h>

#include "base/elementary.h"
#include "base/matrix.h"
#include "constants.h"
#include "coupling/composite.h"

enum { SQUARINGS = 50 };

/* -- vectors --------------------------------------------------------------------------------- */

void loop_pack(const Knot *ends, int count, double step, double *u)
{
    int k;
    for (k = 0; k < count; k++, u += UNKNOWN_REALS) {
        u[0] = ends[k].value.re;
        u[1] = ends[k].value.im;
        u[2] = step * ends[k].slope.re;
        u[3] = step * ends[k].slope.im;
    }
}

void loop_unpack(const double *u, int count, double step, Knot *ends)
{
    const double per_step = 1.0 / step;
    int k;
    for (k = 0; k < count; k++, u += UNKNOWN_REALS) {
        ends[k].value = complex_of(u[0], u[1]);
        ends[k].slope = complex_of(per_step * u[2], per_step * u[3]);
    }
}

double loop_size(const double *u, int count)
{
    double largest = 0.0;
    int k, at = 0;
    for (k = 0; k < count; k++) {
        const double square = u[2 * k] * u[2 * k] + u[2 * k + 1] * u[2 * k + 1];
        if (square > largest) {
            largest = square;
            at = k;
        }
    }
    return count ? magnitude(complex_of(u[2 * at], u[2 * at + 1])) : 0.0;
}

/* -- matrices -------------------------------------------------------------------------------- */

/* Gelfand: the n-th root of the size of the n-th power, n = 2^50, by squaring. */
double spectral_radius(int n, double *matrix, double *work)
{
    const size_t count = (size_t)n * (size_t)n;
    double sizes[SQUARINGS + 1], radius = 1.0;
    int turn;
    if (n == 1) {
        return absolute(matrix[0]);
    }
    for (turn = 0; turn <= SQUARINGS; turn++) {
        double size = 0.0;
        size_t k;
        for (k = 0; k < count; k++) {
            size = larger(size, absolute(matrix[k]));
        }
        if (!(size > 0.0)) {
            return 0.0;
        }
        sizes[turn] = size;
        for (k = 0; k < count; k++) {
            work[k] = matrix[k] / size;
        }
        matrix_product(1, n, n, n, work, work, matrix);
    }
    while (turn--) { /* what the t-th was divided by counts by its 2^t-th root */
        radius = sizes[turn] * square_root(radius);
    }
    return radius;
}

/* The part of a matrix between values, (2 e, 2 e). */
static void values_of(const Composite *c, const double *matrix, double *values)
{
    const int count = 2 * c->unknowns;
    int i, j;
    for (i = 0; i < count; i++) {
        for (j = 0; j < count; j++) {
            const int row = UNKNOWN_REALS * (i / 2) + i % 2;
            const int column = UNKNOWN_REALS * (j / 2) + j % 2;
            *values++ = matrix[row * UNKNOWN_REALS * c->unknowns + column];
        }
    }
}

double loop_gain(Composite *c, const double *jacobian)
{
    const int count = 2 * c->unknowns;
    values_of(c, jacobian, c->work);
    return count ? spectral_radius(count, c->work, c->work + count * count) : 0.0;
}

int loop_jacobian(Unit *unit, Response response, const double *u, const double *g_u, double change,
                  int rows, double step, double *matrix)
{
    Composite *c = unit->own;
    const int count = UNKNOWN_REALS * c->unknowns;
    int i, j;
    for (j = 0; j < count; j++) {
        memcpy(c->moved, u, (size_t)count * sizeof(double));
        c->moved[j] += change;
        if (response(unit, c->moved, step, c->disturbed_answers)) {
            return 1;
        }
        for (i = 0; i < rows; i++) {
            matrix[i * count + j] = (c->disturbed_answers[i] - g_u[i]) / change;
        }
    }
    return 0;
}

int loop_invert(Unit *unit, const double *jacobian, double step)
{
    Composite *c = unit->own;
    const int n = UNKNOWN_REALS * c->unknowns, values = 2 * c->unknowns;
    int i, singular;
    c->course->loop.solved_step = step;
    memset(c->solution, 0, (size_t)(n * n) * sizeof(double));
    for (i = 0; i < n * n; i++) {
        c->work[i] = -jacobian[i];
    }
    for (i = 0; i < n; i++) {
        c->work[i * n + i] += 1.0;
        c->solution[i * n + i] = 1.0;
    }
    singular = n && matrix_solve(1, n, n, c->work, c->solution);
    if (n && !singular) {
        /* the largest eigenvalue of the inverse is one over the smallest of 1 - dG/du */
        values_of(c, c->solution, c->work);
        singular = !(spectral_radius(values, c->work, c->work + values * values) < 1.0 / LOOP_SINGULAR);
    }
    if (singular) {
        unit_fail(unit, "the loop between force and acceleration has gain 1: every force answers "
                  "itself, and there is no unique solution");
    }
    return singular;
}

void loop_rescale(Composite *c, double step)
{
    const double ratio = step / c->course->loop.solved_step;
    /* of value and slope * h of a knot, each as real and imaginary part */
    const double powers[UNKNOWN_REALS] = {1.0, 1.0, ratio, ratio};
    const int count = UNKNOWN_REALS * c->unknowns;
    double *element = c->solution;
    int i, j, k;
    if (ratio == 1.0) {
        return;
    }
    for (i = 0; i < count; i++) {
        const double power = powers[i % UNKNOWN_REALS];
        for (j = 0; j < count; j += UNKNOWN_REALS) {
            for (k = 0; k < UNKNOWN_REALS; k++) {
                *element *= power;
                *element++ /= powers[k];
            }
        }
    }
    c->course->loop.solved_step = step;
}

/* Broyden's good update (1965) of the inverse, by Sherman and Morrison. */
void loop_learn(Composite *c, const double *du, const double *old, const double *now)
{
    const int n = UNKNOWN_REALS * c->unknowns;
    double *change = c->work, *predicted = c->work + n, *row = c->work + 2 * n, weight = 0.0;
    int i, j;
    for (i = 0; i < n; i++) {
        change[i] = old[i] - now[i];
    }
    matrix_product(1, n, n, 1, c->solution, change, predicted);
    matrix_product(1, 1, n, n, du, c->solution, row);
    for (i = 0; i < n; i++) {
        weight += du[i] * predicted[i];
    }
    for (i = 0; i < n && weight != 0.0; i++) {
        for (j = 0; j < n; j++) {
            c->solution[i * n + j] += (du[i] - predicted[i]) / weight * row[j];
        }
    }
}

/* -- the start ------------------------------------------------------------------------------- */

/* Accelerations of the planes under forces without a step. */
static int rotor_answer(Unit *unit, const double *u, double step)
{
    Composite *c = unit->own;
    Part *rotor = c->parts;
    Knot ends[1];
    int k;
    for (k = 0; k < c->unknowns; k++) {
        loop_unpack(u + UNKNOWN_REALS * k, 1, step, ends);
        knot_from_start(ends, c->sent + SIGNAL_ORDERS * k);
    }
    if (c->motor) {
        shaft_tell(unit, c->sent + SIGNAL_ORDERS * c->force_count, 0.0);
    }
    composite_set_forces(unit, c->sent, 0.0);
    if (rotor->unit->equations->outputs(rotor->unit)) {
        return composite_part_failed(unit, rotor);
    }
    composite_read_accelerations(c, c->ends);
    return 0;
}

/* Forces that the balancers answer with, without a step. */
static int respond_at_start(Unit *unit, const double *u, double step, double *answer)
{
    Composite *c = unit->own;
    int k;
    if (rotor_answer(unit, u, step)) {
        return 1;
    }
    for (k = 0; k < c->planes; k++) {
        c->accelerations[k].now = c->ends[k];
    }
    for (k = 0; k < c->force_count; k++) {
        Part *part = c->parts + c->members[k];
        double *input = part->unit->real + part->unit->layout.inputs.first;
        memset(input, 0, SIGNAL_ORDERS * sizeof(Complex));
        memcpy(input, c->ends + c->member_planes[k], sizeof(Knot));
        if (part->unit->equations->outputs(part->unit)) {
            return composite_part_failed(unit, part);
        }
    }
    composite_read_forces(c, c->answers);
    if (c->motor && shaft_answer(unit, c->answers + c->force_count)) {
        return 1;
    }
    loop_pack(c->answers, c->unknowns, step, answer);
    return 0;
}

/* What comes into agreement: at the start, or wherever model exchange has gone. */
static const char *agreeing(const Composite *c)
{
    return c->course->clock.started > 0.0 ? "forces and accelerations" : "start values";
}

/* Solve u = G(u) from the Jacobian in c->square. */
static int solve_start(Unit *unit, double step)
{
    Composite *c = unit->own;
    Course *course = c->course;
    const int count = UNKNOWN_REALS * c->unknowns, half = count / 2;
    const double tolerance = larger(START_TOLERANCE, START_ROUNDING * course->loop.gain);
    double size = 0.0, left = 0.0, before;
    int turn, i;
    for (turn = 0; turn <= START_ITERATIONS; turn++) {
        memcpy(c->old, c->residual, (size_t)count * sizeof(double));
        for (i = 0; i < count; i++) {
            c->residual[i] = c->g_u[i] - c->u[i];
        }
        before = left;
        left = loop_size(c->residual, half);
        if (turn && left > SLOW_CONVERGENCE * before) { /* a weight sticks where the one before has slid */
            loop_learn(c, c->du, c->old, c->residual);
        }
        size = larger(loop_size(c->u, half), loop_size(c->g_u, half));
        if (turn && left <= larger(tolerance * size, course->loop.rounding)) {
            loop_unpack(c->g_u, c->unknowns, step, c->answers);
            for (i = 0; i < c->unknowns; i++) {
                c->forces[i].now = c->answers[i];
            }
            return 0;
        }
        matrix_product(1, count, count, 1, c->solution, c->residual, c->du);
        for (i = 0; i < count; i++) {
            c->u[i] += c->du[i];
        }
        if (respond_at_start(unit, c->u, step, c->g_u)) {
            return 1;
        }
    }
    return unit_fail(unit, "consistent %s were not found in %u iterations: forces still "
                     "change by %3 N of %3 N; loop gain %3", agreeing(c), (unsigned long)START_ITERATIONS,
                     left, size, course->loop.gain);
}

int loop_consistent_start(Unit *unit, double step)
{
    Composite *c = unit->own;
    const int count = UNKNOWN_REALS * c->unknowns;
    double change;
    int i;
    memset(c->u, 0, (size_t)count * sizeof(double));
    if (respond_at_start(unit, c->u, step, c->g_u)) {
        return 1;
    }
    change = loop_size(c->g_u, count / 2);
    if (loop_jacobian(unit, respond_at_start, c->u, c->g_u, change > 0.0 ? change : 1.0, count, step,
                      c->square)) {
        return 1;
    }
    for (i = 0; i < count * count; i++) {
        if (!is_finite(c->square[i])) {
            return unit_fail(unit, "%s: the forces of the balancers are not finite", agreeing(c));
        }
    }
    c->course->loop.gain = loop_gain(c, c->square);
    if (loop_invert(unit, c->square, step) || (count && solve_start(unit, step))) {
        return 1;
    }
    composite_drop_past(c);
    return 0;
}
