#include "signals.h"

#include "cubic.h"
#include "quintic.h"

void signal_orders(const double *signal, Complex *cubic)
{
    int k;
    for (k = 0; k < SIGNAL_ORDERS; k++) {
        cubic[k] = complex_of(signal[2 * k], signal[2 * k + 1]);
    }
}

void signal_quintic(const double *signal, Complex *quintic)
{
    int k;
    for (k = 0; k < QUINTIC_ORDERS; k++) {
        quintic[k] = complex_of(signal[2 * k], signal[2 * k + 1]);
    }
}

void signal_at(const Complex *cubic, double t, Complex *value, Complex *slope)
{
    *value = cubic_value(cubic, t);
    *slope = cubic_slope(cubic, t);
}

void signal_derivatives(const double *signal, int order, double t, Complex *derivatives)
{
    if (order == 5) {
        Complex quintic[QUINTIC_ORDERS];
        signal_quintic(signal, quintic);
        quintic_at(quintic, t, derivatives);
    } else {
        Complex cubic[SIGNAL_ORDERS];
        signal_orders(signal, cubic);
        signal_at(cubic, t, derivatives, derivatives + 1);
    }
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

void signal_quintic_hermite(const Complex *start, const Complex *end, double step,
                            Complex *quintic)
{
    double from[2][3], to[2][3], higher[2][3];
    int k;
    for (k = 0; k < 3; k++) {
        from[0][k] = start[k].re;
        from[1][k] = start[k].im;
        to[0][k] = end[k].re;
        to[1][k] = end[k].im;
        quintic[k] = start[k];
    }
    quintic_hermite(from[0], to[0], step, higher[0]);
    quintic_hermite(from[1], to[1], step, higher[1]);
    for (k = 0; k < 3; k++) {
        quintic[3 + k] = complex_of(higher[0][k], higher[1][k]);
    }
}
