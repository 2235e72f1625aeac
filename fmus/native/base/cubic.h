/* Signals over a step: cubics, given by the value and the derivatives 1 to 3 at its start. */
#ifndef AUTOBALANCER_CUBIC_H
#define AUTOBALANCER_CUBIC_H

#include "base/complex_number.h"

enum { SIGNAL_ORDERS = 4 };

/* Second and third derivative at the start of the cubic with these values and slopes. */
static inline void hermite(double start, double slope, double end, double end_slope, double step,
                           double *second, double *third)
{
    const double per_step = 1.0 / step, rise = (end - start) * per_step;
    *second = (6.0 * rise - 4.0 * slope - 2.0 * end_slope) * per_step;
    *third = (6.0 * (slope + end_slope) - 12.0 * rise) * (per_step * per_step);
}

/* Value and slope of a complex cubic `time` after its start. */
static inline void cubic_at(const Complex *cubic, double time, Complex *derivatives)
{
    const Complex bend = complex_sum(cubic[2], complex_scaled(0.5 * time, cubic[3]));
    Complex sum = complex_sum(cubic[2], complex_scaled(time / 3.0, cubic[3]));
    sum = complex_sum(cubic[1], complex_scaled(0.5 * time, sum));
    derivatives[0] = complex_sum(cubic[0], complex_scaled(time, sum));
    derivatives[1] = complex_sum(cubic[1], complex_scaled(time, bend));
}

/* The complex cubic over a step with this value and slope at each end. */
static inline void cubic_between(const Complex *start, const Complex *end, double step,
                                 Complex *cubic)
{
    cubic[0] = start[0];
    cubic[1] = start[1];
    hermite(start[0].re, start[1].re, end[0].re, end[1].re, step, &cubic[2].re, &cubic[3].re);
    hermite(start[0].im, start[1].im, end[0].im, end[1].im, step, &cubic[2].im, &cubic[3].im);
}

#endif
