/* How the weights' plane moves, in the axes that turn with the rotor. */
#include "base/elementary.h"
#include "units/weights.h"

double *weights_impulses(const Unit *unit)
{
    return unit->memory + 3 * ((const Balls *)unit->own)->count;
}

Complex weights_pulse(const Unit *unit)
{
    return complex_of(weights_impulses(unit)[2], weights_impulses(unit)[3]);
}

void rotate_derivatives(Complex *derivatives, int count, const Spin *spin, int against)
{
    const double sign = against ? -1.0 : 1.0;
    const double w = sign * spin->speed, spin_up = sign * spin->rates[0];
    const Complex turn = rect(1.0, -sign * spin->angle);
    const Complex value = derivatives[0], slope = derivatives[1];
    int k;
    /* slope - i w value */
    derivatives[1] = complex_of(slope.re + w * value.im, slope.im - w * value.re);
    if (count == 3) { /* second - 2 i w slope - (w^2 + i w') value */
        const Complex moved = complex_product(complex_of(w * w, spin_up), value);
        derivatives[2].re += 2.0 * w * slope.im - moved.re;
        derivatives[2].im -= 2.0 * w * slope.re + moved.im;
    }
    for (k = 0; k < count; k++) {
        derivatives[k] = complex_product(derivatives[k], turn);
    }
}

Instant find_plane_motion(const Unit *unit, Complex *pulse_acceleration)
{
    const Balls *own = unit->own;
    const double *in = weights_drive(unit);
    const double ago = unit->memory[unit->memory_count - 1];
    const Spin start = spin_of(in[ANGLE], in[SPEED], in + ACCELERATION);
    Instant now;
    now.motion[2] = complex_of(0.0, 0.0);
    signal_at(weights_signal(unit), own->orders, ago, now.motion);
    now.spin = spin_after(&start, ago);
    if (unit->layout.sizes.fixed_frame) {
        rotate_derivatives(now.motion, own->orders / 2, &now.spin, 0);
    }
    *pulse_acceleration = complex_scaled(own->track.mobility, weights_pulse(unit));
    now.motion[0] = complex_difference(now.motion[0], *pulse_acceleration);
    return now;
}
