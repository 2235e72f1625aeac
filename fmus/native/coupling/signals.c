#include "base/elementary.h"
#include "constants.h"
#include "coupling/composite.h"

void knot_from_start(const Knot *start, Complex *signal)
{
    signal[0] = start->value;
    signal[1] = start->slope;
    signal[2] = signal[3] = complex_of(0.0, 0.0);
}

void knot_held(const Knot *knot, Complex *signal)
{
    const Knot flat = {knot->value, {0.0, 0.0}};
    knot_from_start(&flat, signal);
}

void knot_hermite(const Knot *start, const Knot *end, double step, Complex *signal)
{
    cubic_between(&start->value, &end->value, step, signal);
}

Knot knot_end(const Complex *signal, double step)
{
    Knot end;
    cubic_at(signal, step, &end.value);
    return end;
}

void signal_predicted(const Signal *signal, Complex *ahead)
{
    const Complex *last = signal->last;
    ahead[0] = signal->now.value;
    ahead[1] = signal->now.slope;
    ahead[2] = complex_sum(last[2], complex_scaled(signal->last_step, last[3]));
    ahead[3] = last[3];
}

bool signal_is_far(const Signal *signal, double step)
{
    return step > MOST_EXTRAPOLATION * signal->last_step && signal->last_step > 0.0;
}

void signal_move(Signal *signal, const Knot *end, double step)
{
    const double modulus = magnitude(end->value);
    signal->prediction_error = 0.0;
    if (signal->last_step == step) {
        const Knot extrapolated = knot_end(signal->last, 2.0 * step);
        signal->prediction_error = magnitude(complex_difference(end->value, extrapolated.value));
    }
    signal->largest = larger(signal->largest, modulus);
    knot_hermite(&signal->now, end, step, signal->last);
    signal->now = *end;
    signal->last_step = step;
}
