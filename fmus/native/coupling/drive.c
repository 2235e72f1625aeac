/* The drive of the rotor: prescribed speed, profile or motor, and the inputs that the host sets. */
#include "base/elementary.h"
#include "coupling/composite.h"

double composite_speed(const Composite *c, double time)
{
    const DriveSignal *drive = &c->course->drive;
    return drive->speed + (time - drive->set_at) * drive->acceleration;
}

double composite_speed_now(const Unit *unit)
{
    const Composite *c = unit->own;
    return c->motor ? c->motor->unit->memory[ANGLE_SIZE] : composite_speed(c, unit->time);
}

void composite_drive(Unit *unit, double time)
{
    const Composite *c = unit->own;
    int k;
    for (k = 0; k < c->part_count; k++) {
        const Part *part = c->parts + k;
        if (part->speed_input >= 0) {
            double *speed = part->unit->real + part->speed_input;
            speed[0] = c->motor ? composite_speed_now(unit) : composite_speed(c, time);
            speed[1] = c->motor ? 0.0 : c->course->drive.acceleration;
        }
    }
}

/* -- the start ---------------------------------------------------------------------------------- */

int drive_await_change(Unit *unit)
{
    const Composite *c = unit->own;
    DriveSignal *drive = &c->course->drive;
    const size_t behind = (size_t)drive->changes_behind;
    const double *change = unit->real + c->changes + CHANGE_VALUES * behind;
    const double before = drive->next_change;
    drive->next_change = NONE_AHEAD;
    if (behind == c->change_count || !(change[0] > 0.0)) {
        return 0;
    }
    drive->next_change = change[0];
    if (drive->next_change < before) {
        return unit_fail(unit, "unbalance_change[k].time: must not fall; 0 s: not used, nor those "
                         "behind");
    }
    return composite_refuse_number(unit, change[CHANGE_NUMBER]);
}

/* The speed that is prescribed; 1 with the reason. */
static int begin_prescribed(Unit *unit)
{
    const Composite *c = unit->own;
    const double *corner = unit->real + c->rise;
    DriveSignal *drive = &c->course->drive;
    double time = *corner++;
    size_t k;
    drive->speed = drive->first_speed = unit->real[c->speed_input];
    drive->acceleration = drive->first_acceleration = unit->real[c->speed_input + 1];
    drive->next_corner = NONE_AHEAD;
    if (drive_await_change(unit)) {
        return 1;
    }
    if (!(time > 0.0)) {
        return 0;
    }
    drive->next_corner = time;
    drive->fastest = larger(drive->fastest, absolute(drive->speed + time * drive->acceleration));
    for (k = 0; k < c->corner_count && corner[0] > 0.0; k++, corner += 2) {
        if (!(corner[0] > time)) {
            return unit_fail(unit, "corner[k].time: must ascend, from above rise_time on; 0 s: not "
                             "used, nor those behind");
        }
        drive->fastest = larger(drive->fastest, corner[1]);
        time = corner[0];
    }
    return 0;
}

void drive_take_inputs(Unit *unit)
{
    Composite *c = unit->own;
    Course *course = c->course;
    if (!c->motor && !(unit->real[c->rise] > 0.0)) {
        course->drive.set_at = unit->time;
        course->drive.speed = unit->real[c->speed_input];
        course->drive.acceleration = unit->real[c->speed_input + 1];
    }
    if (!c->motor) {
        course->drive.fastest = larger(course->drive.fastest, absolute(course->drive.speed));
    }
    outside_take(unit);
}

int drive_begin(Unit *unit)
{
    const Composite *c = unit->own;
    DriveSignal *drive = &c->course->drive;
    drive->fastest = unit->real[c->top_speed];
    drive->next_corner = drive->next_change = NONE_AHEAD;
    drive->set_at = unit->time;
    if (!c->motor && begin_prescribed(unit)) {
        return 1;
    }
    drive_take_inputs(unit);
    return !(drive->fastest > 0.0) && unit_fail(unit, "coupling.top_speed: must be above 0 rad/s for a rotor that "
                                                "starts at rest");
}
