/* Where the drive, the unbalance or what a host says jumps: a step of the machine begins there. */
#include "base/elementary.h"
#include "coupling/composite.h"

static const double SAME_SPEED = 1e-9; /* of the speed: what differs less is no jump */

int composite_begin_anew(Unit *unit, double time)
{
    const Composite *c = unit->own;
    if (one_piece_begin_anew(unit)) { /* while the time is still the end of the present step */
        return 1;
    }
    c->course->clock.time = time;
    return 0;
}

double composite_next_jump(const Composite *c)
{
    const double corner = c->course->drive.next_corner, change = c->course->drive.next_change;
    return smaller(corner < 0.0 ? infinity() : corner, change < 0.0 ? infinity() : change);
}

static void pass_corner(Unit *unit)
{
    const Composite *c = unit->own;
    DriveSignal *drive = &c->course->drive;
    const size_t passed = (size_t)drive->passed;
    const double *next = unit->real + c->rise + 1 + 2 * passed, time = drive->next_corner;
    /* where corners say the speed, rounding of the line up to it must not add up */
    drive->speed = passed ? next[-1] : composite_speed(c, time);
    drive->acceleration = 0.0;
    drive->next_corner = NONE_AHEAD;
    drive->set_at = time;
    if (passed < c->corner_count && next[0] > 0.0) {
        drive->next_corner = next[0];
        drive->acceleration = (next[1] - drive->speed) / (drive->next_corner - time);
    }
    drive->passed += 1.0;
}

int composite_pass_jump(Unit *unit)
{
    const Composite *c = unit->own;
    DriveSignal *drive = &c->course->drive;
    const double time = composite_next_jump(c);
    if (drive->next_corner == time) {
        pass_corner(unit);
    }
    while (drive->next_change == time) {
        drive->changes_behind += 1.0;
        if (drive_await_change(unit)) {
            return 1;
        }
    }
    return composite_begin_anew(unit, time) || composite_follow_changes(unit);
}

/* -- the host ----------------------------------------------------------------------------------- */

/* Look at what the host has set; 1 with the reason where it may not. */
static int meet_inputs(Unit *unit)
{
    const Composite *c = unit->own;
    const Course *course = c->course;
    const double *speed = unit->real + c->speed_input;
    const double extrapolated_speed = composite_speed(c, unit->time);
    const int rises = unit->real[c->rise] > 0.0;
    const int same =
        rises || (speed[1] == course->drive.acceleration &&
                  absolute(speed[0] - extrapolated_speed) <= SAME_SPEED * course->drive.fastest);
    const int jumps = !same || outside_jumps(unit);
    if (rises &&
        (speed[0] != course->drive.first_speed || speed[1] != course->drive.first_acceleration)) {
        return unit_fail(unit, "speed, acceleration: the rotor speeds up by itself, as rise_time "
                         "is above 0 s");
    }
    if (jumps || unit->for_model_exchange || (!rises && speed[1] != 0.0)) {
        drive_take_inputs(unit);
    }
    return jumps && composite_begin_anew(unit, unit->time);
}

int composite_meet_host(Unit *unit)
{
    const Composite *c = unit->own;
    if (c->course->clock.started > 0.0 && !c->pieces.is_made && one_piece_make(unit)) {
        return 1; /* the state is a restored one: of what follows all depends on its machine */
    }
    if (c->motor && outside_jumps(unit)) {
        drive_take_inputs(unit);
        if (composite_begin_anew(unit, unit->time)) {
            return 1;
        }
    } else if (!c->motor && meet_inputs(unit)) {
        return 1;
    }
    return composite_follow_changes(unit);
}
