/* Sine and cosine of an angle, or of the angles of several machines side by side. */
#ifndef AUTOBALANCER_DIRECTION_H
#define AUTOBALANCER_DIRECTION_H

#include "base/number.h"

/* pi/2 in parts of 33 bits and the rest: products with less than 2^20 quarter turns are exact */
#define QUARTER_1 1.5707963267341256
#define QUARTER_2 6.077100506303966e-11
#define QUARTER_3 2.0222662487959506e-21
#define TWO_OVER_PI 0.6366197723675814
#define ROUNDER 6755399441055744.0 /* 3 2^51: leaves whole numbers of what is added to it */
#define SMALL_ANGLE 1.0e5          /* the products of quarters are exact up to here */
#define CANCELLED 1e-17            /* less, a quarter turn, is left of an angle: too few digits */

/* a + b exactly, as rounded sum and error (Knuth). */
static inline Number two_sum(Number a, Number b, Number *error)
{
    const Number sum = a + b;
    const Number part = sum - a;
    *error = (a - (sum - part)) + (b - part);
    return sum;
}

/* The angle x = high + low + quarters pi/2, |high| <= pi/4, where angle_is_reduced; the quarters. */
static inline Number angle_reduced(Number x, Number *high, Number *low)
{
    const Number n = (x * TWO_OVER_PI + ROUNDER) - ROUNDER;
    Number error;
    const Number near = two_sum(x - n * QUARTER_1, -(n * QUARTER_2), &error);
    const Number rest = n * QUARTER_3 - error;
    *high = near - rest;
    *low = (near - *high) - rest;
    return n;
}

static inline bool angle_is_reduced(double x, double quarters, double high)
{
    return absolute(x) <= SMALL_ANGLE && (quarters == 0.0 || absolute(high) > CANCELLED * absolute(quarters));
}

/* sin(x + low) for |x| <= pi/4 by its Taylor series; the first term left out is below 1e-19.  Every
   other term is summed apart: two short chains of sums take half as long as one. */
static inline Number sine_near_zero(Number x, Number low)
{
    const Number z = x * x, zz = z * z;
    const Number odd = -1.0 / 6.0 + zz * (-1.0 / 5040.0 +
                                          zz * (-1.0 / 39916800.0 + zz * (-1.0 / 1307674368000.0)));
    const Number even = 1.0 / 120.0 + zz * (1.0 / 362880.0 +
                                            zz * (1.0 / 6227020800.0 + zz * (1.0 / 355687428096000.0)));
    const Number tail = z * x * (odd + z * even);
    return x + (tail + low * (1.0 - 0.5 * z));
}

/* cos(x + low), as above. */
static inline Number cosine_near_zero(Number x, Number low)
{
    const Number z = x * x, zz = z * z, half = 0.5 * z;
    const Number odd = 1.0 / 24.0 + zz * (1.0 / 40320.0 +
                                          zz * (1.0 / 479001600.0 + zz * (1.0 / 20922789888000.0)));
    const Number even = -1.0 / 720.0 + zz * (-1.0 / 3628800.0 +
                                             zz * (-1.0 / 87178291200.0 + zz * (-1.0 / 6402373705728000.0)));
    const Number rest = zz * (odd + z * even);
    const Number main = 1.0 - half;
    return main + (((1.0 - main) - half) + (rest - x * low));
}

/* e^{i angle} of what is left of the angle behind so many quarter turns. */
static inline Complex turned_by_quarters(int quarters, double c, double s)
{
    switch (quarters & 3) {
    case 0:
        return complex_of(c, s);
    case 1:
        return complex_of(-s, c);
    case 2:
        return complex_of(-c, -s);
    default:
        return complex_of(s, -c);
    }
}

#ifdef SIDE_BY_SIDE

static inline void number_direction(Number angle, Number *cosine, Number *sine)
{
    Number high, low;
    const Number quarters = angle_reduced(angle, &high, &low);
    const Number c = cosine_near_zero(high, low), s = sine_near_zero(high, low);
    int lane;
    if (number_all((number_size(angle) <= SMALL_ANGLE) &
                   ((quarters == 0.0) | (number_size(high) > CANCELLED * number_size(quarters))))) { /* angle_is_reduced */
        number_turned(quarters, number_of(ROUNDER), c, s, cosine, sine);
        return;
    }
    for (lane = 0; lane < LANES; lane++) {
        const Complex turned = angle_is_reduced(angle[lane], quarters[lane], high[lane])
                                   ? turned_by_quarters((int)quarters[lane], c[lane], s[lane])
                                   : rect(1.0, angle[lane]);
        (*cosine)[lane] = turned.re;
        (*sine)[lane] = turned.im;
    }
}

#else

static inline void number_direction(Number angle, Number *cosine, Number *sine)
{
    const Complex turned = rect(1.0, angle);
    *cosine = turned.re;
    *sine = turned.im;
}

#endif

#endif
