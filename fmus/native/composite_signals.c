#include "composite.h"
#include "elementary.h"

void knot_hermite(Knot start, Knot end, double step, Complex *cubic)
{
    signal_hermite(start.value, start.slope, end.value, end.slope, step, cubic);
}

static Complex added(Complex a, double factor, Complex b)
{
    return complex_sum(a, complex_scaled(factor, b));
}

Knot knot_end(const Complex *cubic, double step)
{
    const double half = 0.5 * step, third = step / 3.0;
    Knot end;
    end.value = added(cubic[0], step, added(cubic[1], half, added(cubic[2], third, cubic[3])));
    end.slope = added(cubic[1], step, added(cubic[2], half, cubic[3]));
    return end;
}

void signal_predicted(const Signal *signal, Complex *cubic)
{
    cubic[0] = signal->now.value;
    cubic[1] = signal->now.slope;
    cubic[2] = added(signal->last[2], signal->last_step, signal->last[3]);
    cubic[3] = signal->last[3];
}

void signal_move(Signal *signal, Knot end, double step)
{
    const double modulus = magnitude(end.value);
    signal->prediction_error = 0.0;
    if (signal->last_step == step) {
        const Knot led = knot_end(signal->last, 2.0 * step);
        signal->prediction_error = magnitude(complex_difference(end.value, led.value));
    }
    signal->largest = larger(signal->largest, modulus);
    knot_hermite(signal->now, end, step, signal->last);
    signal->now = end;
    signal->last_step = step;
}
