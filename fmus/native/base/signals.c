#include "base/signals.h"

#include "base/cubic.h"
#include "base/quintic.h"

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

void signal_hermite(Complex start, Complex start_slope, Complex end, Complex end_slope,
                    double step, Complex *cubic)
{
    cubic[0] = start;
    cubic[1] = start_slope;
    hermite(start.re, start_slope.re, end.re, end_slope.re, step, &cubic[2].re, &cubic[3].re);
    hermite(start.im, start_slope.im, end.im, end_slope.im, step, &cubic[2].im, &cubic[3].im);
}

void signal_quintic_hermite(const Complex *start, const Complex *end, double step,
                            Complex *quintic)
{
    int k;
    for (k = 0; k < 3; k++) {
        quintic[k] = start[k];
    }
    quintic_hermite(&start->re, &end->re, 2, step, &quintic[3].re);
    quintic_hermite(&start->im, &end->im, 2, step, &quintic[3].im);
}
