#include "base/polynomial_fall.h"

#include "base/elementary.h"

enum { MOST_ADVANCES = 200, MOST_HALVINGS_OF_ADVANCE = 40 };
#define POLYNOMIAL_ROUNDING 4e-16 /* of the interval, and of the terms of the polynomial */

/* Sum of the negative coefficients from `first` on, each times b to the power beyond. */
static double fall_of(const double *c, int first, int order, double b)
{
    double sum = 0.0, power = 1.0;
    int k;
    for (k = first; k <= order; k++, power *= b) {
        sum += power * smaller(0.0, c[k]);
    }
    return sum;
}

/* Where c + d u + e u^2, not below 0 at 0, falls below 0; infinite where it does not. */
static double fall_of_parabola(double c, double d, double e)
{
    const double inside = d * d - 4.0 * c * e;
    if (c == 0.0) {
        return d < 0.0 || (d == 0.0 && e < 0.0) ? 0.0 : e < 0.0 ? -d / e : infinity();
    }
    if (!(inside >= 0.0) || (d >= 0.0 && e >= 0.0)) {
        return infinity();
    }
    return d < 0.0 ? 2.0 * c / (square_root(inside) - d) : -(d + square_root(inside)) / (2.0 * e);
}

/* How far the polynomial is not below 0 at least, of [0, 1]. */
static double safe_advance(const double *c, int order)
{
    double b = 1.0, best = 0.0;
    int k;
    for (k = 0; k < MOST_HALVINGS_OF_ADVANCE; k++, b *= 0.5) {
        const double curved = order < 2 ? 0.0 : c[2] + (order < 3 ? 0.0 : b * fall_of(c, 3, order, b));
        const double root = fall_of_parabola(larger(0.0, c[0]), order < 1 ? 0.0 : c[1], curved);
        best = larger(best, smaller(root, b));
        if (root >= 0.5 * b || best >= 0.5 * b) {
            break;
        }
    }
    return best;
}

/* The polynomial about a point u of [0, 1], and with what is left as the unit. */
static void shift_polynomial(double *c, int order, double u)
{
    const double left = 1.0 - u;
    double power = 1.0;
    int j, k;
    for (j = 0; j < order; j++) {
        for (k = order - 1; k >= j; k--) {
            c[k] += u * c[k + 1];
        }
    }
    for (k = 0; k <= order; k++, power *= left) {
        c[k] *= power;
    }
}

double find_polynomial_fall(double *c, int order, double until)
{
    double power = 1.0, done = 0.0, size = 0.0;
    int k;
    for (k = 0; k <= order; k++, power *= until) {
        c[k] *= power;
        size += absolute(c[k]);
    }
    if (c[0] > 0.0 && c[0] + fall_of(c, 1, order, 1.0) > 0.0) {
        return -1.0;
    }
    for (k = 0; k < MOST_ADVANCES; k++) {
        const double advance = safe_advance(c, order), before = 1.0 - done;
        if (advance >= 1.0) {
            return -1.0;
        }
        if (advance * before <= POLYNOMIAL_ROUNDING ||
            (k > 0 && c[0] <= POLYNOMIAL_ROUNDING * size && c[1] < 0.0)) {
            return done * until;
        }
        shift_polynomial(c, order, advance);
        done += advance * before;
    }
    return done * until;
}
