/* Steps in one piece, and the motion within them. */
#include <string.h>

#include "base/elementary.h"
#include "constants.h"
#include "coupling/composite.h"

enum { FEWEST_LOOKS_OF_STEP = 8 };
#define SHORTEST_LENGTH 1e-12 /* of a step to a corner: less is none */
#define TIGHTEST 1e-17 /* tolerance of a step: less is rounding */

static const double *state_of(const Composite *c, const Part *part, const double *states)
{
    return states + (part->unit->memory - c->states);
}

/* -- the series of the present step ---------------------------------------------------------- */

static double step_tolerance(const Unit *unit)
{
    const Composite *c = unit->own;
    const double share = c->pieces.share > 0.0 ? c->pieces.share : 1.0;
    const double tolerance = unit->real[c->tolerance] > 0.0 ? unit->real[c->tolerance] : 1.0;
    return larger(TIGHTEST, SERIES_SHARE * share * tolerance);
}

/* Order of the step that is shown. */
static int order_of(const Composite *c)
{
    const int order = (int)c->course->one_piece.order;
    return order < LEAST_ORDER ? LEAST_ORDER : order;
}

void one_piece_set_line(Machine *m, int line)
{
    MachineDrive *drive = &m->drive;
    const double *point = drive->motor->points + 2 * (line > 0 ? line : 0), t = m->per_rate;
    const double slope = (point[3] - point[1]) / (point[2] - point[0]);
    drive->slope = slope * t;
    drive->torque = (point[1] - slope * point[0]) * t * t;
}

double one_piece_load(const Composite *c, Machine *m, const double *states, double speed, double acceleration)
{
    const double *rotor = state_of(c, c->parts, states), *place = rotor + MOTION;
    const int n = m->stations;
    int k, w, i = 0;
    for (k = 0; k < n; k++) {
        m->motion[k] = pair_of(place[2 * k], place[2 * k + 1]);
        m->velocity[k] = pair_of(place[2 * n + 2 * k], place[2 * n + 2 * k + 1]);
        m->velocity[k] = pair_scaled(m->velocity[k], m->per_rate);
    }
    for (k = 1; k < c->parts_without_motor; k++) {
        const Balls *balls = part_balls(c->parts + k);
        const double *angles = state_of(c, c->parts + k, states);
        for (w = 0; balls && w < balls->count; w++, i++) {
            pair_set(&m->motion[n + i / 2], i % 2, angles[w]);
            pair_set(&m->velocity[n + i / 2], i % 2, angles[balls->count + w] * m->per_rate);
        }
    }
    m->speed[0] = speed * m->per_rate;
    m->speed[1] = acceleration * m->per_rate * m->per_rate;
    return rotor[REST];
}

void one_piece_push(const Composite *c, Machine *m, const double *forces, double time)
{
    const LinearRotor *rotor = &composite_rotor(c)->rotor;
    const int n = m->stations, planes = rotor->plane_count;
    double power = m->per_rate * m->per_rate;
    int i, k, order;
    for (order = 0; order < SIGNAL_ORDERS; order++, power *= m->per_rate / order) {
        for (i = 0; i < n; i++) {
            m->push[order * n + i] = pair_of(0.0, 0.0);
        }
        for (k = 0; k < planes; k++) {
            const Pair force = outside_derivative(c, forces, k, order, time);
            for (i = 0; i < n; i++) {
                m->push[order * n + i] =
                    pair_add_scaled(m->push[order * n + i], force, rotor->planes[k * n + i] * power);
            }
        }
    }
}

/* Make the series of the present step where there is none; 1 with the reason. */
static int expand(Unit *unit)
{
    Composite *c = unit->own;
    Pieces *pieces = &c->pieces;
    const OnePiece *one_piece = &c->course->one_piece;
    const size_t forces = outside_count(c);
    double *key = pieces->wanted, angle;
    if (!pieces->is_made && one_piece_make(unit)) {
        return 1;
    }
    *key++ = one_piece->speed;
    *key++ = one_piece->acceleration;
    *key++ = one_piece->changes_behind;
    *key++ = one_piece->line;
    *key++ = one_piece->order;
    *key++ = one_piece->pushed;
    memcpy(key, pieces->begun_forces, forces * sizeof(double));
    memcpy(key + forces, c->at_begin, c->state_count * sizeof(double));
    if (!memcmp(pieces->wanted, pieces->key, pieces->key_count * sizeof(double))) {
        return 0;
    }
    if (one_piece->changes_behind != (double)c->made_with &&
        one_piece_make(unit)) { /* the state is a restored one */
        return 1;
    }
    memcpy(pieces->key, pieces->wanted, pieces->key_count * sizeof(double));
    one_piece_push(c, &pieces->step, pieces->begun_forces, one_piece->pushed);
    angle =
        one_piece_load(c, &pieces->step, c->at_begin, one_piece->speed, one_piece->acceleration);
    if (c->motor) {
        one_piece_set_line(&pieces->step, (int)one_piece->line);
    }
    machine_expand(&pieces->step, angle, order_of(c));
    c->course->total.passes += 1.0;
    return 0;
}

/* -- places ------------------------------------------------------------------------------------- */

/* Let the parts stand at a time of the step, in the machine's [1]. */
static void stand_at(Unit *unit, double time)
{
    Composite *c = unit->own;
    Machine *m = &c->pieces.step;
    const int n = m->stations, width = m->width, order = order_of(c);
    const double speed = machine_speed_at(m, order, time) * m->rate, turned = machine_turned(m, order, time);
    double *rotor = c->parts->unit->memory, *place = rotor + MOTION;
    int k, w, i = 0;
    memcpy(c->states, c->at_begin, c->state_count * sizeof(double));
    angle_turn(rotor, turned);
    for (k = 0; k < n; k++) {
        const Pair displacement = machine_at(m->motion + k, width, order, time);
        const Pair velocity = pair_scaled(machine_at(m->velocity + k, width, order - 1, time), m->rate);
        place[2 * k] = pair_x(displacement);
        place[2 * k + 1] = pair_y(displacement);
        place[2 * n + 2 * k] = pair_x(velocity);
        place[2 * n + 2 * k + 1] = pair_y(velocity);
    }
    place[4 * n] = speed;
    place[4 * n + 1] = 0.0;
    for (k = 1; k < c->parts_without_motor; k++) {
        const Balls *balls = part_balls(c->parts + k);
        double *angles = c->parts[k].unit->memory;
        for (w = 0; balls && w < balls->count; w++, i++) {
            const int column = n + i / 2;
            angles[w] = pair_at(machine_at(m->motion + column, width, order, time), i % 2);
            angles[balls->count + w] =
                pair_at(machine_at(m->velocity + column, width, order - 1, time), i % 2) * m->rate;
        }
    }
    if (c->motor) {
        angle_turn(c->motor->unit->memory, turned);
        c->motor->unit->memory[ANGLE_SIZE] = speed;
        c->motor->unit->real[c->motor->unit->layout.computed.first + SPEED_OF_MOTOR] = speed;
    }
}

static double time_within(const Composite *c, double time)
{
    return (time - c->course->clock.begin) * c->pieces.step.rate;
}

int one_piece_place(Unit *unit)
{
    const Composite *c = unit->own;
    const Clock *clock = &c->course->clock;
    OnePiece *one_piece = &c->course->one_piece;
    if (one_piece->placed > 0.0) {
        return 0;
    }
    if (expand(unit)) {
        return 1;
    }
    stand_at(unit, time_within(c, clock->shown));
    one_piece->placed = 1.0;
    return 0;
}

int one_piece_places(Unit *unit, Pair *places)
{
    const Composite *c = unit->own;
    const Machine *m = &c->pieces.step;
    const double time = time_within(c, c->course->clock.shown);
    int k, order;
    if (expand(unit)) {
        return 1;
    }
    order = order_of(c);
    for (k = 0; k < m->width; k++) {
        places[k] = machine_at(m->motion + k, m->width, order, time);
    }
    return 0;
}

int one_piece_begin_anew(Unit *unit)
{
    OnePiece *one_piece = &((Composite *)unit->own)->course->one_piece;
    if (one_piece->stands == 0.0 && one_piece_place(unit)) {
        return 1;
    }
    one_piece->stands = 1.0;
    one_piece->line = -1.0;
    return 0;
}

/* -- what is watched as the motion goes on --------------------------------------------------------- */

/* Whether nobody reads what the looks would find. */
static bool is_unwatched(const Unit *unit)
{
    const Composite *c = unit->own;
    size_t k;
    for (k = 0; k < unit->asked_count && unit->asked; k++) {
        if (unit->asked[k] >= c->results) {
            return 0;
        }
    }
    return unit->asked && !c->pieces.followers;
}

/* Tell the units that follow their plane's place where it is; 1 with the reason. */
static int place_followers(Unit *unit, const double *place, double time)
{
    const Composite *c = unit->own;
    const Rotor *rotor = composite_rotor(c);
    int k;
    for (k = 1; k < c->parts_without_motor; k++) {
        const Part *part = c->parts + k;
        if (part->place >= 0) {
            combine_vectors(rotor->rotor.planes + part->plane * rotor->stations, 1, rotor->stations, place,
                            part->unit->real + part->place);
            part->unit->time = time;
            part->unit->start = unit->start;
            if (part->unit->equations->outputs(part->unit)) {
                return composite_part_failed(unit, part);
            }
        }
    }
    return 0;
}

/* Look at the motion up to a time in the step; 1 with the reason. */
static int look_on(Unit *unit, double time)
{
    Composite *c = unit->own;
    const Clock *clock = &c->course->clock;
    OnePiece *one_piece = &c->course->one_piece;
    const Machine *m = &c->pieces.step;
    const double apart = clock->length / one_piece->looks;
    double *place = c->pieces.looked_at, turned;
    int i, order;
    if (one_piece->looked >= one_piece->looks ||
        !(clock->begin + (one_piece->looked + 1.0) * apart <= time)) {
        return 0;
    }
    if (expand(unit)) {
        return 1;
    }
    order = order_of(c);
    turned = machine_turned(m, order, one_piece->looked * apart * m->rate);
    while (one_piece->looked < one_piece->looks &&
           clock->begin + (one_piece->looked + 1.0) * apart <= time) {
        const double now = ++one_piece->looked * apart * m->rate,
                     angle = machine_turned(m, order, now);
        for (i = 0; i < m->stations; i++) {
            const Pair displacement = machine_at(m->motion + i, m->width, order, now);
            place[2 * i] = pair_x(displacement);
            place[2 * i + 1] = pair_y(displacement);
        }
        verdict_look(c, place, angle - turned);
        turned = angle;
        if (c->pieces.followers &&
            place_followers(unit, place, clock->begin + one_piece->looked * apart)) {
            return 1;
        }
    }
    return 0;
}

int one_piece_show(Unit *unit, double time)
{
    const Composite *c = unit->own;
    Course *course = c->course;
    if (course->one_piece.stands > 0.0) { /* there, but for a rounding */
        return 0;
    }
    course->clock.within = 1.0;
    course->clock.shown = time;
    course->one_piece.placed = 0.0;
    return look_on(unit, time);
}

/* -- steps ----------------------------------------------------------------------------------------- */

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
    if (look_on(unit, infinity()) || expand(unit)) {
        return 1;
    }
    stand_at(unit, c->course->clock.length * c->pieces.step.rate);
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
    one_piece->order = machine_order(step_tolerance(unit));
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
        if (expand(unit)) {
            return 1;
        }
        *length = machine_length(m, order_of(c), step_tolerance(unit), one_piece->largest);
        if (!c->motor) {
            break;
        }
        ends_of_line(m, (int)one_piece->line, ends);
        leaves = machine_leaves_line(m, order_of(c), ends, length);
        if (!leaves || *length > SHORTEST_LENGTH) {
            break;
        }
        one_piece->line += leaves; /* the speed is at the corner and goes on beyond it */
    }
    one_piece->leaves = leaves;
    return 0;
}

int one_piece_step(Unit *unit)
{
    const Composite *c = unit->own;
    Course *course = c->course;
    OnePiece *one_piece = &course->one_piece;
    double length, end, turned;
    if (one_piece->stands == 0.0 && finish(unit)) {
        return 1;
    }
    begin_step(unit);
    if (choose_length(unit, &length)) {
        return 1;
    }
    end = course->clock.begin + length * c->pieces.step.per_rate;
    if (!(end > course->clock.begin)) {
        return unit_fail(unit, "the motion at t = %6 s is not finite, or too fast for the time to go on",
                         unit_host_time(unit, course->clock.begin));
    }
    course->clock.time = end;
    course->clock.length = end - course->clock.begin; /* rounded as the time is */
    turned = machine_turned(&c->pieces.step, order_of(c), length);
    one_piece->looks =
        larger(FEWEST_LOOKS_OF_STEP, nearest(absolute(turned) / TAU * FEWEST_LOOKS + 0.5));
    if (is_unwatched(unit)) {
        one_piece->looked = one_piece->looks;
    }
    course->total.steps += 1.0;
    course->total.error = step_tolerance(unit);
    return 0;
}
