/* The composite's own equations: parameters, begin, step, outputs, observe. */
#include "coupling/composite.h"

#include <string.h>

#include "base/elementary.h"
#include "base/matrix.h"
#include "constants.h"

/* Parts of a step and of a time: within them a point of the host is the end of a step; and of the
   speed: what differs less is no jump. */
static const double REACHED_OF_STEP = 1e-10, REACHED_OF_TIME = 4e-16, SAME_SPEED = 1e-9;
static const double MOST_STEPS = 1e8, MOST_MOVES = 1e7; /* within a step of the host: of the coupling, and of parts */
static const double LOOSEST = 0.1; /* tolerance */
static const size_t REMADE = (size_t)-1; /* changes that a rotor is made with which is to be made anew */

/* -- memory ---------------------------------------------------------------------------------- */

static size_t signal_doubles(size_t count)
{
    return count * sizeof(Signal) / sizeof(double);
}

size_t composite_memory(Composite *c, double *memory)
{
    enum { BLOCKS = 13 };
    const size_t e = (size_t)c->unknowns, p = (size_t)c->planes, outer = outside_count(c);
    const size_t square = UNKNOWN_REALS * UNKNOWN_REALS * e * e;
    const size_t counts[BLOCKS] = {
        sizeof(Course) / sizeof(double), outer, signal_doubles(e), signal_doubles(p),
        square, square, p * sizeof(Swung) / sizeof(double), c->state_count,
        c->state_count, verdict_doubles(c), outer, one_piece_phase_doubles(c), c->state_count};
    size_t at[BLOCKS], total = 0, state;
    int k;
    for (k = 0; k < BLOCKS; k++) {
        at[k] = total;
        total += counts[k];
    }
    state = at[BLOCKS - 1];
    for (k = 0; k < c->part_count; k++) {
        Unit *part = c->parts[k].unit;
        if (memory) {
            part->memory = memory + state;
            part->real = memory + total;
        }
        state += part->memory_count;
        total += part->layout.real_count;
    }
    if (memory) {
        c->course = (Course *)memory;
        c->outer_forces = memory + at[1];
        c->forces = (Signal *)(memory + at[2]);
        c->accelerations = (Signal *)(memory + at[3]);
        c->learned = memory + at[4];
        c->solution = memory + at[5];
        c->swung = (Swung *)(memory + at[6]);
        c->at_begin = memory + at[7];
        c->at_end = memory + at[8];
        c->extent = memory + at[9];
        c->pieces.begun_forces = memory + at[10];
        c->pieces.phases = memory + at[11];
        c->states = memory + at[12];
    }
    return total;
}

static int composite_allocate(Unit *unit)
{
    Composite *c = unit->own;
    const size_t e = (size_t)c->unknowns, p = (size_t)c->planes;
    const size_t n = UNKNOWN_REALS * e, square = n * n;
    const size_t stations = (size_t)c->parts->unit->layout.sizes.stations;
    double **vectors[] = {&c->u, &c->g_u, &c->moved, &c->disturbed_answers, &c->residual, &c->du, &c->old};
    size_t k;
    int missing = 0;
    composite_memory(c, unit->memory);
    missing |= impacts_allocate(unit) || one_piece_allocate(unit);
    for (k = 0; k < sizeof vectors / sizeof *vectors; k++) {
        *vectors[k] = unit_allocate(unit, n, sizeof(double));
        missing |= !*vectors[k];
    }
    c->sent = unit_allocate(unit, SIGNAL_ORDERS * e, sizeof(Complex));
    c->plane_signals = unit_allocate(unit, SIGNAL_ORDERS * p, sizeof(Complex));
    c->ends = unit_allocate(unit, p, sizeof(Knot));
    c->answers = unit_allocate(unit, e, sizeof(Knot));
    c->square = unit_allocate(unit, square, sizeof(double));
    c->work = unit_allocate(unit, 2 * square, sizeof(double));
    c->masses = unit_allocate(unit, (size_t)c->parts->unit->layout.sizes.planes, sizeof(double));
    c->decay = unit_allocate(unit, 32 * stations * stations, sizeof(double));
    for (k = 0; k < (size_t)c->part_count; k++) {
        c->real_count += c->parts[k].unit->layout.real_count;
    }
    c->saved_reals = unit_allocate(unit, c->real_count, sizeof(double));
    return missing || !c->sent || !c->plane_signals || !c->ends || !c->answers ||
           !c->square || !c->work || !c->decay || !c->saved_reals || !c->masses;
}

/* -- the start ------------------------------------------------------------------------------- */

/* Let the one of tolerance and steps count that a host has set; the other is 0 then, which is what a
   host reads.  The tolerance of the experiment counts where it has set neither. */
static void choose_given(Unit *unit)
{
    const Composite *c = unit->own;
    const size_t given[] = {c->tolerance, c->steps_per_rev};
    int k, as_built = 1;
    for (k = 0; k < 2; k++) {
        as_built &= unit->real[given[k]] == unit->starts[given[k]];
    }
    if (unit->asks_tolerance && as_built) {
        unit->real[c->tolerance] = unit->tolerance;
        unit->real[c->steps_per_rev] = 0.0;
    }
    for (k = 0; k < 2 && unit->real[c->tolerance] > 0.0; k++) {
        if (unit->real[given[1 - k]] > 0.0 && unit->real[given[k]] == unit->starts[given[k]]) {
            unit->real[given[k]] = 0.0;
        }
    }
}

static int composite_parameters(Unit *unit)
{
    Composite *c = unit->own;
    double steps;
    int k;
    choose_given(unit);
    steps = unit->real[c->steps_per_rev];
    if ((unit->real[c->tolerance] > 0.0) == (steps > 0.0)) {
        return unit_fail(unit, "coupling.tolerance, coupling.steps_per_rev: one must be above 0; "
                         "set only that one");
    }
    if (steps > 0.0 && !(steps >= FEWEST_STEPS)) {
        return unit_fail(unit, "coupling.steps_per_rev: must be 0 (not used) or at least 4");
    }
    if (unit->real[c->tolerance] > LOOSEST) {
        return unit_fail(unit, "coupling.tolerance: must be at most 0.1");
    }
    for (k = 0; k < c->part_count; k++) {
        Part *part = c->parts + k;
        Unit *own = part->unit;
        composite_give_parameters(unit, part);
        if (own->equations->parameters(own)) {
            return composite_part_failed(unit, part);
        }
    }
    c->made_with = 0;
    c->pieces.is_made = false;
    return (unit->for_model_exchange && composite_refuse_events(unit)) || composite_follow_changes(unit);
}

static int composite_begin(Unit *unit)
{
    ((Composite *)unit->own)->course->clock.started = 0.0;
    return 0;
}

/* Take over speed and forces as the host has set them. */
static void take_inputs(Unit *unit)
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

/* All parts at their start, and the balancers' masses on the rotor. */
static int begin_parts(Unit *unit)
{
    Composite *c = unit->own;
    Unit *rotor = c->parts->unit;
    int k;
    if (impacts_prepare(unit)) {
        return 1;
    }
    for (k = 0; k < c->part_count; k++) {
        Unit *part = c->parts[k].unit;
        const Range inputs = part->layout.inputs;
        if (c->parts[k].brief >= 0) {
            /* more than the longest brief step, so that none ends early */
            part->real[c->parts[k].brief] = 1.5 * brief_length(unit);
        }
        memcpy(part->real + inputs.first, part->starts + inputs.first,
               inputs.count * sizeof(double));
        if (part->equations->begin(part)) {
            return composite_part_failed(unit, c->parts + k);
        }
    }
    composite_drive(unit, unit->time);
    if (c->motor && shaft_begin(unit)) {
        return 1;
    }
    for (k = 1; k < c->parts_without_motor; k++) {
        Unit *part = c->parts[k].unit;
        double *carried = rotor->real + rotor->layout.inputs.first + c->parts[k].plane;
        composite_place(c, c->parts + k);
        if (part->equations->outputs(part)) {
            return composite_part_failed(unit, c->parts + k);
        }
        *carried += part->real[layout_index(&part->layout, "added_mass", 1)];
    }
    return 0;
}

/* The scheme for this loop, its Jacobian in c->square. */
static void begin_scheme(Unit *unit)
{
    Composite *c = unit->own;
    Course *course = c->course;
    course->loop.corrections = c->corrections;
    if (c->corrections < 0 && c->scheme == SCHEME_AUTO && course->loop.gain <= WEAK_LOOP) {
        course->loop.corrections = 1.0;
    }
    iterated_begin(c);
}

/* Look out for the next change of the unbalance; 1 with the reason. */
static int await_change(Unit *unit)
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
static int begin_drive(Unit *unit)
{
    const Composite *c = unit->own;
    const double *corner = unit->real + c->rise;
    DriveSignal *drive = &c->course->drive;
    double time = *corner++, speed;
    size_t k;
    drive->speed = drive->first_speed = unit->real[c->speed_input];
    drive->acceleration = drive->first_acceleration = unit->real[c->speed_input + 1];
    drive->steepest = absolute(drive->acceleration);
    drive->next_corner = NONE_AHEAD;
    if (await_change(unit)) {
        return 1;
    }
    if (!(time > 0.0)) {
        return 0;
    }
    drive->next_corner = time;
    speed = drive->speed + time * drive->acceleration;
    drive->fastest = larger(drive->fastest, absolute(speed));
    for (k = 0; k < c->corner_count && corner[0] > 0.0; k++, corner += 2) {
        if (!(corner[0] > time)) {
            return unit_fail(unit, "corner[k].time: must ascend, from above rise_time on; 0 s: not "
                             "used, nor those behind");
        }
        drive->steepest = larger(drive->steepest, absolute((corner[1] - speed) / (corner[0] - time)));
        drive->fastest = larger(drive->fastest, corner[1]);
        time = corner[0];
        speed = corner[1];
    }
    return 0;
}

static int started(Unit *unit)
{
    Composite *c = unit->own;
    verdict_begin(c);
    c->course->clock.started = 1.0;
    return 0;
}

static int start(Unit *unit)
{
    Composite *c = unit->own;
    Course *course = c->course;
    memset(course, 0, sizeof *course);
    memset(c->forces, 0, (size_t)c->unknowns * sizeof(Signal));
    memset(c->accelerations, 0, (size_t)c->planes * sizeof(Signal));
    course->drive.fastest = unit->real[c->top_speed];
    course->drive.next_corner = course->drive.next_change = NONE_AHEAD;
    course->clock.begin = course->clock.time = course->drive.set_at = unit->time;
    if (!c->motor && begin_drive(unit)) {
        return 1;
    }
    take_inputs(unit);
    if (!(course->drive.fastest > 0.0)) {
        return unit_fail(unit, "coupling.top_speed: must be above 0 rad/s for a rotor that starts "
                         "at rest");
    }
    if (begin_parts(unit)) {
        return 1;
    }
    if (one_piece_covers(unit)) {
        if (one_piece_begin(unit)) {
            return 1;
        }
        return started(unit);
    }
    course->loop.rounding = FORCE_ROUNDING * composite_largest_force(c);
    if (loop_consistent_start(unit, communication_length(unit))) {
        return 1;
    }
    begin_scheme(unit);
    resolution_begin(unit);
    course->adaptive.allowed = c->unknowns ? unit->real[c->tolerance] : 0.0;
    if (course->adaptive.allowed > 0.0) {
        adaptive_begin(unit);
    }
    return started(unit);
}

/* -- steps ----------------------------------------------------------------------------------- */

/* Begin a step at a time where the units are, and where something has jumped; 1 with the reason. */
static int begin_anew(Unit *unit, double time)
{
    Composite *c = unit->own;
    Course *course = c->course;
    int k;
    if (course->one_piece.active > 0.0) {
        course->clock.time = time;
        return one_piece_begin_anew(unit);
    }
    if (course->clock.within > 0.0) {
        composite_read_accelerations(c, c->ends);
        composite_read_forces(c, c->answers);
        for (k = 0; k < c->planes; k++) {
            c->accelerations[k].now = c->ends[k];
        }
        for (k = 0; k < c->force_count; k++) {
            c->forces[k].now = c->answers[k];
        }
        if (c->motor) {
            c->forces[c->force_count].now = shaft_stand(c);
        }
        course->clock.within = 0.0;
    }
    course->clock.time = time;
    course->division.crossing = course->division.length = course->event.steps_left = 0.0;
    course->clock.jumped = 1.0;
    composite_drop_past(c);
    return 0;
}

/* Another unbalance of the rotor from now on. */
static int composite_tune(Unit *unit)
{
    Composite *c = unit->own;
    if (c->course->clock.started > 0.0 && !unit->for_model_exchange) {
        if (begin_anew(unit, unit->time)) {
            return 1;
        }
    }
    c->made_with = REMADE;
    return composite_follow_changes(unit);
}

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
        take_inputs(unit);
    }
    return jumps && begin_anew(unit, unit->time);
}

/* Take over inputs and state that the host has set; 1 with the reason where it may not. */
int composite_meet_host(Unit *unit)
{
    const Composite *c = unit->own;
    if (c->motor && outside_jumps(unit)) {
        take_inputs(unit);
        if (begin_anew(unit, unit->time)) {
            return 1;
        }
    } else if (!c->motor && meet_inputs(unit)) {
        return 1;
    }
    return composite_follow_changes(unit);
}

/* Bring forces and accelerations into agreement at the time, inputs and states of model exchange. */
static int agree(Unit *unit)
{
    Composite *c = unit->own;
    int k;
    if (composite_meet_host(unit)) {
        return 1;
    }
    c->course->clock.time = unit->time;
    composite_drive(unit, unit->time);
    if (c->course->one_piece.active > 0.0) {
        return one_piece_signals(unit);
    }
    if (c->motor && shaft_begin(unit)) {
        return 1;
    }
    for (k = 1; k < c->parts_without_motor; k++) {
        Unit *part = c->parts[k].unit;
        composite_place(c, c->parts + k);
        if (part->equations->outputs(part)) {
            return composite_part_failed(unit, c->parts + k);
        }
    }
    return loop_consistent_start(unit, communication_length(unit));
}

static int composite_outputs(Unit *unit)
{
    const Composite *c = unit->own;
    if (!(c->course->clock.started > 0.0)) {
        if (start(unit)) {
            return 1;
        }
        memcpy(c->at_begin, c->states, c->state_count * sizeof(double));
    }
    return unit->for_model_exchange && agree(unit);
}

/* With a tolerance nothing is left to be estimated. */
static int judge_step(Unit *unit, double step)
{
    const Course *course = ((Composite *)unit->own)->course;
    return (course->adaptive.allowed == 0.0 && resolution_check(unit, step)) || iterated_judge(unit);
}

/* One step of given length; `jump`: over a jump of an input. */
static int couple(Unit *unit, double step, int jump)
{
    const Composite *c = unit->own;
    if (jump) {
        return iterated_cross(unit, step);
    }
    if (iterated_step(unit, step)) {
        return 1;
    }
    return c->unknowns && c->course->event.steps_left == 0.0 && judge_step(unit, c->course->clock.length);
}

/* One step of the length that a tolerance allows, or that a run prescribes. */
static int adapt(Unit *unit)
{
    const Composite *c = unit->own;
    const double longest = c->pacing.longest;
    if (!c->pacing.points) {
        return adaptive_step(unit, longest > 0.0 ? longest
                                                 : step_of_revolution(unit, FEWEST_CHOSEN));
    }
    return prescribed_step(unit) || (c->course->event.steps_left == 0.0 && iterated_judge(unit));
}

/* A step that an event has cut into several is judged behind it. */
static int strike(Unit *unit)
{
    const Composite *c = unit->own;
    Course *course = c->course;
    if (contacts_step(unit)) {
        return 1;
    }
    if (course->event.steps_left > 0.0) {
        return 0;
    }
    course->loop.residual = course->event.worst;
    return (course->adaptive.allowed == 0.0 || c->pacing.points) &&
           judge_step(unit, course->clock.time + course->clock.length - course->event.begun_at);
}

int composite_go_on(Unit *unit)
{
    Composite *c = unit->own;
    Course *course = c->course;
    const size_t size = c->state_count * sizeof(double);
    const int crosses = course->clock.jumped > 0.0 || course->division.crossing > 0.0;
    const int strikes = course->event.steps_left > 0.0 && !crosses;
    const int adapts = course->adaptive.allowed > 0.0 && !crosses && !strikes;
    double step;
    if (course->one_piece.active > 0.0) {
        return one_piece_step(unit);
    }
    step = adapts || strikes ? 0.0 : startup_length(unit);
    if (course->clock.within > 0.0) {
        memcpy(c->states, c->at_end, size);
        course->clock.within = 0.0;
    }
    memcpy(c->at_begin, c->states, size);
    course->clock.begin = course->clock.time;
    course->clock.length = step;
    course->adaptive.constant_signals = 0.0;
    composite_drive(unit, course->clock.begin);
    if (strikes  ? strike(unit)
        : adapts ? adapt(unit)
                 : couple(unit, step, crosses)) {
        return 1;
    }
    if (composite_follow(unit, course->clock.length)) {
        return 1;
    }
    course->clock.time += course->clock.length;
    verdict_follow(c, c->motor ? shaft_speed(c) : composite_speed(c, course->clock.time), course->clock.length);
    course->total.steps += crosses || strikes ? 0.0 : 1.0;
    return adapts ? 0 : startup_taken(unit, strikes);
}

/* Move the units to a time within the last step, or to its end, under its signals. */
static int show_time(Unit *unit, double time, int end)
{
    Composite *c = unit->own;
    Course *course = c->course;
    Rotor *rotor = composite_rotor(c);
    const size_t size = c->state_count * sizeof(double);
    /* under signals that do not change they can go on from where they stand */
    const int goes_on = course->clock.within > 0.0 && course->adaptive.constant_signals > 0.0 && !end &&
                        course->drive.acceleration == 0.0 && !c->motor && time >= course->clock.shown;
    double from = course->clock.begin;
    int wrong;
    if (course->one_piece.active > 0.0) {
        return one_piece_show(unit, time);
    }
    if (end && course->clock.within == 0.0) {
        return 0;
    }
    if (course->clock.within == 0.0) {
        memcpy(c->at_end, c->states, size);
    }
    if (goes_on) {
        from = course->clock.shown;
    } else {
        memcpy(c->states, c->at_begin, size);
    }
    course->clock.within = end ? 0.0 : 1.0;
    course->clock.shown = time;
    rotor->enclosing_step = end                                       ? 0.0
                            : course->adaptive.constant_signals > 0.0 ? time - from
                                                                      : course->clock.length;
    wrong = composite_move(unit, end ? course->clock.length : time - from);
    rotor->enclosing_step = 0.0;
    return wrong;
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
        if (await_change(unit)) {
            return 1;
        }
    }
    return begin_anew(unit, time) || composite_follow_changes(unit);
}

bool composite_reaches(const Composite *c, double time)
{
    const Clock *clock = &c->course->clock;
    const double point = REACHED_OF_STEP * clock->length + REACHED_OF_TIME * absolute(time);
    return !(clock->time < time - point);
}

int composite_refuse_many(Unit *unit, double passes, double length)
{
    const Composite *c = unit->own;
    if (c->course->total.passes - passes <= MOST_MOVES / c->part_count) {
        return 0;
    }
    return unit_fail(unit, "a step of %6 s takes too many steps of the coupling: one call may move all parts "
                     "together 1e7 times; use shorter communication steps", length);
}

/* Step and move the units to a time. */
static int reach_time(Unit *unit, double end)
{
    const Composite *c = unit->own;
    const Course *course = c->course;
    const double begin = unit->time, passes = course->total.passes;
    for (;;) {
        if (composite_reaches(c, end)) {
            const double point = REACHED_OF_STEP * course->clock.length + REACHED_OF_TIME * absolute(end);
            return show_time(unit, end, course->clock.time <= end + point);
        }
        if (unit->one_step_per_call && course->clock.time > begin) {
            unit->made = course->clock.time - begin;
            return show_time(unit, course->clock.time, 1);
        }
        if (composite_refuse_many(unit, passes, end - begin)) {
            return 1;
        }
        if (composite_go_on(unit)) {
            composite_put_gain(unit);
            return 1;
        }
    }
}

/* 1 with the reason where the units do not stand at the unit's time: a step would first have to reach it. */
static int stands_elsewhere(Unit *unit)
{
    const Clock *clock = &((const Composite *)unit->own)->course->clock;
    if (clock->started > 0.0 && !(unit->time >= clock->begin - clock->length &&
                                  unit->time <= clock->time + clock->length)) {
        return unit_fail(unit, "the state that was restored has the time %6 s, its motion stands at %6 s",
                         unit_host_time(unit, unit->time), unit_host_time(unit, clock->time));
    }
    return 0;
}

int composite_go_to(Unit *unit, double end)
{
    const Composite *c = unit->own;
    while (composite_next_jump(c) <= end) {
        const double jump = composite_next_jump(c);
        const unsigned *asked = unit->asked;
        int wrong;
        unit->asked = NULL; /* steps begin there: all units must be */
        wrong = reach_time(unit, jump);
        unit->asked = asked;
        if (wrong) {
            return 1;
        }
        if (unit->one_step_per_call) {
            if (unit->made < jump - unit->time) { /* of the way there one step, and not its last */
                return 0;
            }
            unit->made = jump - unit->time;
        }
        if (composite_pass_jump(unit)) {
            return 1;
        }
        if (jump == end || unit->one_step_per_call) {
            return 0;
        }
    }
    return reach_time(unit, end);
}

static int composite_step_unit(Unit *unit, double length)
{
    const double end = unit->time + length;
    if (stands_elsewhere(unit) || composite_meet_host(unit)) { /* the state may be one that was restored */
        return 1;
    }
    if (!(length < MOST_STEPS * communication_length(unit))) {
        return unit_fail(unit, "the coupling's steps of %3 s are too short for it: speed, "
                         "coupling.top_speed and coupling.steps_per_rev must leave at most 1e8 of "
                         "them", communication_length(unit));
    }
    return composite_go_to(unit, end);
}

static void show_outputs(Unit *unit, const Part *part)
{
    const size_t first = part->unit->layout.computed.first;
    memcpy(unit->real + part->observed, part->unit->real + first,
           (part->unit->layout.real_count - first) * sizeof(double));
}

static void observe_results(Unit *unit)
{
    const Composite *c = unit->own;
    double *results = unit->real + c->results;
    results[0] = c->motor ? shaft_speed(c)
                          : composite_speed(c, unit->time);
    results[1] = c->course->loop.gain;
    results[2] = c->course->total.steps;
    results[3] = c->course->total.error;
    results[4] = c->course->total.unconverged;
    results[VIBRATION] = verdict_vibration(c);
    verdict_unbalance(c, results + RESIDUAL, results + RESIDUAL + 1);
}

/* Let the parts of a machine in one piece stand where outputs of this kind can be read; 1 with the reason. */
static int stand_for(Unit *unit, OutputKind kind)
{
    const Composite *c = unit->own;
    switch (kind) {
    case OUTPUTS_ARE_PLACES:
        return one_piece_observe_places(unit);
    case OUTPUTS_OF_STATE:
        return one_piece_place(unit) || one_piece_place_followers(unit, c->parts->unit->memory + MOTION, unit->time);
    default:
        return one_piece_signals(unit);
    }
}

static void composite_observe(Unit *unit)
{
    const Composite *c = unit->own;
    const int one_piece = c->course->one_piece.active > 0.0;
    const OutputKind kind = one_piece ? one_piece_outputs(unit) : OUTPUTS_OF_SIGNALS;
    int k;
    if (one_piece && stand_for(unit, kind)) {
        fill_doubles(unit->layout.observed.count, not_a_number(), unit->real + unit->layout.observed.first);
        return;
    }
    for (k = 0; k < c->part_count && kind != OUTPUTS_ARE_PLACES; k++) {
        if (composite_asked(unit, c->parts + k)) {
            c->parts[k].unit->equations->observe(c->parts[k].unit);
            show_outputs(unit, c->parts + k);
        }
    }
    if (kind == OUTPUTS_OF_SIGNALS) {
        observe_results(unit);
    }
}

static void composite_observe_torques(Unit *unit)
{
    const Composite *c = unit->own;
    int k;
    for (k = 0; k < c->part_count; k++) {
        Unit *part = c->parts[k].unit;
        if (part->equations->observe_torques && composite_asked(unit, c->parts + k)) {
            part->equations->observe_torques(part);
            show_outputs(unit, c->parts + k);
        }
    }
}

static bool composite_is_torque(const Unit *unit, size_t reference)
{
    const Composite *c = unit->own;
    int k;
    for (k = 0; k < c->part_count; k++) {
        const Unit *part = c->parts[k].unit;
        const size_t output = reference - c->parts[k].observed + part->layout.computed.first;
        if (reference >= c->parts[k].observed && output < part->layout.real_count) {
            return part->equations->is_torque && part->equations->is_torque(part, output);
        }
    }
    return 0;
}

/* Inputs that are cubics: forces from outside. */
static size_t composite_signals(const Layout *layout, size_t *first)
{
    *first = layout_index(layout, "rotor.plane[#].F_x", 1);
    return 2 * (size_t)layout->sizes.planes;
}

static int composite_verdict(const Unit *unit)
{
    const Composite *c = unit->own;
    return c->course->vibration.last > 0.0 && unit->real[c->results + VIBRATION] <= unit->real[c->limit];
}

const Equations COMPOSITE_EQUATIONS = {
    .name = "Composite", .fields = composite_fields, .allocate = composite_allocate,
    .parameters = composite_parameters, .untunable = composite_untunable, .tune = composite_tune, .begin = composite_begin, .step = composite_step_unit,
    .outputs = composite_outputs, .observe = composite_observe,
    .observe_torques = composite_observe_torques, .is_torque = composite_is_torque,
    .signals = composite_signals, .verdict = composite_verdict};
