#include "base/elementary.h"
#include "base/signals.h"
#include "coupling/composite.h"

void knot_from_start(const Knot *start, int orders, Complex *signal)
{
    int k;
    signal[0] = start->value;
    signal[1] = start->slope;
    signal[2] = start->second;
    for (k = 3; k < orders; k++) {
        signal[k] = complex_of(0.0, 0.0);
    }
}

void knot_held(const Knot *knot, int orders, Complex *signal)
{
    Knot flat = {knot->value, {0.0, 0.0}, {0.0, 0.0}};
    knot_from_start(&flat, orders, signal);
}

void knot_hermite(const Knot *start, const Knot *end, int orders, double step, Complex *signal)
{
    signal_hermite(&start->value, &end->value, orders, step, signal);
}

static Complex added(Complex a, double factor, Complex b)
{
    return complex_sum(a, complex_scaled(factor, b));
}

void knot_leading(const Knot *end, double step, Complex *signal)
{
    Knot start = *end;
    start.slope = added(end->slope, -step, end->second);
    start.value = added(end->value, -step, added(end->slope, -0.5 * step, end->second));
    knot_from_start(&start, QUINTIC_ORDERS, signal);
}

Knot knot_end(const Complex *signal, int orders, double step)
{
    Knot end;
    end.second = complex_of(0.0, 0.0);
    signal_at(signal, orders, step, &end.value);
    return end;
}

void signal_predicted(const Signal *signal, int orders, Complex *ahead)
{
    const Complex *last = signal->last;
    const double past = signal->last_step;
    ahead[0] = signal->now.value;
    ahead[1] = signal->now.slope;
    if (orders == QUINTIC_ORDERS) {
        ahead[2] = signal->now.second;
        ahead[3] = added(last[3], past, added(last[4], 0.5 * past, last[5]));
        ahead[4] = added(last[4], past, last[5]);
        ahead[5] = last[5];
    } else {
        ahead[2] = added(last[2], past, last[3]);
        ahead[3] = last[3];
    }
}

void signal_move(Signal *signal, const Knot *end, int orders, double step)
{
    const double modulus = magnitude(end->value);
    signal->prediction_error = 0.0;
    if (signal->last_step == step) {
        const Knot extrapolated = knot_end(signal->last, orders, 2.0 * step);
        signal->prediction_error = magnitude(complex_difference(end->value, extrapolated.value));
    }
    signal->largest = larger(signal->largest, modulus);
    knot_hermite(&signal->now, end, orders, step, signal->last);
    signal->now = *end;
    signal->last_step = step;
}
