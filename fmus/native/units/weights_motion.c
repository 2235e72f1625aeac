/* How the weights' plane moves, in the axes that turn with the rotor. */
#include "base/elementary.h"
#include "base/spin.h"
#include "units/weights.h"

double *weights_impulses(const Unit *unit)
{
    return unit->memory + 3 * ((const Balls *)unit->own)->count;
}

Complex weights_pulse(const Unit *unit)
{
    return complex_of(weights_impulses(unit)[2], weights_impulses(unit)[3]);
}

Complex weights_rotating_second(double angle, double speed, double spin_up, Complex value,
                                Complex slope, Complex second)
{
    /* second - 2 i w slope - (w^2 + i w') value */
    const Complex moved = complex_product(complex_of(speed * speed, spin_up), value);
    const Complex seen = complex_of(second.re + 2.0 * speed * slope.im - moved.re,
                                    second.im - 2.0 * speed * slope.re - moved.im);
    return complex_product(seen, rect(1.0, -angle));
}

void weights_rotating(double angle, double speed, Complex *value, Complex *slope)
{
    const Complex turn = rect(1.0, -angle);
    /* slope - i w value */
    const Complex seen = complex_of(slope->re + speed * value->im, slope->im - speed * value->re);
    *value = complex_product(*value, turn);
    *slope = complex_product(seen, turn);
}

RotorMotion weights_motion_now(const Unit *unit)
{
    const Balls *own = unit->own;
    const double *in = weights_drive(unit), *spin_up = in + ACCELERATION;
    const double ago = unit->memory[unit->memory_count - 1];
    const Drift more = drift(spin_up, ago);
    RotorMotion now;
    now.second = complex_of(0.0, 0.0);
    if (unit->layout.sizes.order == 5) {
        Complex motion[3];
        signal_derivatives(unit->real + unit->layout.inputs.first, 5, ago, motion);
        now.acceleration = motion[0];
        now.slope = motion[1];
        now.second = motion[2];
    } else {
        Complex cubic[SIGNAL_ORDERS];
        signal_orders(in, cubic);
        signal_at(cubic, ago, &now.acceleration, &now.slope);
    }
    now.angle = in[ANGLE] + ago * (in[SPEED] + 0.5 * spin_up[0] * ago) + more.angle;
    now.speed = in[SPEED] + spin_up[0] * ago + more.speed;
    now.spin_up = spin_up[0] + more.acceleration;
    now.change = more.slope;
    now.curvature = spin_up[2] + ago * spin_up[3];
    if (unit->layout.sizes.fixed_frame) {
        now.second = weights_rotating_second(now.angle, now.speed, now.spin_up, now.acceleration, now.slope,
                                     now.second);
        weights_rotating(now.angle, now.speed, &now.acceleration, &now.slope);
    }
    now.pulse_acceleration = complex_scaled(own->track.mobility, weights_pulse(unit));
    now.acceleration = complex_difference(now.acceleration, now.pulse_acceleration);
    return now;
}
