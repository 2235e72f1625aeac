#include "base/matrix.h"

#include "base/elementary.h"

void copy_doubles(size_t count, const double *from, double *to)
{
    size_t k;
    for (k = 0; k < count; k++) {
        to[k] = from[k];
    }
}

void fill_doubles(size_t count, double value, double *to)
{
    size_t k;
    for (k = 0; k < count; k++) {
        to[k] = value;
    }
}

void add_multiple(int parts, int count, const double *factor, const double *from, double *to)
{
    int k;
    if (parts == 1) {
        const double a = factor[0];
        for (k = 0; k < count; k++) {
            to[k] += a * from[k];
        }
    } else {
        const double re = factor[0], im = factor[1];
        for (k = 0; k < 2 * count; k += 2) {
            const double x = from[k], y = from[k + 1];
            to[k] += re * x - im * y;
            to[k + 1] += re * y + im * x;
        }
    }
}

static bool is_zero(int parts, const double *element)
{
    return element[0] == 0.0 && (parts == 1 || element[1] == 0.0);
}

/* Four real terms at once: `to` is read and written a quarter as often. */
static void add_four(int count, const double *factors, const double *from, size_t stride,
                     double *restrict to)
{
    const double a = factors[0], b = factors[1], c = factors[2], d = factors[3];
    const double *p = from, *q = p + stride, *r = q + stride, *s = r + stride;
    int j;
    if (a == 0.0 && b == 0.0 && c == 0.0 && d == 0.0) { /* the matrices here are half empty */
        return;
    }
    for (j = 0; j < count; j++) {
        to[j] = (((to[j] + a * p[j]) + b * q[j]) + c * r[j]) + d * s[j];
    }
}

/* Two complex terms at once. */
static void add_two(int count, const double *factors, const double *from, size_t stride, double *restrict to)
{
    const double a = factors[0], b = factors[1], c = factors[2], d = factors[3];
    const double *p = from, *q = p + stride;
    int j;
    if (a == 0.0 && b == 0.0 && c == 0.0 && d == 0.0) {
        return;
    }
    for (j = 0; j < 2 * count; j += 2) {
        to[j] = (to[j] + (a * p[j] - b * p[j + 1])) + (c * q[j] - d * q[j + 1]);
        to[j + 1] = (to[j + 1] + (a * p[j + 1] + b * p[j])) + (c * q[j + 1] + d * q[j]);
    }
}

void add_multiples(int parts, int count, int terms, const double *factors, const double *from,
                   size_t stride, double *to)
{
    int k = 0;
    if (parts == 1) {
        for (; k + 4 <= terms; k += 4) {
            add_four(count, factors + k, from + k * stride, stride, to);
        }
    } else {
        for (; k + 2 <= terms; k += 2) {
            add_two(count, factors + 2 * k, from + k * stride, stride, to);
        }
    }
    for (; k < terms; k++) {
        if (!is_zero(parts, factors + k * parts)) {
            add_multiple(parts, count, factors + k * parts, from + k * stride, to);
        }
    }
}

/* result (rows,) = a (rows, inner) b (inner,), summed in the order of `add_multiples`. */
static void matrix_vector(int parts, int rows, int inner, const double *a, const double *b,
                          double *result)
{
    int i, k;
    for (i = 0; i < rows; i++, a += (size_t)inner * parts, result += parts) {
        double re = 0.0, im = 0.0;
        for (k = 0; k < inner && parts == 1; k++) {
            re += a[k] * b[k];
        }
        for (k = 0; k < 2 * inner && parts == 2; k += 2) {
            re += a[k] * b[k] - a[k + 1] * b[k + 1];
            im += a[k] * b[k + 1] + a[k + 1] * b[k];
        }
        result[0] = re;
        result[parts - 1] = parts == 1 ? re : im;
    }
}

void matrix_product(int parts, int rows, int inner, int columns, const double *a, const double *b,
                    double *result)
{
    const size_t across = (size_t)columns * parts;
    int i;
    if (columns == 1) {
        matrix_vector(parts, rows, inner, a, b, result);
        return;
    }
    fill_doubles(rows * across, 0.0, result);
    for (i = 0; i < rows; i++) {
        add_multiples(parts, columns, inner, a + (size_t)i * inner * parts, b, across,
                      result + i * across);
    }
}

/* |re| + |im|, by which a pivot is chosen. */
static double size_of(int parts, const double *element)
{
    return parts == 1 ? absolute(element[0]) : absolute(element[0]) + absolute(element[1]);
}

/* 1/element without overflow within (Smith). */
static void inverted(int parts, const double *element, double *result)
{
    if (parts == 1) {
        result[0] = 1.0 / element[0];
    } else if (absolute(element[0]) >= absolute(element[1])) {
        const double ratio = element[1] / element[0];
        const double size = element[0] + element[1] * ratio;
        result[0] = 1.0 / size;
        result[1] = -ratio / size;
    } else {
        const double ratio = element[0] / element[1];
        const double size = element[0] * ratio + element[1];
        result[0] = ratio / size;
        result[1] = -1.0 / size;
    }
}

/* `count` elements from `from` on become factor times themselves, sign + or -. */
static void scale(int parts, int count, const double *factor, double sign, double *from)
{
    int k;
    for (k = 0; k < count; k++) {
        double *x = from + k * parts;
        if (parts == 1) {
            x[0] = sign * (factor[0] * x[0]);
        } else {
            const Complex product =
                complex_product(complex_of(factor[0], factor[1]), complex_of(x[0], x[1]));
            x[0] = sign * product.re;
            x[1] = sign * product.im;
        }
    }
}

static void swap(size_t count, double *a, double *b)
{
    size_t k;
    for (k = 0; k < count; k++) {
        const double kept = a[k];
        a[k] = b[k];
        b[k] = kept;
    }
}

int matrix_solve(int parts, int n, int columns, double *a, double *b)
{
    const size_t width = (size_t)n * parts, across = (size_t)columns * parts;
    double pivot[2] = {0.0, 0.0}, factor[2] = {0.0, 0.0};
    int i, k;
    for (k = 0; k < n; k++) {
        double *row = a + k * width;
        int best = k;
        for (i = k + 1; i < n; i++) {
            if (size_of(parts, a + i * width + k * parts) >
                size_of(parts, a + best * width + k * parts)) {
                best = i;
            }
        }
        if (best != k) {
            swap(width, row, a + best * width);
            swap(across, b + k * across, b + best * across);
        }
        if (is_zero(parts, row + k * parts)) {
            return 1;
        }
        inverted(parts, row + k * parts, pivot);
        for (i = k + 1; i < n; i++) {
            double *below = a + i * width;
            if (is_zero(parts, below + k * parts)) {
                continue;
            }
            copy_doubles((size_t)parts, below + k * parts, factor);
            scale(parts, 1, pivot, -1.0, factor);
            add_multiple(parts, n - k - 1, factor, row + (k + 1) * parts, below + (k + 1) * parts);
            add_multiple(parts, columns, factor, b + k * across, b + i * across);
        }
    }
    for (k = n - 1; k >= 0; k--) {
        inverted(parts, a + k * width + k * parts, pivot);
        scale(parts, columns, pivot, 1.0, b + k * across);
        for (i = 0; i < k; i++) {
            copy_doubles((size_t)parts, a + i * width + k * parts, factor);
            factor[0] = -factor[0];
            factor[1] = parts == 2 ? -factor[1] : 0.0;
            if (!is_zero(parts, factor)) {
                add_multiple(parts, columns, factor, b + k * across, b + i * across);
            }
        }
    }
    return 0;
}

void matrix_per_axis(int parts, int axes, int m, int n, const double *a, double *result)
{
    int axis, i, j;
    fill_doubles((size_t)axes * m * axes * n * parts, 0.0, result);
    for (axis = 0; axis < axes; axis++) {
        for (i = 0; i < m; i++) {
            for (j = 0; j < n; j++) {
                const size_t at = (size_t)(axes * i + axis) * (axes * n) + (axes * j + axis);
                result[at * parts] = a[i * n + j];
            }
        }
    }
}

void matrix_transposed(int parts, int m, int n, const double *a, double *result)
{
    int i, j;
    for (i = 0; i < m; i++) {
        for (j = 0; j < n; j++) {
            copy_doubles((size_t)parts, a + (size_t)(i * n + j) * parts,
                         result + (size_t)(j * m + i) * parts);
        }
    }
}

double largest_of(int count, const double *values)
{
    double largest = absolute(values[0]);
    int k;
    for (k = 1; k < count; k++) {
        largest = larger(largest, absolute(values[k]));
    }
    return largest;
}
