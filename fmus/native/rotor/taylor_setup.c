/* What a step of the linear rotor is made of: matrices by the speed, and what sliders, springs and stops push. */
#include "base/elementary.h"
#include "base/matrix.h"
#include "rotor/taylor_series.h"

static int doubles_of_row(int stations, int planes)
{
    return 4 * stations + 2 * planes + 2;
}

size_t holds_doubles(const Holds *holds)
{
    return SLIDER_DOUBLES * (size_t)holds->slider_count + STOP_DOUBLES * (size_t)holds->stop_count;
}

size_t taylor_step_size(int stations, int planes, const Holds *holds)
{
    const size_t half = 2 * (size_t)stations, m = (size_t)holds->slider_count, terms = TERMS + 1;
    const size_t length = (size_t)doubles_of_row(stations, planes);
    const size_t restraints = (size_t)(holds->cubic_count + holds->stop_count);
    return 3 * half * length + half * m + terms * (length + m + 2) + (DERIVATIVES + 2) * half + m * m + 3 * m +
           holds_doubles(holds) + restraints * (half + restraint_series_size(RESTRAINT_TERMS));
}

static double *next_block(double **memory, size_t count)
{
    double *first = *memory;
    *memory += count;
    return first;
}

/* Largest sum of a row's absolute values by displacements, or by velocities. */
static double row_norm(const TaylorStep *method, int velocities, const double *matrix)
{
    double norm = 0.0;
    int i, k;
    for (i = 0; i < method->dof; i++) {
        const double *row = matrix + i * method->length + velocities * method->half;
        double sum = 0.0;
        for (k = 0; k < method->half; k++) {
            sum += absolute(row[k]);
        }
        norm = larger(norm, sum);
    }
    return norm;
}

static void set_norms(TaylorStep *method)
{
    const int dof = method->dof, m = method->count;
    int i, j, k;
    copy_doubles((size_t)dof * method->length, method->still, method->matrix);
    for (j = 0; j < m; j++) {
        for (k = 0; k < method->half; k++) {
            const double share = slider_share(method->sliders + j, k);
            for (i = 0; i < dof && share != 0.0; i++) {
                method->matrix[i * method->length + k] -= method->push[i * m + j] * method->sliders[j].stiffness * share;
            }
        }
    }
    method->norms[0] = row_norm(method, 0, method->matrix);
    method->norms[1] = row_norm(method, 0, method->per_speed);
    method->norms[2] = row_norm(method, 1, method->matrix);
    method->norms[3] = row_norm(method, 1, method->per_speed);
}

/* The rows of linear_rotor.h in what no speed changes and what is proportional to it. */
static int split_rows(const LinearRotor *rotor, TaylorStep *made, double *scratch, Failure *failure)
{
    const int unbalance = made->length - 2;
    int i, k, code = linear_rotor_rows(rotor, 0.0, made->still, scratch, failure);
    code = code ? code : linear_rotor_rows(rotor, 1.0, made->per_speed, scratch, failure);
    for (i = 0; i < made->dof && !code; i++) {
        double *still = made->still + i * made->length;
        double *per_speed = made->per_speed + i * made->length;
        for (k = 0; k < made->length; k++) {
            if (k < unbalance) {
                per_speed[k] -= still[k];
            } else { /* its pull w^2 is among what it multiplies */
                still[k] = per_speed[k];
                per_speed[k] = 0.0;
            }
        }
    }
    return code;
}

/* Columns of M^-1 by which the sliders push. */
static int set_push(const LinearRotor *rotor, TaylorStep *made, double *mass, Failure *failure)
{
    const int n = rotor->stations, m = made->count;
    int j, k;
    matrix_per_axis(1, 2, n, n, rotor->mass, mass);
    for (k = 0; k < made->half; k++) {
        for (j = 0; j < m; j++) {
            made->push[k * m + j] = slider_share(made->sliders + j, k);
        }
    }
    return matrix_solve(1, 2 * n, m, mass, made->push)
               ? fail(failure, SINGULAR_MATRIX)
               : FINE;
}

/* Acceleration of every place by a force across the row of each cubic spring and stop. */
static int set_answers(const LinearRotor *rotor, TaylorStep *made, double *mass, Failure *failure)
{
    const Holds *holds = &made->holds;
    const int n = rotor->stations;
    int j;
    for (j = 0; j < holds->cubic_count + holds->stop_count; j++) {
        const double *rows =
            j < holds->cubic_count ? holds->cubics[j].rows : holds->stops[j - holds->cubic_count].rows;
        double *answer = made->answers + j * made->half;
        matrix_per_axis(1, 2, n, n, rotor->mass, mass);
        copy_doubles((size_t)made->half, rows, answer);
        if (matrix_solve(1, 2 * n, 1, mass, answer)) {
            return fail(failure, SINGULAR_MATRIX);
        }
    }
    return FINE;
}

int taylor_step_in(double *memory, const LinearRotor *rotor, const Holds *holds, double *scratch, TaylorStep *made,
                   Failure *failure)
{
    const Slider *sliders = holds->sliders;
    const int count = holds->slider_count;
    const int n = rotor->stations, p = rotor->plane_count, isotropic = linear_rotor_isotropic(rotor);
    const size_t m = (size_t)count, half = 2 * (size_t)n, terms = TERMS + 1;
    const size_t length = (size_t)doubles_of_row(n, p);
    int i, j, code;
    made->sliders = sliders;
    made->count = count;
    made->parts = isotropic ? 2 : 1;
    made->dof = isotropic ? n : 2 * n;
    made->half = 2 * n;
    made->length = (int)length;
    made->plane_count = p;
    made->planes = rotor->planes;
    made->gravity[0] = rotor->gravity[0];
    made->gravity[1] = rotor->gravity[1];
    made->still = next_block(&memory, half * length);
    made->per_speed = next_block(&memory, half * length);
    made->matrix = next_block(&memory, half * length);
    made->push = next_block(&memory, half * m);
    made->series = next_block(&memory, terms * length);
    made->forces = next_block(&memory, terms * m);
    made->turn = next_block(&memory, terms * 2);
    made->rate = next_block(&memory, half);
    made->faster = next_block(&memory, (DERIVATIVES + 1) * half);
    made->mobility = next_block(&memory, m * m);
    made->hold = next_block(&memory, 2 * m);
    made->slider_states = next_block(&memory, holds_doubles(holds));
    made->limits = next_block(&memory, m);
    made->holds = *holds;
    made->answers = next_block(&memory, half * (size_t)(holds->cubic_count + holds->stop_count));
    made->restraint_data = memory;
    for (i = 0; i < count; i++) {
        for (j = 0; j < i; j++) {
            if (slider_is_rigid(sliders + i) && slider_is_rigid(sliders + j) &&
                slider_place(sliders + i) == slider_place(sliders + j)) {
                return fail(failure, "sliders: two rigid ones at one support and axis are one "
                            "with the sum of their limits; give that, or a stiffness");
            }
        }
    }
    code = split_rows(rotor, made, scratch, failure);
    if (!code && count) {
        code = set_push(rotor, made, scratch, failure);
    }
    if (!code) {
        code = set_answers(rotor, made, scratch, failure);
    }
    if (!code) {
        set_norms(made);
    }
    return code;
}
