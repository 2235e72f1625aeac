#include "base/signals.h"

#include "base/cubic.h"
#include "base/quintic.h"

void signal_at(const Complex *signal, int orders, double t, Complex *derivatives)
{
    if (orders == QUINTIC_ORDERS) {
        quintic_at(signal, t, derivatives);
    } else {
        derivatives[0] = cubic_value(signal, t);
        derivatives[1] = cubic_slope(signal, t);
    }
}

void signal_hermite(const Complex *start, const Complex *end, int orders, double step,
                    Complex *signal)
{
    const int half = orders / 2;
    Complex *higher = signal + half;
    int k;
    if (orders == QUINTIC_ORDERS) {
        quintic_hermite(&start->re, &end->re, 2, step, &higher->re);
        quintic_hermite(&start->im, &end->im, 2, step, &higher->im);
    } else {
        hermite(start[0].re, start[1].re, end[0].re, end[1].re, step, &higher[0].re, &higher[1].re);
        hermite(start[0].im, start[1].im, end[0].im, end[1].im, step, &higher[0].im, &higher[1].im);
    }
    for (k = 0; k < half; k++) {
        signal[k] = start[k];
    }
}

void hermite_rates(const double *start, const double *end, int orders, double step, double *higher)
{
    if (orders == QUINTIC_ORDERS) {
        quintic_hermite(start, end, 1, step, higher);
    } else {
        hermite(start[0], start[1], end[0], end[1], step, higher, higher + 1);
    }
}
