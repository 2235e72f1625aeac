/* The motor of limited power as a unit. */
#include "base/elementary.h"
#include "constants.h"
#include "fmi/unit.h"
#include "rotor/motor.h"
#include "units/angle.h"

enum { MOTOR_SIGNALS = 1 };

/* In memory: the angle, then the speed. */
enum { MEMORY_SPEED = ANGLE_SIZE };

/* Outputs: the computed ones, then those observed. */
enum { OUT_ACCELERATION, OUT_ACCELERATION_SLOPE, OUT_SPEED, OUT_ANGLE, OUT_DRIVE_TORQUE, OUT_POWER };

static size_t motor_memory_size(const Layout *layout)
{
    (void)layout;
    return ANGLE_SIZE + 1;
}

static void motor_fields(const Unit *unit, Fields *fields)
{
    (void)unit;
    angle_fields(fields);
    fields_number(fields, "speed", fields_here(fields), 1);
}

static void motor_starts(const Layout *layout, double *real)
{
    const int last = layout->sizes.points - 1;
    int k;
    for (k = 0; k <= last; k++) {
        real[1 + 2 * k] = 300.0 * k / last;
        real[2 + 2 * k] = 10.0 * (last - k) / last;
    }
}

static int motor_parameters(Unit *unit)
{
    Motor *own = unit->own;
    Failure failure;
    own->inertia = unit->real[0];
    own->count = unit->layout.sizes.points;
    own->points = unit->real + 1;
    own->quadrature = quadrature_empty();
    return motor_check(own, &failure) ? unit_failed(unit, &failure) : 0;
}

static int motor_begin(Unit *unit)
{
    const double *start = unit->real + unit->layout.parameters.count - 2;
    angle_start(unit->memory, start[0]);
    unit->memory[MEMORY_SPEED] = start[1];
    return 0;
}

/* Computed outputs under a torque on the shaft and its slope. */
static void motor_put_outputs(Unit *unit, const double *torque)
{
    double *out = unit->real + unit->layout.computed.first;
    motor_acceleration(unit->own, unit->memory[MEMORY_SPEED], torque, out);
    out[OUT_SPEED] = unit->memory[MEMORY_SPEED];
}

static int motor_step_unit(Unit *unit, double length)
{
    const double *torque = unit->real + unit->layout.inputs.first;
    Motor *own = unit->own;
    double end[2], turned;
    Failure failure;
    if (motor_advance(own, unit->memory + MEMORY_SPEED, &turned, torque, length, &failure)) {
        return unit_failed(unit, &failure);
    }
    angle_turn(unit->memory, turned);
    end[0] = torque[0] +
             length * (torque[1] + length * (torque[2] / 2.0 + length * torque[3] / 6.0));
    end[1] = torque[1] + length * (torque[2] + length * torque[3] / 2.0);
    motor_put_outputs(unit, end);
    return 0;
}

static int motor_outputs(Unit *unit)
{
    motor_put_outputs(unit, unit->real + unit->layout.inputs.first);
    return 0;
}

static int motor_observe(Unit *unit)
{
    const double speed = unit->memory[MEMORY_SPEED], torque = motor_torque(unit->own, speed);
    double *out = unit->real + unit->layout.computed.first;
    out[OUT_ANGLE] = angle_total(unit->memory);
    out[OUT_DRIVE_TORQUE] = torque;
    out[OUT_POWER] = torque * speed;
    return 0;
}

static size_t motor_signals(const Layout *layout, size_t *first)
{
    *first = layout->inputs.first;
    return MOTOR_SIGNALS;
}

static int motor_output_slope(Unit *unit, size_t reference, double *value)
{
    const double *out = unit->real + unit->layout.computed.first;
    const size_t output = reference - unit->layout.computed.first;
    if (output == OUT_SPEED || output == OUT_ANGLE) {
        *value = output == OUT_SPEED ? out[OUT_ACCELERATION] : out[OUT_SPEED];
    } else if (output >= OUT_DRIVE_TORQUE) {
        const Motor *own = unit->own;
        const double speed = unit->memory[MEMORY_SPEED], rise = motor_slope(own, speed) * out[OUT_ACCELERATION];
        *value = output == OUT_POWER ? rise * speed + motor_torque(own, speed) * out[OUT_ACCELERATION] : rise;
    }
    return 0;
}

static size_t motor_state_count(const Layout *layout)
{
    (void)layout;
    return 1;
}

const Equations MOTOR_EQUATIONS = {
    .name = "Motor", .own_size = sizeof(Motor), .memory_size = motor_memory_size,
    .fields = motor_fields,
    .starts = motor_starts, .parameters = motor_parameters, .begin = motor_begin,
    .step = motor_step_unit, .outputs = motor_outputs, .observe = motor_observe,
    .signals = motor_signals, .slope = motor_output_slope, .states = motor_state_count, .turns = 1,
    .nominals = {NOMINAL_ANGULAR_VELOCITY}};
