/* The shaft: a motor of limited power, and the units that it drives and whose torque it feels. */
#include <string.h>

#include "base/elementary.h"
#include "coupling/composite.h"
#include "rotor/motor.h"

/* Outputs of the motor's unit from its first on. */
enum { RATE, RATE_SLOPE, SPEED_REACHED };

/* Whether weights can touch or stick, which take no change of w' within a step. */
static bool can_meet_or_stick(const Part *part)
{
    const double *real = part->unit->real;
    return part_balls(part) && (real[WEIGHT_RADIUS] > 0.0 || real[ROLLING] > 0.0);
}

/* sqrt(I M), inertia that turns and mass of the loaded rotor: a force of an angular acceleration. */
static double scale_of(const Composite *c)
{
    const Rotor *rotor = composite_rotor(c);
    double mass = sum_of(rotor->rotor.mass, rotor->stations * rotor->stations);
    int k;
    composite_added_masses(c, c->masses);
    for (k = 0; k < rotor->planes; k++) {
        mass += c->masses[k];
    }
    return square_root(c->motor->unit->real[0] * mass);
}

/* Torque of all units on the shaft, and its slope. */
static void read_torque(const Composite *c, double *torque)
{
    int k;
    torque[0] = torque[1] = 0.0;
    for (k = 0; k < c->parts_without_motor; k++) {
        const Part *part = c->parts + k;
        if (part->torque >= 0) {
            part->unit->equations->observe_torques(part->unit);
            torque[0] += part->unit->real[part->torque];
            torque[1] += part->unit->real[part->torque + 1];
        }
    }
}

/* What the motor answers. */
static Knot answer(const Composite *c)
{
    const Unit *motor = c->motor->unit;
    const double *out = motor->real + motor->layout.computed.first;
    Knot knot;
    knot.value = complex_of(c->course->shaft.spin_scale * out[RATE], 0.0);
    knot.slope = complex_of(c->course->shaft.spin_scale * out[RATE_SLOPE], 0.0);
    c->course->shaft.speed_reached = out[SPEED_REACHED];
    return knot;
}

int shaft_begin(Unit *unit)
{
    static const Complex still[SIGNAL_ORDERS] = {{0.0, 0.0}};
    Composite *c = unit->own;
    c->course->shaft.spin_scale = scale_of(c);
    if (c->motor->unit->equations->outputs(c->motor->unit)) {
        return composite_part_failed(unit, c->motor);
    }
    answer(c);
    c->course->drive.speed = c->course->shaft.speed_reached;
    shaft_tell(unit, still, 0.0);
    return 0;
}

void shaft_tell(Unit *unit, const Complex *spin, double step)
{
    const Composite *c = unit->own;
    const double scale = c->course->shaft.spin_scale;
    const double rates[SIGNAL_ORDERS] = {spin[0].re / scale, spin[1].re / scale, spin[2].re / scale,
                                         spin[3].re / scale};
    const double mean =
        rates[0] + step * (rates[1] / 2.0 + step * (rates[2] / 6.0 + step * rates[3] / 24.0));
    int k;
    for (k = 0; k < c->parts_without_motor; k++) {
        double *speed = c->parts[k].unit->real + c->parts[k].speed_input;
        if (c->parts[k].speed_input < 0) {
            continue;
        }
        speed[0] = c->course->drive.speed;
        memcpy(speed + SPIN_UP, rates, sizeof rates);
        if (can_meet_or_stick(c->parts + k)) {
            memset(speed + SPIN_UP, 0, sizeof rates);
            speed[SPIN_UP] = mean; /* of order 1, as contacts are */
        }
    }
}

int shaft_answer(Unit *unit, Knot *spin)
{
    Composite *c = unit->own;
    Course *course = c->course;
    Unit *motor = c->motor->unit;
    double *input = motor->real + motor->layout.inputs.first;
    read_torque(c, course->shaft.torque);
    memcpy(course->shaft.torque_reached, course->shaft.torque, sizeof course->shaft.torque);
    memcpy(input, course->shaft.torque, sizeof course->shaft.torque);
    input[2] = input[3] = 0.0;
    if (motor->equations->outputs(motor)) {
        return composite_part_failed(unit, c->motor);
    }
    *spin = answer(c);
    return 0;
}

/* Step the motor; a step that is not brief ends at a corner of its characteristic, where w'' jumps,
   unless that changes its torque by less than the loop may leave of it. */
static int advance_motor(Unit *unit, double step)
{
    Composite *c = unit->own;
    const Course *course = c->course;
    Motor *motor = c->motor->unit->own;
    int wrong;
    if (step > brief_length(unit)) {
        motor->negligible = course->loop.tolerance * course->loop.largest /
                            course->shaft.spin_scale * motor->inertia;
    }
    wrong = composite_advance(unit, c->motor, step);
    motor->negligible = infinity();
    return wrong;
}

int shaft_pass(Unit *unit, double step, Knot *spin)
{
    Composite *c = unit->own;
    Course *course = c->course;
    Unit *motor = c->motor->unit;
    Complex cubic[SIGNAL_ORDERS];
    Knot begin, end;
    int k;
    read_torque(c, course->shaft.torque_reached);
    begin.value = complex_of(course->shaft.torque[0], 0.0);
    begin.slope = complex_of(course->shaft.torque[1], 0.0);
    end.value = complex_of(course->shaft.torque_reached[0], 0.0);
    end.slope = complex_of(course->shaft.torque_reached[1], 0.0);
    knot_hermite(&begin, &end, step, cubic);
    for (k = 0; k < SIGNAL_ORDERS; k++) {
        motor->real[motor->layout.inputs.first + (size_t)k] = cubic[k].re;
    }
    if (advance_motor(unit, step)) {
        return 1;
    }
    *spin = answer(c);
    return 0;
}

void shaft_accept(Composite *c)
{
    memcpy(c->course->shaft.torque, c->course->shaft.torque_reached, sizeof c->course->shaft.torque);
    c->course->drive.speed = c->course->shaft.speed_reached;
}

double shaft_speed(const Composite *c)
{
    const Unit *motor = c->motor->unit;
    return motor->real[motor->layout.computed.first + SPEED_REACHED];
}

Knot shaft_stand(Composite *c)
{
    const Knot spin = answer(c);
    read_torque(c, c->course->shaft.torque_reached);
    shaft_accept(c);
    return spin;
}
