/* How the weights' plane moves, in the axes that turn with the rotor. */
#include <string.h>

#include "base/elementary.h"
#include "units/weights_unit.h"

double *weights_impulses(const Unit *unit)
{
    return unit->memory + 3 * ((const Balls *)unit->own)->count;
}

Complex weights_pulse(const Unit *unit)
{
    return complex_of(weights_impulses(unit)[2], weights_impulses(unit)[3]);
}

CentreMotion find_plane_signal(const Unit *unit)
{
    const double *in = unit->real + unit->layout.inputs.first;
    CentreMotion motion;
    memcpy(motion.signal, in, sizeof motion.signal);
    motion.spin = spin_of(in[ANGLE], in[SPEED], in + ACCELERATION);
    return motion;
}

void rotate_derivatives(Complex *derivatives, const Spin *spin, int against)
{
    const double sign = against ? -1.0 : 1.0;
    const double w = sign * spin->speed;
    const Complex turn = rect(1.0, -sign * spin->angle);
    const Complex value = derivatives[0], slope = derivatives[1];
    /* slope - i w value */
    derivatives[0] = complex_product(value, turn);
    derivatives[1] = complex_product(complex_of(slope.re + w * value.im, slope.im - w * value.re), turn);
}

Instant find_plane_motion(const Unit *unit, Complex *pulse_acceleration)
{
    const Balls *own = unit->own;
    const CentreMotion motion = find_plane_signal(unit);
    Instant now = find_instant(&motion, unit->memory[unit->memory_count - 1]);
    if (unit->layout.sizes.fixed_frame) {
        rotate_derivatives(now.motion, &now.spin, 0);
    }
    *pulse_acceleration = complex_scaled(own->track.mobility, weights_pulse(unit));
    now.motion[0] = complex_difference(now.motion[0], *pulse_acceleration);
    return now;
}
