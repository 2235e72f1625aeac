/* Quintics over a step, told by value and derivatives 1 to 5 at its start; twin of
   models/quintic.py. */
#ifndef AUTOBALANCER_QUINTIC_H
#define AUTOBALANCER_QUINTIC_H

#include "complex_number.h"

/* Derivatives 3 to 5 at the start of the quintic with these values, slopes and second derivatives. */
static inline void quintic_hermite(const double *start, const double *end, double step,
                                   double *higher)
{
    const double per_step = 1.0 / step, square = per_step * per_step;
    /* by how much value, slope and second derivative of the end miss the parabola of the start */
    const double value = 60.0 * (((end[0] - start[0]) * per_step - start[1]) * per_step - 0.5 * start[2]);
    const double slope = 24.0 * ((end[1] - start[1]) * per_step - start[2]);
    const double second = 3.0 * (end[2] - start[2]);
    higher[0] = (value - slope + second) * per_step;
    higher[1] = (7.0 * slope - 6.0 * value - 8.0 * second) * square;
    higher[2] = (12.0 * value - 15.0 * slope + 20.0 * second) * (square * per_step);
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
