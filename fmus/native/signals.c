#include "signals.h"

#include "cubic.h"

void signal_orders(const double *signal, Complex *cubic)
{
    int k;
    for (k = 0; k < SIGNAL_ORDERS; k++) {
        cubic[k] = complex_of(signal[2 * k], signal[2 * k + 1]);
    }
}

void signal_at(const Complex *cubic, double t, Complex *value, Complex *slope)
{
    *value = cubic_value(cubic, t);
    *slope = cubic_slope(cubic, t);
}

static Complex quotient(Complex a, double by)
{
    return complex_of(a.re / by, a.im / by);
}

void signal_hermite(Complex start, Complex start_slope, Complex end, Complex end_slope,
                    double step, Complex *cubic)
{
    const Complex rise = quotient(complex_difference(end, start), step);
    Complex second = complex_scaled(6.0, rise);
    Complex third = complex_scaled(6.0, complex_sum(start_slope, end_slope));
    second = complex_difference(second, complex_scaled(4.0, start_slope));
    second = complex_difference(second, complex_scaled(2.0, end_slope));
    third = complex_difference(third, complex_scaled(12.0, rise));
    cubic[0] = start;
    cubic[1] = start_slope;
    cubic[2] = quotient(second, step);
    cubic[3] = quotient(third, step * step);
}
