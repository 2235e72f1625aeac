/* Derivatives of the weights' force: by the inputs, exact, and by time. */
#include <string.h>

#include "base/elementary.h"
#include "contact/reaction_change.h"
#include "units/weights.h"

/* Change of the torque and its slope by that of plane and rotor and of the force, rotor frame. */
static int weights_torque_response(Unit *unit, const RotorMotion *now, const Instant *by,
                                   double by_spin_up, double by_change, const Complex *by_force,
                                   double *change)
{
    const Balls *own = unit->own;
    const Track *track = &own->track;
    const Complex by_whirl = {-2.0 * now->speed * by->rotor_speed, by_spin_up};
    const Complex by_whirl_slope = {
        -2.0 * (now->speed * by_spin_up + by->rotor_speed * now->spin_up), by_change};
    const Complex by_motion[2] = {by->acceleration, by->slope}, none[2] = {{0.0, 0.0}, {0.0, 0.0}};
    const double added = weights_added_mass(&track->weights);
    const double *rates = unit->memory + own->count;
    double still[2], moved[2], free[2][2], left[2];
    Complex centre[2];
    Failure failure;
    int k;
    centre[0] = complex_sum(by->acceleration, complex_product(by_whirl, track->offset));
    centre[1] = complex_sum(by->slope, complex_product(by_whirl_slope, track->offset));
    /* the weights' torque is linear in what they are driven by */
    weights_torque(&track->weights, unit->memory, rates, none, 0.0, 0.0, still);
    weights_torque(&track->weights, unit->memory, rates, centre, by_spin_up, by_change, moved);
    for (k = 0; k < 2; k++) {
        const Complex pull =
            complex_difference(by_force[k], complex_scaled(added, by_motion[k]));
        change[k] = moved[k] - still[k] +
                    complex_product(complex_conjugate(track->offset), pull).im;
    }
    if (!(track->rolling_resistance > 0.0)) {
        return 0;
    }
    if (track_turning_change(track, unit->memory, rates, rates + own->count, now->acceleration,
                             now->slope, now->speed, now->spin_up, by, by_spin_up, by_change, left,
                             own->scratch, &failure)) {
        return unit_failed(unit, &failure, unit->memory, (size_t)own->count);
    }
    weights_unhindered(&track->weights, unit->memory, rates, none, 0.0, 0.0, free[0]);
    weights_unhindered(&track->weights, unit->memory, rates, centre, by_spin_up, 0.0, free[1]);
    for (k = 0; k < 2; k++) {
        change[k] += track_arm(track) * (free[1][k] - free[0][k] - left[k]);
    }
    return 0;
}

int weights_directional(Unit *unit, const double *seed, double *change)
{
    const Balls *own = unit->own;
    const double *in = unit->real + unit->layout.inputs.first;
    const double *out = unit->real + unit->layout.computed.first;
    const double *angles = unit->memory, *speeds = angles + own->count;
    const int fixed = unit->layout.sizes.fixed_frame;
    const RotorMotion now = weights_motion_now(unit);
    const Complex acceleration = now.acceleration, slope = now.slope;
    Complex force, force_slope, by_force[2];
    Instant by;
    Failure failure;
    memset(change, 0,
           (unit->layout.computed.count + unit->layout.observed.count) * sizeof(double));
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
                              seed[ACCELERATION + 1], &force, &force_slope, own->scratch,
                              &failure)) {
        return unit_failed(unit, &failure, angles, (size_t)own->count);
    }
    by_force[0] = force;
    by_force[1] = force_slope;
    if (weights_torque_response(unit, &now, &by, seed[ACCELERATION], seed[ACCELERATION + 1], by_force,
                        change + unit->layout.real_count - unit->layout.computed.first - 2)) {
        return 1;
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
    if (reference == unit->layout.observed.first - 1) { /* the added mass */
        return 0;
    }
    if (reference == unit->layout.real_count - 2) { /* the torque, whose slope is beside it */
        const int wrong = unit_refresh(unit, FRESH);
        *value = unit->real[reference + 1];
        return wrong;
    }
    if (reference < unit->layout.observed.first || output >= count) {
        return 1;
    }
    *value = unit->memory[count + output];
    return 0;
}
