/* Derivatives of the weights' force: by the inputs, exact, and by time. */
#include <string.h>

#include "reaction_change.h"
#include "unit_weights.h"

int weights_directional(Unit *unit, const double *seed, double *change)
{
    const Balls *own = unit->own;
    const double *in = unit->real + unit->layout.inputs.first;
    const double *out = unit->real + unit->layout.computed.first;
    const double *angles = unit->memory, *speeds = angles + own->count;
    const int fixed = unit->layout.sizes.fixed_frame;
    Complex acceleration, slope, force, force_slope;
    Instant by;
    Failure failure;
    memset(change, 0,
           (unit->layout.computed.count + unit->layout.observed.count) * sizeof(double));
    weights_motion_now(unit, &acceleration, &slope);
    by.acceleration = complex_of(seed[0], seed[1]);
    by.slope = complex_of(seed[2], seed[3]);
    by.rotor_speed = seed[SPEED];
    if (fixed) {
        /* (a' - i w a) e^{-i beta}: by a and a', by w, and by beta */
        weights_rotating(in[ANGLE], in[SPEED], &by.acceleration, &by.slope);
        by.slope.re += seed[SPEED] * acceleration.im + seed[ANGLE] * slope.im;
        by.slope.im -= seed[SPEED] * acceleration.re + seed[ANGLE] * slope.re;
        by.acceleration.re += seed[ANGLE] * acceleration.im;
        by.acceleration.im -= seed[ANGLE] * acceleration.re;
    }
    if (track_reaction_change(&own->track, angles, speeds, speeds + own->count, acceleration,
                              slope, in[SPEED], in[ACCELERATION], &by, seed[ACCELERATION],
                              &force, &force_slope, own->scratch, &failure)) {
        return unit_failed(unit, &failure, angles, (size_t)own->count);
    }
    force = complex_difference(force, complex_scaled(own->sent, by.acceleration));
    force_slope = complex_difference(force_slope, complex_scaled(own->sent, by.slope));
    if (fixed) {
        weights_rotating(-in[ANGLE], -in[SPEED], &force, &force_slope);
        /* (F' + i w F) e^{i beta} by w and by beta */
        force_slope.re -= seed[SPEED] * out[FORCE + 1] + seed[ANGLE] * out[FORCE_SLOPE + 1];
        force_slope.im += seed[SPEED] * out[FORCE] + seed[ANGLE] * out[FORCE_SLOPE];
        force.re -= seed[ANGLE] * out[FORCE + 1];
        force.im += seed[ANGLE] * out[FORCE];
    }
    change[FORCE] = force.re;
    change[FORCE + 1] = force.im;
    change[FORCE_SLOPE] = force_slope.re;
    change[FORCE_SLOPE + 1] = force_slope.im;
    return 0;
}

int weights_slope(Unit *unit, size_t reference, double *value)
{
    const size_t count = (size_t)((const Balls *)unit->own)->count;
    const size_t output = reference - unit->layout.observed.first;
    *value = 0.0;
    if (reference == unit->layout.computed.first + ADDED_MASS) {
        return 0;
    }
    if (reference < unit->layout.observed.first || output >= count) {
        return 1;
    }
    *value = unit->memory[count + output];
    return 0;
}
