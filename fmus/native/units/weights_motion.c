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
