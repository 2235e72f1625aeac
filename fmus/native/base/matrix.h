/* Small dense matrices, row by row.

   `parts` is 1 for real and 2 for complex elements (pairs); sizes count elements, not doubles.
   An isotropic rotor computes with complex numbers, any other with real ones over both axes. */
#ifndef AUTOBALANCER_MATRIX_H
#define AUTOBALANCER_MATRIX_H

#include <stddef.h>

/* Number by number: what has just been written one by one is not there yet for memcpy's wide reads. */
void copy_doubles(size_t count, const double *from, double *to);
void fill_doubles(size_t count, double value, double *to);

/* `to` becomes to + factor from; `factor` is one element, `from` and `to` have `count`. */
void add_multiple(int parts, int count, const double *factor, const double *from, double *to);

/* `to` becomes to + sum of factors[k] times row k of `from`, for `terms` rows that stand `stride`
   doubles apart; term by term, so that the order of rounding does not depend on how it is done. */
void add_multiples(int parts, int count, int terms, const double *factors, const double *from,
                   size_t stride, double *to);

/* result (rows, columns) = a (rows, inner) b (inner, columns); result apart from a and b. */
void matrix_product(int parts, int rows, int inner, int columns, const double *a, const double *b,
                    double *result);

/* b (n, columns) becomes a^-1 b for a (n, n), which is overwritten; LU with row pivoting.
   Returns 0, or 1 when a is singular. */
int matrix_solve(int parts, int n, int columns, double *a, double *b);

/* result (axes m, axes n) = a real matrix a (m, n) kron the unit matrix of `axes` (1 or 2); its
   elements have `parts` parts. */
void matrix_per_axis(int parts, int axes, int m, int n, const double *a, double *result);

/* result (n, m) = a (m, n) transposed. */
void matrix_transposed(int parts, int m, int n, const double *a, double *result);

/* Largest absolute value of `count` >= 1. */
double largest_of(int count, const double *values);

#endif
