#include "base/quintic.h"

void quintic_hermite(const double *start, const double *end, int stride, double step,
                     double *higher)
{
    const int one = stride, two = 2 * stride;
    const double per_step = 1.0 / step, square = per_step * per_step;
    /* by how much value, slope and second derivative of the end miss the parabola of the start */
    const double value = 60.0 * (((end[0] - start[0]) * per_step - start[one]) * per_step - 0.5 * start[two]);
    const double slope = 24.0 * ((end[one] - start[one]) * per_step - start[two]);
    const double second = 3.0 * (end[two] - start[two]);
    higher[0] = (value - slope + second) * per_step;
    higher[one] = (7.0 * slope - 6.0 * value - 8.0 * second) * square;
    higher[two] = (12.0 * value - 15.0 * slope + 20.0 * second) * (square * per_step);
}

/* a + factor b. */
static Complex quintic_term(Complex a, double factor, Complex b)
{
    return complex_of(a.re + factor * b.re, a.im + factor * b.im);
}

/* f[0] + t (f[1] + t/2 (f[2] + ... )) of a complex quintic's derivatives `time` after its start. */
static Complex quintic_value(const Complex *f, double time)
{
    Complex sum = quintic_term(f[4], 0.2 * time, f[5]);
    sum = quintic_term(f[3], 0.25 * time, sum);
    sum = quintic_term(f[2], time / 3.0, sum);
    sum = quintic_term(f[1], 0.5 * time, sum);
    return quintic_term(f[0], time, sum);
}

void quintic_at(const Complex *quintic, double time, Complex *derivatives)
{
    const double half = 0.5 * time, third = time / 3.0;
    const Complex *f = quintic + 1;
    Complex sum = quintic_term(f[2], third, quintic_term(f[3], 0.25 * time, f[4]));
    derivatives[0] = quintic_value(quintic, time);
    derivatives[1] = quintic_term(f[0], time, quintic_term(f[1], half, sum));
    sum = quintic_term(f[2], half, quintic_term(f[3], third, f[4]));
    derivatives[2] = quintic_term(f[1], time, sum);
}
