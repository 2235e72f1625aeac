/* Steps in one piece. */
#include <string.h>

#include "base/elementary.h"
#include "constants.h"
#include "coupling/composite.h"

enum { FEWEST_LOOKS_OF_STEP = 8, LOOKS_OF_PASS = 64, MOST_EVENTS_AT_ONCE = 30 };
#define SHORTEST_STEP 1e-15   /* of the time, and of the machine's unit of it */
#define CROWDED_STEP 1e-14    /* of the same: an event that follows so soon is hardly apart from the last */
#define SHORTEST_LENGTH 1e-12 /* of a step to a corner: less is none */
/* Speed of a station over that of a weight which its race carries along at the fastest speed.  Of what moves so fast
   doubles resolve angles of weights to 2e-10 rad, and the weights swing up to a thousand times in a turn. */
#define MOST_MOTION 1e6

/* Ends of a line of the motor's torque, in the machine's time; the outer ones go on for ever. */
static void ends_of_line(const Machine *m, int line, double *ends)
{
    const Motor *motor = m->drive.motor;
    ends[0] = line > 0 ? motor->points[2 * line] * m->per_rate : -infinity();
    ends[1] = line < motor->count - 2 ? motor->points[2 * line + 2] * m->per_rate : infinity();
}

/* The same of the table of bearings that change with the speed. */
static void ends_of_table(const Composite *c, int line, double *ends)
{
    const Bearings *b = &composite_rotor(c)->rotor.bearings;
    const double per_rate = c->pieces.step.per_rate;
    ends[0] = line > 0 ? b->speeds[line] * per_rate : -infinity();
    ends[1] = line < b->speed_count - 2 ? b->speeds[line + 1] * per_rate : infinity();
}

static int fail_as_beyond(Unit *unit)
{
    const Composite *c = unit->own;
    const int which = (int)c->course->one_piece.which;
    return unit_fail(unit, "rotor.cubic[%u]: the displacement has reached %6 m at t = %6 s, its limit: a spring that "
                     "softens pulls less and less beyond it; the rotor needs stiffer supports, or less unbalance",
                     (unsigned long)which + 1, composite_rotor(c)->cubics[which].limit,
                     unit_host_time(unit, c->course->clock.time));
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
    if (one_piece->event == SPRING_ENDS && one_piece->which < composite_rotor(c)->cubic_count) {
        return fail_as_beyond(unit);
    }
    if (c->pieces.is_eventful) {
        one_piece_pass_event(unit);
    }
    return 0;
}

int one_piece_begin_anew(Unit *unit)
{
    const Composite *c = unit->own;
    const Clock *clock = &c->course->clock;
    OnePiece *one_piece = &c->course->one_piece;
    if (!c->pieces.is_made && one_piece_make(unit)) {
        return 1;
    }
    if (one_piece->stands == 0.0) {
        const bool ends = one_piece->event != NO_EVENT && clock->shown >= clock->time;
        if (ends ? finish(unit) : one_piece_look_here(unit) || one_piece_place(unit)) {
            return 1;
        }
    }
    one_piece->stands = one_piece->placed = 1.0;
    one_piece->line = -1.0;
    one_piece->event = NO_EVENT;
    one_piece->undecided = c->pieces.is_eventful;
    return 0;
}

/* Fail where a station is so fast that what it moves cannot be followed: the rotor whirls without bound, or starts so.
   Where nothing swings the motion is linear, and followed however large it is. */
static int refuse_unbounded(Unit *unit)
{
    const Composite *c = unit->own;
    const int n = composite_rotor(c)->stations;
    const double *velocity = c->parts->unit->memory + MOTION + 2 * n;
    const double fastest = largest_of(2 * n, velocity), carried = c->pieces.shortest * c->course->drive.fastest;
    const double time = unit_host_time(unit, c->course->clock.time);
    if (!one_piece_is_too_fast(c, fastest) || !is_finite(fastest)) { /* what is not finite is refused in its own words */
        return 0;
    }
    return unit_fail(unit, "the rotor moves at %6 m/s at t = %6 s, more than 1e6 times as fast as what swings on it (%6 m/s), "
                     "which cannot be followed: it vibrates more and more by itself, or starts too fast; it needs more damping, "
                     "another speed or a shorter run, or smaller start values", fastest, time, carried);
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
    one_piece->stands = course->clock.within = one_piece->leaves = one_piece->looked = one_piece->collocated = 0.0;
    one_piece->event = NO_EVENT;
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
    if (c->pieces.step.varies) {
        one_piece->bearing_line =
            linear_rotor_line(&composite_rotor(c)->rotor, one_piece->speed, (int)one_piece->bearing_line);
    }
}

/* Internal damping by which a whirl takes a motor's shaft along, the faster the larger it is; 0: it takes none, or
   there are forces of stops, sliders or cubic springs, of which a collocation knows nothing. */
static double taken_along(const Composite *c)
{
    const Machine *m = &c->pieces.step;
    const int n = m->stations;
    double damping = 0.0;
    int k;
    if (!c->motor || m->restraints || (m->phase && m->phase->slider_count)) {
        return 0.0;
    }
    for (k = 0; k < n; k++) {
        damping += m->internal_damping[k * n + k];
    }
    return damping;
}

bool one_piece_may_collocate(const Composite *c)
{
    return c->pieces.is_stiff || taken_along(c) > 0.0;
}

/* Whether steps by collocation are tried now. */
static bool collocates(const Composite *c)
{
    const Machine *m = &c->pieces.step;
    const double largest = c->course->one_piece.largest;
    return c->pieces.is_stiff ||
           taken_along(c) * largest * largest > STIFF_RATE * c->course->drive.fastest * m->per_rate * m->drive.inertia;
}

/* Length of the step in the machine's time; 1 with the reason. */
static int choose_length(Unit *unit, double *length)
{
    enum { MOST_LINES = 4 };
    const Composite *c = unit->own;
    const Machine *m = &c->pieces.step;
    OnePiece *one_piece = &c->course->one_piece;
    const bool is_stiff = collocates(c);
    int k, leaves = 0;
    for (k = 0; k < MOST_LINES; k++) {
        double ends[2];
        int passes = 0;
        if (one_piece_expand(unit)) {
            return 1;
        }
        *length = machine_length(m, one_piece_order(c), one_piece_step_tolerance(unit), one_piece->largest,
                                 is_stiff);
        if (c->pieces.rings) {
            *length = rings_length(m, *length);
        }
        if (is_stiff && one_piece_try_collocation(unit, length)) {
            return 1;
        }
        leaves = 0;
        if (c->motor) {
            ends_of_line(m, (int)one_piece->line, ends);
            leaves = machine_leaves_line(m, one_piece_order(c), ends, length);
        }
        if (m->varies) {
            ends_of_table(c, (int)one_piece->bearing_line, ends);
            passes = machine_leaves_line(m, one_piece_order(c), ends, length);
            leaves = passes ? 0 : leaves; /* that comes later */
        }
        if (!(leaves || passes) || *length > SHORTEST_LENGTH) {
            break;
        }
        one_piece->line += leaves; /* the speed is at the corner and goes on beyond it */
        one_piece->bearing_line += passes;
        one_piece->collocated = 0.0;
    }
    one_piece->leaves = leaves;
    if (c->pieces.is_eventful) {
        one_piece_find_event(unit, length);
        one_piece->leaves = one_piece->event != NO_EVENT ? 0.0 : one_piece->leaves;
    }
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
    if (!c->pieces.is_made && one_piece_make(unit)) { /* the state is a restored one */
        return 1;
    }
    if (c->course->one_piece.stands == 0.0 && finish(unit)) {
        return 1;
    }
    begin_step(unit);
    return refuse_unbounded(unit);
}

static int fail_as_too_fast(Unit *unit)
{
    const Clock *clock = &((const Composite *)unit->own)->course->clock;
    return unit_fail(unit, "the motion at t = %6 s is not finite, or too fast for the time to go on",
                     unit_host_time(unit, clock->begin));
}

/* Begin the next step behind the events where it begins; its length in the machine's time and its end.
   1 with the reason. */
static int open_step(Unit *unit, double *length, double *end)
{
    const Composite *c = unit->own;
    Course *course = c->course;
    const Machine *m = &c->pieces.step;
    int k;
    if (begin_next(unit)) {
        return 1;
    }
    for (k = 0; k < MOST_EVENTS_AT_ONCE; k++) {
        if ((c->pieces.is_eventful && one_piece_meet(unit)) || choose_length(unit, length)) {
            return 1;
        }
        *end = course->clock.begin + *length * m->per_rate;
        if (*end > course->clock.begin) {
            return 0;
        }
        if (course->one_piece.event == NO_EVENT) {
            return fail_as_too_fast(unit);
        }
        if (course->one_piece.event == SPRING_ENDS) {
            return fail_as_beyond(unit);
        }
        one_piece_pass_event(unit);
        begin_step(unit);
    }
    /* what the event changes is less than rounding: a step that the time can show goes beyond it */
    *end = course->clock.begin + SHORTEST_STEP * (absolute(course->clock.begin) + m->per_rate);
    *length = (*end - course->clock.begin) * m->rate;
    return 0;
}

bool one_piece_is_crowded(const Composite *c)
{
    const Clock *clock = &c->course->clock;
    return clock->length <= CROWDED_STEP * (absolute(clock->begin) + c->pieces.step.per_rate);
}

/* 1 with the reason where too many steps in a row have been as short as this one. */
static int refuse_crowded(Unit *unit)
{
    const Composite *c = unit->own;
    OnePiece *one_piece = &c->course->one_piece;
    one_piece->crowded = one_piece_is_crowded(c) ? one_piece->crowded + 1.0 : 0.0;
    return one_piece->crowded >= MOST_CROWDED &&
           unit_fail(unit, "the machine cannot go on at t = %6 s: events follow each other too closely",
                     unit_host_time(unit, c->course->clock.begin));
}

int one_piece_prepare(Unit *unit, double *angle, bool *is_wanted)
{
    Pieces *pieces = &((Composite *)unit->own)->pieces;
    pieces->is_begun = *is_wanted = false;
    if (one_piece_is_eventful(unit->own) || pieces->rings || pieces->step.restraints ||
        composite_rotor(unit->own)->rotor.bearings.count) {
        return 0; /* it goes on alone */
    }
    if (begin_next(unit)) {
        return 1;
    }
    pieces->is_begun = true;
    return one_piece_load_step(unit, angle, is_wanted);
}

double one_piece_choose_looks(const Composite *c, double length)
{
    const double turned = machine_turned(&c->pieces.step, one_piece_order(c), length);
    return larger(FEWEST_LOOKS_OF_STEP, nearest(absolute(turned) / TAU * FEWEST_LOOKS + 0.5));
}

void one_piece_count_step(Unit *unit)
{
    Course *course = ((const Composite *)unit->own)->course;
    Totals *total = &course->total;
    total->passes += (double)((int)course->one_piece.looks / LOOKS_OF_PASS); /* they take time as passes do */
    total->steps += 1.0;
    total->error += one_piece_step_tolerance(unit);
}

bool one_piece_is_too_fast(const Composite *c, double fastest)
{
    return !(fastest <= MOST_MOTION * (c->pieces.shortest * c->course->drive.fastest));
}

int one_piece_step(Unit *unit)
{
    const Composite *c = unit->own;
    Course *course = c->course;
    OnePiece *one_piece = &course->one_piece;
    double length, end;
    if (open_step(unit, &length, &end)) {
        return 1;
    }
    course->clock.time = end;
    course->clock.length = end - course->clock.begin; /* rounded as the time is */
    if (refuse_crowded(unit)) {
        return 1;
    }
    one_piece->looks = one_piece_choose_looks(c, length);
    if (!(one_piece->looks <= MOST_LOOKS)) {
        return fail_as_too_fast(unit);
    }
    if (one_piece_is_unwatched(unit)) {
        one_piece->looked = one_piece->looks;
    }
    one_piece->collocated_steps += one_piece->collocated > 0.0;
    one_piece_count_step(unit);
    return 0;
}
