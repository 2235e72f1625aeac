/* The motor of limited power as a unit. */
#include "base/elementary.h"
#include "fmi/unit.h"
#include "rotor/motor.h"
#include "units/angle.h"

enum { SIGNALS = 1, TORQUES = 4 };

/* In memory: the angle, then the speed. */
enum { SPEED = ANGLE_SIZE };

/* Outputs: the computed ones, then those observed. */
enum { ACCELERATION, ACCELERATION_SLOPE, SPEED_OUT, ANGLE_OUT, DRIVE_TORQUE, POWER };

static size_t memory_size(const Layout *layout)
{
    (void)layout;
    return ANGLE_SIZE + 1;
}

static void starts(const Layout *layout, double *real)
{
    const int last = layout->sizes.points - 1;
    int k;
    for (k = 0; k <= last; k++) {
        real[1 + 2 * k] = 300.0 * k / last;
        real[2 + 2 * k] = 10.0 * (last - k) / last;
    }
}

static int parameters(Unit *unit)
{
    Motor *own = unit->own;
    Failure failure;
    own->inertia = unit->real[0];
    own->count = unit->layout.sizes.points;
    own->points = unit->real + 1;
    own->negligible = infinity();
    own->quadrature = quadrature_empty();
    return motor_check(own, &failure) ? unit_failed(unit, &failure, NULL, 0) : 0;
}

static int begin(Unit *unit)
{
    const double *start = unit->real + unit->layout.parameters.count - 2;
    angle_start(unit->memory, start[0]);
    unit->memory[SPEED] = start[1];
    return 0;
}

/* Computed outputs under a torque on the shaft and its slope. */
static void put(Unit *unit, const double *torque)
{
    double *out = unit->real + unit->layout.computed.first;
    motor_acceleration(unit->own, unit->memory[SPEED], torque, out);
    out[SPEED_OUT] = unit->memory[SPEED];
}

static int step(Unit *unit, double length)
{
    const double *torque = unit->real + unit->layout.inputs.first;
    Motor *own = unit->own;
    double end[2], turned;
    Failure failure;
    if (motor_advance(own, unit->memory + SPEED, &turned, torque, length, &failure)) {
        return unit_failed(unit, &failure, NULL, 0);
    }
    unit->made = length = own->reached;
    angle_turn(unit->memory, turned);
    end[0] = torque[0] +
             length * (torque[1] + length * (torque[2] / 2.0 + length * torque[3] / 6.0));
    end[1] = torque[1] + length * (torque[2] + length * torque[3] / 2.0);
    put(unit, end);
    return 0;
}

static int outputs(Unit *unit)
{
    put(unit, unit->real + unit->layout.inputs.first);
    return 0;
}

static void observe(Unit *unit)
{
    const double speed = unit->memory[SPEED], torque = motor_torque(unit->own, speed);
    double *out = unit->real + unit->layout.computed.first;
    out[ANGLE_OUT] = angle_total(unit->memory);
    out[DRIVE_TORQUE] = torque;
    out[POWER] = torque * speed;
}

static size_t signals(const Layout *layout, size_t *first)
{
    *first = layout->inputs.first;
    return SIGNALS;
}

static int directional(Unit *unit, const double *seed, double *change)
{
    const Motor *own = unit->own;
    int k;
    for (k = SPEED_OUT; k <= POWER; k++) {
        change[k] = 0.0;
    }
    change[ACCELERATION] = seed[0] / own->inertia;
    change[ACCELERATION_SLOPE] =
        (motor_slope(own, unit->memory[SPEED]) * change[ACCELERATION] + seed[1]) / own->inertia;
    return 0;
}

static int slope(Unit *unit, size_t reference, double *value)
{
    const double *out = unit->real + unit->layout.computed.first;
    const size_t output = reference - unit->layout.computed.first;
    *value = output == SPEED_OUT ? out[ACCELERATION] : out[SPEED_OUT];
    return output != SPEED_OUT && output != ANGLE_OUT;
}

const Equations MOTOR_EQUATIONS = {
    .name = "Motor", .own_size = sizeof(Motor), .memory_size = memory_size, .starts = starts,
    .parameters = parameters, .begin = begin, .step = step, .outputs = outputs, .observe = observe,
    .signals = signals, .directional = directional, .slope = slope};
