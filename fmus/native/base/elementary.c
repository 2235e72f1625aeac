/* Elementary functions from + - * / and sqrt alone.

   Every product and sum stands as it is rounded: nothing here may be contracted or reordered. */
#include "base/elementary.h"

#include <stdint.h>

#include "base/direction.h"

#define WHOLE 4503599627370496.0   /* 2^52: from here on every number is whole */
#define SPLITTER 134217729.0       /* 2^27 + 1 */

/* pi/2 in parts of 53 bits */
static const double HALF_PI[4] = {1.5707963267948966, 6.123233995736766e-17,
                                  -1.4973849048591698e-33, 5.562271104316826e-50};
/* ln 2: 32 bits and the rest */
static const double LN2_1 = 0.6931471803691238, LN2_2 = 1.9082149292705877e-10;
static const double ONE_OVER_LN2 = 1.4426950408889634;

typedef union {
    double number;
    uint64_t bits;
} Bits;

double nearest(double x)
{
    if (!(absolute(x) < WHOLE)) {
        return x;
    }
    return copy_sign((absolute(x) + WHOLE) - WHOLE, x);
}

int binary_exponent(double x)
{
    Bits b;
    int field, below = 0;
    if (x == 0.0 || !is_finite(x)) {
        return 0;
    }
    b.number = x;
    field = (int)(b.bits >> 52 & 0x7FF);
    if (field == 0) { /* subnormal */
        b.number = x * WHOLE;
        field = (int)(b.bits >> 52 & 0x7FF);
        below = 52;
    }
    return field - 1022 - below;
}

static double power_of_two(int exponent)
{
    Bits b;
    b.bits = (uint64_t)(exponent + 1023) << 52;
    return b.number;
}

double scaled_by_power(double x, int exponent)
{
    while (exponent > 1023 && x != 0.0 && is_finite(x)) {
        x *= power_of_two(1023);
        exponent -= 1023;
    }
    /* steps that leave the last one 53 bits: only it may round */
    while (exponent < -1022 && x != 0.0 && is_finite(x)) {
        x *= power_of_two(-969);
        exponent += 969;
    }
    if (exponent > 1023 || exponent < -1022) {
        return x;
    }
    return x * power_of_two(exponent);
}

/* a b exactly, as rounded product and error (Dekker). */
static double two_product(double a, double b, double *error)
{
    const double product = a * b;
    const double a_wide = SPLITTER * a, b_wide = SPLITTER * b;
    const double a_high = a_wide - (a_wide - a), b_high = b_wide - (b_wide - b);
    const double a_low = a - a_high, b_low = b - b_high;
    *error = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
    return product;
}

/* Add a term to a sum kept exactly in `count` parts, smallest first (Shewchuk). */
static void add_exactly(double *parts, int *count, double term)
{
    int k;
    for (k = 0; k < *count; k++) {
        term = two_sum(term, parts[k], &parts[k]);
    }
    parts[(*count)++] = term;
}

double sum_of(const double *values, int count)
{
    double sum = 0.0;
    int k;
    for (k = 0; k < count; k++) {
        sum += values[k];
    }
    return sum;
}

/* The angle less quarter turns, as high + low, when the short way has not enough digits. */
static int reduced_exactly(double x, double *high, double *low)
{
    double parts[20], error;
    int count = 0, quarters = 0, round, k;
    add_exactly(parts, &count, x);
    /* two rounds: the first number of quarters may be wrong by one or two for large x */
    for (round = 0; round < 2; round++) {
        const double n = nearest(sum_of(parts, count) * TWO_OVER_PI);
        for (k = 0; k < 4; k++) {
            const double product = two_product(n, HALF_PI[k], &error);
            add_exactly(parts, &count, -product);
            add_exactly(parts, &count, -error);
        }
        quarters += (int)modulo(n, 4.0);
    }
    *high = sum_of(parts, count);
    add_exactly(parts, &count, -*high);
    *low = sum_of(parts, count);
    return quarters & 3;
}

/* The angle x = high + low + quarters pi/2, |high| <= pi/4; returns quarters modulo 4. */
static int reduced(double x, double *high, double *low)
{
    const double n = angle_reduced(x, high, low);
    if (angle_is_reduced(x, n, *high)) {
        return (int)n & 3;
    }
    if (absolute(x) > WHOLE) {
        x = ieee_remainder(x, TAU);
    }
    return reduced_exactly(x, high, low);
}

Complex rect(double size, double angle)
{
    double high, low;
    Complex turned;
    int quarters;
    if (!is_finite(angle)) {
        return complex_of(not_a_number(), not_a_number());
    }
    quarters = reduced(angle, &high, &low);
    turned = turned_by_quarters(quarters, cosine_near_zero(high, low), sine_near_zero(high, low));
    return complex_scaled(size, turned);
}

Complex turned_by(Turned *cache, double angle)
{
    if (!cache) {
        return rect(1.0, angle);
    }
    if (cache[0].angle != angle) {
        const Turned last = cache[0];
        cache[0] = cache[1];
        cache[1] = last;
        if (cache[0].angle != angle) {
            cache[0].angle = angle;
            cache[0].turn = rect(1.0, angle);
        }
    }
    return cache[0].turn;
}

double sine(double x)
{
    return rect(1.0, x).im;
}

double cosine(double x)
{
    return rect(1.0, x).re;
}

double natural_exp(double x)
{
    /* 1/k! from k = 13 down to 2: the first term left out is below 1e-17 of the sum */
    static const double terms[12] = {1.0 / 6227020800.0, 1.0 / 479001600.0, 1.0 / 39916800.0,
                                     1.0 / 3628800.0,    1.0 / 362880.0,    1.0 / 40320.0,
                                     1.0 / 5040.0,       1.0 / 720.0,       1.0 / 120.0,
                                     1.0 / 24.0,         1.0 / 6.0,         1.0 / 2.0};
    double n, coarse, fine, r, low, tail = 0.0, main;
    int k;
    if (x != x) {
        return x;
    }
    if (x > 710.0) {
        return infinity();
    }
    if (x < -746.0) {
        return 0.0;
    }
    n = nearest(x * ONE_OVER_LN2);
    coarse = x - n * LN2_1;
    fine = n * LN2_2;
    r = coarse - fine;
    low = (coarse - r) - fine;
    for (k = 0; k < 12; k++) {
        tail = terms[k] + r * tail;
    }
    main = 1.0 + r;
    return scaled_by_power(main + (((1.0 - main) + r) + (low + r * r * tail)), (int)n);
}

/* arcsin x - x for |x| <= 1/2: term k + 1 over term k is x^2 (2k+1)^2/((2k+2)(2k+3)). */
static double arc_sine_excess(double x)
{
    double term = x, sum = 0.0;
    int k;
    for (k = 0; k < 28; k++) {
        const double odd = 2.0 * k + 1.0;
        term *= x * x * odd * odd / ((odd + 1.0) * (odd + 2.0));
        sum += term;
    }
    return sum;
}

double arc_sine(double x)
{
    const double size = absolute(x);
    double rest, root, square, error, slope, main, excess;
    if (!(size <= 1.0)) {
        return not_a_number();
    }
    if (size <= 0.5) {
        return x + arc_sine_excess(x);
    }
    if (size == 1.0) {
        return copy_sign(HALF_PI[0], x);
    }
    /* arcsin x = pi/2 - 2 arcsin sqrt((1 - x)/2), with the main part's roundings taken along */
    rest = 0.5 * (1.0 - size);
    root = square_root(rest);
    square = two_product(root, root, &error);
    slope = 1.0 / square_root(1.0 - rest);
    excess = 2.0 * (arc_sine_excess(root) + slope * ((rest - square) - error) / (2.0 * root));
    main = two_sum(HALF_PI[0], -2.0 * root, &error);
    return copy_sign(main + (error + HALF_PI[1] - excess), x);
}

/* The same for numbers whose squares neither overflow nor vanish, large >= small > 0. */
static double hypotenuse_within(double large, double small)
{
    double large_error, small_error, root_error, rest;
    const double root = square_root(large * large + small * small);
    /* one Newton step with exact products takes out the roundings of the squares and their sum */
    rest = two_product(large, large, &large_error) - two_product(root, root, &root_error);
    rest += two_product(small, small, &small_error);
    rest += (large_error - root_error) + small_error;
    return root + rest / (2.0 * root);
}

double hypotenuse(double x, double y)
{
    double large, small;
    int shift;
    x = absolute(x);
    y = absolute(y);
    if (x == infinity() || y == infinity()) {
        return infinity();
    }
    large = larger(x, y);
    small = smaller(x, y);
    if (small == 0.0 || large != large || small != small) {
        return large + small;
    }
    if (large <= 1e150 && small >= 1e-120) {
        return hypotenuse_within(large, small);
    }
    shift = binary_exponent(large);
    large = scaled_by_power(large, -shift);
    small = scaled_by_power(small, -shift);
    return scaled_by_power(hypotenuse_within(large, small), shift);
}

double magnitude(Complex z)
{
    const double square = z.re * z.re + z.im * z.im;
    return square > 1e-200 && square < 1e300 ? square_root(square) : hypotenuse(z.re, z.im);
}

/* |x| less a whole multiple of y, in 0..y: y doubled is taken off as often as it goes. */
static double remaining(double x, double y)
{
    double rest = absolute(x);
    if (!is_finite(x) || !(y > 0.0)) {
        return not_a_number();
    }
    while (rest >= y) {
        const int doublings = binary_exponent(rest) - binary_exponent(y);
        double multiple = scaled_by_power(y, doublings);
        if (multiple > rest) {
            multiple = scaled_by_power(y, doublings - 1);
        }
        rest -= multiple; /* exact: they are within a factor of two */
    }
    return rest;
}

double modulo(double x, double y)
{
    const double rest = remaining(x, y);
    return x < 0.0 && rest != 0.0 ? y - rest : rest;
}

double ieee_remainder(double x, double y)
{
    double rest = remaining(x, 2.0 * y); /* keeps whether the multiple is even */
    if (rest + rest > y) {
        rest -= y;
        if (rest + rest >= y) {
            rest -= y;
        }
    }
    return x < 0.0 ? -rest : rest;
}
