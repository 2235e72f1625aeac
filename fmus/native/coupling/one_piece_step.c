/* Steps in one piece. */
#include <string.h>

#include "base/elementary.h"
#include "constants.h"
#include "coupling/composite.h"

enum { FEWEST_LOOKS_OF_STEP = 8 };
#define SHORTEST_LENGTH 1e-12 /* of a step to a corner: less is none */

/* Ends of a line of the motor's torque, in the machine's time; the outer ones go on for ever. */
static void ends_of_line(const Machine *m, int line, double *ends)
{
    const Motor *motor = m->drive.motor;
    ends[0] = line > 0 ? motor->points[2 * line] * m->per_rate : -infinity();
    ends[1] = line < motor->count - 2 ? motor->points[2 * line + 2] * m->per_rate : infinity();
}

/* Go to the end of the step; 1 with the reason. */
static int finish(Unit *unit)
{
    const Composite *c = unit->own;
    OnePiece *one_piece = &c->course->one_piece;
    if (one_piece_look_on(unit, infinity()) || one_piece_expand(unit)) {
        return 1;
    }
    one_piece_stand_at(unit, c->course->clock.length * c->pieces.step.rate);
    if (c->motor &&
        one_piece->leaves != 0.0) { /* the speed is that of the corner, without rounding */
        const Motor *motor = c->motor->unit->own;
        const int corner = (int)larger(0.0, one_piece->line + (one_piece->leaves > 0.0));
        c->motor->unit->memory[ANGLE_SIZE] = motor->points[2 * corner];
        one_piece->line = smaller(one_piece->line + one_piece->leaves, motor->count - 2.0);
    }
    return 0;
}

/* The parts stand at the start of a step. */
static void begin_step(Unit *unit)
{
    const Composite *c = unit->own;
    Course *course = c->course;
    OnePiece *one_piece = &course->one_piece;
    const size_t forces = outside_count(c);
    const double *place = c->parts->unit->memory + MOTION;
    memcpy(c->at_begin, c->states, c->state_count * sizeof(double));
    memcpy(c->pieces.begun_forces, c->outer_forces, forces * sizeof(double));
    course->clock.begin = course->clock.shown = course->clock.time;
    one_piece->order = machine_order(one_piece_step_tolerance(unit));
    one_piece->stands = course->clock.within = one_piece->leaves = one_piece->looked = 0.0;
    one_piece->placed = 1.0;
    one_piece->changes_behind = course->drive.changes_behind;
    one_piece->pushed = course->clock.time - course->drive.pushed_at;
    one_piece->speed =
        c->motor ? c->motor->unit->memory[ANGLE_SIZE] : composite_speed(c, course->clock.time);
    one_piece->acceleration = c->motor ? 0.0 : course->drive.acceleration;
    one_piece->largest =
        larger(one_piece->largest, largest_of(2 * composite_rotor(c)->stations, place));
    if (c->motor && one_piece->line < 0.0) {
        one_piece->line = motor_line(c->motor->unit->own, one_piece->speed);
    }
}

/* Length of the step in the machine's time; 1 with the reason. */
static int choose_length(Unit *unit, double *length)
{
    enum { MOST_LINES = 4 };
    const Composite *c = unit->own;
    const Machine *m = &c->pieces.step;
    OnePiece *one_piece = &c->course->one_piece;
    int k, leaves = 0;
    for (k = 0; k < MOST_LINES; k++) {
        double ends[2];
        if (one_piece_expand(unit)) {
            return 1;
        }
        *length = machine_length(m, one_piece_order(c), one_piece_step_tolerance(unit), one_piece->largest);
        if (!c->motor) {
            break;
        }
        ends_of_line(m, (int)one_piece->line, ends);
        leaves = machine_leaves_line(m, one_piece_order(c), ends, length);
        if (!leaves || *length > SHORTEST_LENGTH) {
            break;
        }
        one_piece->line += leaves; /* the speed is at the corner and goes on beyond it */
    }
    one_piece->leaves = leaves;
    return 0;
}

/* Go to the end of the last step and begin the next, where that has not been done; 1 with the reason. */
static int begin_next(Unit *unit)
{
    Composite *c = unit->own;
    if (c->pieces.is_begun) {
        c->pieces.is_begun = false;
        return 0;
    }
    if (c->course->one_piece.stands == 0.0 && finish(unit)) {
        return 1;
    }
    begin_step(unit);
    return 0;
}

int one_piece_prepare(Unit *unit, double *angle, bool *is_wanted)
{
    Pieces *pieces = &((Composite *)unit->own)->pieces;
    pieces->is_begun = false;
    if (begin_next(unit)) {
        return 1;
    }
    pieces->is_begun = true;
    return one_piece_load_step(unit, angle, is_wanted);
}

int one_piece_step(Unit *unit)
{
    const Composite *c = unit->own;
    Course *course = c->course;
    OnePiece *one_piece = &course->one_piece;
    double length, end, turned;
    if (begin_next(unit) || choose_length(unit, &length)) {
        return 1;
    }
    end = course->clock.begin + length * c->pieces.step.per_rate;
    if (!(end > course->clock.begin)) {
        return unit_fail(unit, "the motion at t = %6 s is not finite, or too fast for the time to go on",
                         unit_host_time(unit, course->clock.begin));
    }
    course->clock.time = end;
    course->clock.length = end - course->clock.begin; /* rounded as the time is */
    turned = machine_turned(&c->pieces.step, one_piece_order(c), length);
    one_piece->looks =
        larger(FEWEST_LOOKS_OF_STEP, nearest(absolute(turned) / TAU * FEWEST_LOOKS + 0.5));
    if (one_piece_is_unwatched(unit)) {
        one_piece->looked = one_piece->looks;
    }
    course->total.steps += 1.0;
    course->total.error = one_piece_step_tolerance(unit);
    return 0;
}
