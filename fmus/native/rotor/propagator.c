#include "rotor/propagator.h"

#include "base/elementary.h"
#include "base/matrix.h"
#include "constants.h"

/* Largest sum of a column's absolute values. */
static double column_norm(int parts, int size, const double *matrix)
{
    double norm = 0.0;
    int i, j;
    for (j = 0; j < size; j++) {
        double sum = 0.0;
        for (i = 0; i < size; i++) {
            const double *x = matrix + ((size_t)i * size + j) * parts;
            sum += parts == 1 ? absolute(x[0]) : hypotenuse(x[0], x[1]);
        }
        if (!(sum <= norm)) { /* keeps NaN */
            norm = sum;
        }
    }
    return norm;
}

/* result = a b in the first `rows` rows, all of them with zeros where rows from `upper` on meet columns
   before it. */
static void upper_product(int parts, int size, int upper, int rows, const double *a,
                          const double *b, double *result)
{
    const size_t width = (size_t)size * parts, corner = upper * width + (size_t)upper * parts;
    int i;
    fill_doubles(width * rows, 0.0, result);
    for (i = 0; i < rows; i++) {
        const double *factors = a + i * width;
        if (i < upper) {
            add_multiples(parts, size, upper, factors, b, width, result + i * width);
        }
        add_multiples(parts, size - upper, size - upper, factors + (size_t)upper * parts,
                      b + corner, width, result + i * width + (size_t)upper * parts);
    }
}

/* result = a b/divisor for a matrix a whose elements are mostly zero; blocks as above. */
static void sparse_product(int parts, int size, int upper, const double *a, const double *b,
                           double divisor, double *result)
{
    const size_t width = (size_t)size * parts;
    double factor[2] = {0.0, 0.0};
    int i, k;
    fill_doubles(width * size, 0.0, result);
    for (i = 0; i < size; i++) {
        const int from = i < upper ? 0 : upper;
        for (k = from; k < size; k++) {
            const double *element = a + i * width + (size_t)k * parts;
            if (element[0] != 0.0 || element[parts - 1] != 0.0) {
                factor[0] = element[0] / divisor;
                factor[1] = element[parts - 1] / divisor;
                add_multiple(parts, size - from, factor, b + k * width + (size_t)from * parts,
                             result + i * width + (size_t)from * parts);
            }
        }
    }
}

/* e^A - 1 = A (1 + A/2 (1 + A/3 (1 + ...))) of a small A, into `to`; `from` is scratch of that size. */
static void sum_series(int parts, int size, int upper, const double *a, double *from, double *to)
{
    const size_t count = (size_t)size * size * parts;
    int k;
    size_t i;
    for (i = 0; i < count; i++) {
        from[i] = a[i] / TAYLOR_TERMS;
    }
    for (k = TAYLOR_TERMS - 1; k; k--) { /* an odd number of products: the last one ends in `to` */
        double *const spare = from;
        for (i = 0; i < (size_t)size; i++) {
            from[(i * size + i) * parts] += 1.0;
        }
        sparse_product(parts, size, upper, a, from, k, to);
        from = to;
        to = spare;
    }
}

int exponential(int parts, int size, int upper, double *matrix, double *scratch, Failure *failure)
{
    const size_t count = (size_t)size * size * parts;
    double *scaled = scratch, *product = scaled + count;
    const double norm = column_norm(parts, size, matrix);
    double part;
    int doublings, j;
    size_t i;
    if (!is_finite(norm)) {
        return fail(failure, "the rotor's matrices are not finite");
    }
    doublings = binary_exponent(norm) + 1;
    doublings = doublings > 0 ? doublings : 0;
    part = scaled_by_power(1.0, -doublings);
    for (i = 0; i < count; i++) {
        scaled[i] = part * matrix[i];
    }
    sum_series(parts, size, upper, scaled, product, matrix);
    /* E -> 2 E + E^2 instead of squaring e^A keeps slow modes exact next to fast ones */
    for (j = 1; j <= doublings; j++) {
        const int rows = j < doublings ? size : upper;
        upper_product(parts, size, upper, rows, matrix, matrix, product);
        for (i = 0; i < (size_t)(rows * size * parts); i++) {
            matrix[i] = 2.0 * matrix[i] + product[i];
        }
    }
    for (i = 0; i < (size_t)upper; i++) {
        matrix[(i * size + i) * parts] += 1.0;
    }
    return FINE;
}

int step_matrix_rows(int stations, int planes, int axes)
{
    return 2 * axes * (stations + planes);
}

int step_matrix_columns(int stations, int planes, int axes)
{
    return axes * (2 * stations + SIGNAL_ORDERS * planes + 1);
}

size_t step_matrix_scratch(int stations, int planes, int axes)
{
    const size_t size = (size_t)step_matrix_columns(stations, planes, axes);
    const size_t parts = axes == 1 ? 2 : 1;
    return 4 * parts * size * size; /* Z, its exponential, and what that needs */
}

/* Turning e^{i w t} of `count` vectors, at rows and columns from `first` on: f' = i w f. */
static void set_turning(int parts, int size, int first, int count, double speed, double *z)
{
    int k;
    for (k = 0; k < count; k++) {
        if (parts == 2) {
            const size_t x = first + k;
            z[(x * size + x) * 2 + 1] = speed;
        } else {
            const size_t x = first + 2 * k, y = x + 1;
            z[x * size + y] = -speed;
            z[y * size + x] = speed;
        }
    }
}

/* Matrix Z (columns, columns) of the autonomous system (q, v, f_0.., e)' = Z (q, v, f_0.., e). */
static int set_generator(const LinearRotor *rotor, double speed, bool turning_force, double *z,
                         double *scratch, Failure *failure)
{
    const int axes = linear_rotor_isotropic(rotor) ? 1 : 2, parts = 3 - axes;
    const int p = rotor->plane_count, dof = axes * rotor->stations, forces = axes * p;
    const int size = step_matrix_columns(rotor->stations, p, axes), e = size - axes;
    const size_t width = (size_t)(2 * dof + forces + axes) * parts;
    double *rows = scratch, *work = rows + dof * width;
    int i, k;
    const int code = linear_rotor_rows(rotor, speed, rows, work, failure);
    if (code) {
        return code;
    }
    fill_doubles((size_t)size * size * parts, 0.0, z);
    for (i = 0; i < dof; i++, rows += width) {
        double *row = z + (size_t)(dof + i) * size * parts;
        z[((size_t)i * size + dof + i) * parts] = 1.0;
        copy_doubles((size_t)(2 * dof + forces) * parts, rows, row);
        copy_doubles((size_t)axes * parts, rows + (2 * dof + forces) * parts, row + e * parts);
    }
    for (k = 0; k < SIGNAL_ORDERS; k++) {
        const int first = 2 * dof + k * forces;
        if (turning_force) {
            set_turning(parts, size, first, p, speed, z);
        }
        for (i = first; i < first + forces && k + 1 < SIGNAL_ORDERS; i++) {
            z[((size_t)i * size + i + forces) * parts] = 1.0;
        }
    }
    set_turning(parts, size, e, 1, speed, z);
    return FINE;
}

int step_matrix(const LinearRotor *rotor, double speed, double step, bool turning_force,
                double *matrix, double *scratch, Failure *failure)
{
    const int axes = linear_rotor_isotropic(rotor) ? 1 : 2, parts = 3 - axes;
    const int n = rotor->stations, p = rotor->plane_count, dof = axes * n, forces = axes * p;
    const int size = step_matrix_columns(n, p, axes);
    const size_t count = (size_t)size * size * parts, width = (size_t)size * parts;
    double *z = scratch, *propagated = z + count, *work = propagated + count;
    double *accelerations = work, *jerks = work + dof * width, *planes = jerks + dof * width;
    double *of_planes = matrix + 2 * (size_t)dof * width;
    size_t i;
    int code = set_generator(rotor, speed, turning_force, z, work, failure);
    if (code) {
        return code;
    }
    for (i = 0; i < count; i++) {
        propagated[i] = z[i] * step;
    }
    code = exponential(parts, size, 2 * dof, propagated, work, failure);
    if (code) {
        return code;
    }
    copy_doubles(2 * dof * width, propagated, matrix);
    /* e^{Zt} Z, not Z e^{Zt}: a stiff support would lose the small difference of k q and F */
    matrix_product(parts, dof, size, size, propagated + dof * width, z, accelerations);
    matrix_product(parts, dof, size, size, accelerations, z, jerks);
    matrix_per_axis(parts, axes, p, n, rotor->planes, planes);
    matrix_product(parts, forces, dof, size, planes, accelerations, of_planes);
    matrix_product(parts, forces, dof, size, planes, jerks, of_planes + (size_t)forces * width);
    return FINE;
}
