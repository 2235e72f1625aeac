/* Quintics over a step, told by value and derivatives 1 to 5 at its start; twin of
   models/quintic.py. */
#ifndef AUTOBALANCER_QUINTIC_H
#define AUTOBALANCER_QUINTIC_H

#include "complex_number.h"

/* Derivatives 3 to 5 at the start of the quintic with these values, slopes and second derivatives. */
static inline void quintic_hermite(const double *start, const double *end, double step,
                                   double *higher)
{
    /* by how much the parabola of the start misses the end, all in the unit of the value */
    const double value = end[0] - start[0] - step * (start[1] + 0.5 * step * start[2]);
    const double slope = step * (end[1] - start[1] - step * start[2]);
    const double second = step * step * (end[2] - start[2]);
    const double cube = step * step * step;
    higher[0] = (60.0 * value - 24.0 * slope + 3.0 * second) / cube;
    higher[1] = (-360.0 * value + 168.0 * slope - 24.0 * second) / (cube * step);
    higher[2] = (720.0 * value - 360.0 * slope + 60.0 * second) / (cube * step * step);
}

/* f[0] + t (f[1] + t/2 (f[2] + ... )) of `count` derivatives. */
static inline Complex quintic_sum(const Complex *f, int count, double time)
{
    Complex sum = f[count - 1];
    int k;
    for (k = count - 2; k >= 0; k--) {
        sum = complex_sum(f[k], complex_scaled(time / (k + 1), sum));
    }
    return sum;
}

/* Value, slope and second derivative of a complex quintic `time` after its start. */
static inline void quintic_at(const Complex *quintic, double time, Complex *derivatives)
{
    int k;
    for (k = 0; k < 3; k++) {
        derivatives[k] = quintic_sum(quintic + k, 6 - k, time);
    }
}

#endif
