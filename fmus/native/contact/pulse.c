#include "contact/pulse.h"

#include "base/elementary.h"

#define POINTS 5

/* Gauss-Legendre on 0..1, exact to degree 9 */
static const double PULSE_NODES[POINTS] = {0.046910077030668, 0.230765344947158, 0.5, 0.769234655052842,
                                     0.953089922969332};
static const double SHARES[POINTS] = {0.118463442528095, 0.239314335249683, 0.284444444444444,
                                      0.239314335249683, 0.118463442528095};

Complex hat_half(double turn)
{
    Complex sum = {0.0, 0.0};
    int k;
    for (k = 0; k < POINTS; k++) {
        const double s = PULSE_NODES[k], height = SHARES[k] * s * s * (3.0 - 2.0 * s);
        sum = complex_sum(sum, complex_scaled(height, rect(1.0, turn * (s - 1.0))));
    }
    return sum;
}

Complex pulse_ahead(Complex pulse, double turn, double step, Complex *owed)
{
    Complex half, left, given;
    double both_halves;
    if (owed->re == 0.0 && owed->im == 0.0 && pulse.re == 0.0 && pulse.im == 0.0) {
        return pulse;
    }
    half = hat_half(turn);
    left = complex_product(complex_scaled(step, pulse), complex_conjugate(half));
    left = complex_product(complex_difference(*owed, left), rect(1.0, -turn));
    both_halves = 2.0 * step * half.re;
    given = complex_of(left.re / both_halves, left.im / both_halves);
    if (magnitude(left) < 1e-14 * magnitude(*owed)) { /* equal steps leave rounding only */
        left = given = complex_of(0.0, 0.0);
    }
    *owed = complex_difference(left, complex_product(complex_scaled(step, given), half));
    return given;
}
