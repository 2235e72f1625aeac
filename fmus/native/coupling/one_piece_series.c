/* The series of a step in one piece, and the motion that it describes. */
#include <string.h>

#include "base/elementary.h"
#include "constants.h"
#include "coupling/composite.h"

#define OF_LINEAR 1e-15 /* tolerance of a step of a rotor alone, which is cheap: its motion is right to rounding */
#define TIGHTEST 1e-17 /* tolerance of a step: less is rounding */

static const double *state_of(const Composite *c, const Part *part, const double *states)
{
    return states + (part->unit->memory - c->states);
}

/* -- the series of the present step ---------------------------------------------------------- */

double one_piece_step_tolerance(const Unit *unit)
{
    const Composite *c = unit->own;
    const double share = c->pieces.share > 0.0 ? c->pieces.share : 1.0;
    const bool is_linear = !c->force_count && !c->motor && !c->pieces.is_eventful && !c->pieces.step.restraints;
    return is_linear ? OF_LINEAR : larger(TIGHTEST, SERIES_SHARE * share * unit->real[c->tolerance]);
}

/* Order of the step that is shown. */
int one_piece_order(const Composite *c)
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
    const LinearRotor *matrices = &composite_rotor(c)->rotor;
    const int n = m->stations, own = n - m->waves;
    int k, w, i = 0;
    m->collocated_order = 0;
    if (m->varies) {
        const bool is_step = m == &c->pieces.step;
        machine_take_bearings(m, matrices, is_step ? (int)c->course->one_piece.bearing_line
                                                   : linear_rotor_line(matrices, speed, m->bearing_line));
    }
    for (k = 0; k < own; k++) {
        m->motion[k] = pair_of(place[2 * k], place[2 * k + 1]);
        m->velocity[k] = pair_of(place[2 * own + 2 * k], place[2 * own + 2 * k + 1]);
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
    if (m->waves) {
        one_piece_load_waves(c, m, states, rotor[REST]);
    }
    return rotor[REST];
}

void one_piece_push(const Composite *c, Machine *m, const double *forces, double time)
{
    const LinearRotor *rotor = &composite_rotor(c)->rotor;
    const int n = m->stations, own = rotor->stations, planes = rotor->plane_count;
    double power = m->per_rate * m->per_rate;
    bool is_pushed = false;
    int i, k, order;
    for (i = 0; i < (int)outside_count(c); i++) {
        is_pushed |= forces[i] != 0.0;
    }
    for (i = 0; i < SIGNAL_ORDERS * n; i++) {
        m->push[i] = pair_zero();
    }
    for (order = 0; order < SIGNAL_ORDERS && is_pushed; order++, power *= m->per_rate / order) {
        for (k = 0; k < planes; k++) {
            const Pair force = outside_derivative(c, forces, k, order, time);
            for (i = 0; i < own; i++) {
                m->push[order * n + i] =
                    pair_add_scaled(m->push[order * n + i], force, rotor->planes[k * own + i] * power);
            }
        }
    }
}

int one_piece_load_step(Unit *unit, double *angle, bool *is_wanted)
{
    Composite *c = unit->own;
    Pieces *pieces = &c->pieces;
    const OnePiece *one_piece = &c->course->one_piece;
    const size_t forces = outside_count(c);
    const double numbers[KEY_NUMBERS] = {
        one_piece->speed, one_piece->acceleration, one_piece->changes_behind, one_piece->line,
        one_piece->bearing_line, one_piece->order, one_piece->collocated, one_piece->pushed};
    double *of_forces = pieces->key + KEY_NUMBERS, *of_phases = of_forces + forces, *of_states;
    size_t phases;
    *is_wanted = false;
    if (!pieces->is_made && one_piece_make(unit)) {
        return 1;
    }
    if (!linear_rotor_holds(&composite_rotor(c)->rotor, one_piece->speed)) {
        const Bearings *b = &composite_rotor(c)->rotor.bearings;
        return unit_fail(unit, "speed = %6 rad/s at t = %6 s: must be %6 to %6 rad/s, the speeds of the bearings' table",
                         one_piece->speed, unit_host_time(unit, c->course->clock.begin), b->speeds[0],
                         b->speeds[b->speed_count - 1]);
    }
    phases = pieces->is_eventful ? one_piece_phase_doubles(c) : 0;
    of_states = of_phases + phases;
    if (!memcmp(numbers, pieces->key, sizeof numbers) &&
        !memcmp(pieces->begun_forces, of_forces, forces * sizeof(double)) &&
        !memcmp(pieces->phases, of_phases, phases * sizeof(double)) &&
        !memcmp(c->at_begin, of_states, c->state_count * sizeof(double))) {
        return 0;
    }
    if (one_piece->changes_behind != (double)c->made_with &&
        one_piece_make(unit)) { /* the state is a restored one */
        return 1;
    }
    memcpy(pieces->key, numbers, sizeof numbers);
    memcpy(of_forces, pieces->begun_forces, forces * sizeof(double));
    memcpy(of_phases, pieces->phases, phases * sizeof(double));
    memcpy(of_states, c->at_begin, c->state_count * sizeof(double));
    one_piece_push(c, &pieces->step, pieces->begun_forces, one_piece->pushed);
    *angle =
        one_piece_load(c, &pieces->step, c->at_begin, one_piece->speed, one_piece->acceleration);
    if (c->motor) {
        one_piece_set_line(&pieces->step, (int)one_piece->line);
    }
    if (pieces->is_eventful) {
        one_piece_load_phase(c, &pieces->step, c->at_begin);
    }
    *is_wanted = true;
    c->course->total.passes += 1.0;
    return 0;
}

void one_piece_load_collocation(Composite *c, double angle)
{
    machine_take_bearings(&c->pieces.instant, &composite_rotor(c)->rotor, (int)c->course->one_piece.bearing_line);
    collocation_start(&c->pieces.collocation, &c->pieces.step, &c->pieces.instant, angle);
}

double one_piece_solve(const Unit *unit, double length)
{
    Composite *c = unit->own;
    return collocation_solve(&c->pieces.collocation, length, one_piece_step_tolerance(unit), c->course->one_piece.largest);
}

void one_piece_write_collocation(Composite *c)
{
    collocation_write(&c->pieces.collocation, c->course->one_piece.collocated, &c->pieces.step);
}

int one_piece_expand(Unit *unit)
{
    Composite *c = unit->own;
    double angle;
    bool is_wanted;
    if (one_piece_load_step(unit, &angle, &is_wanted)) {
        return 1;
    }
    if (is_wanted && c->course->one_piece.collocated > 0.0) {
        one_piece_load_collocation(c, angle);
        one_piece_solve(unit, c->course->one_piece.collocated);
        one_piece_write_collocation(c);
    } else if (is_wanted) {
        machine_expand(&c->pieces.step, angle, one_piece_order(c));
    }
    return 0;
}

/* -- waves -------------------------------------------------------------------------------------- */

/* y = Y e^{i angle}, y' = (Y' + i w Y) e^{i angle}. */
void one_piece_load_waves(const Composite *c, Machine *m, const double *states, double angle)
{
    const Pair turn = pair_direction(angle);
    int k, i = m->stations - m->waves;
    for (k = 1; k < c->parts_without_motor; k++) {
        if (part_ring(c->parts + k)) {
            const double *memory = state_of(c, c->parts + k, states);
            const Pair wave = pair_of(memory[RING_WAVE], memory[RING_WAVE + 1]);
            const Pair rate = pair_scaled(pair_of(memory[RING_RATE], memory[RING_RATE + 1]), m->per_rate);
            m->motion[i] = pair_product(wave, turn);
            m->velocity[i] = pair_product(pair_add_scaled(rate, pair_turned(wave), m->speed[0]), turn);
            i++;
        }
    }
}

void one_piece_store_waves(const Composite *c, const Pair *waves, const Pair *rates, double angle, double speed)
{
    const Pair back = pair_direction(-angle);
    int k, i = 0;
    for (k = 1; k < c->parts_without_motor; k++) {
        if (part_ring(c->parts + k)) {
            double *memory = c->parts[k].unit->memory;
            const Pair wave = pair_product(waves[i], back);
            const Pair rate = pair_add_scaled(pair_product(rates[i], back), pair_turned(wave), -speed);
            memory[RING_WAVE] = pair_x(wave);
            memory[RING_WAVE + 1] = pair_y(wave);
            memory[RING_RATE] = pair_x(rate);
            memory[RING_RATE + 1] = pair_y(rate);
            memory[RING_SINCE] = 0.0;
            i++;
        }
    }
}

/* Let the waves stand where they are at a time of the step, in the machine's. */
static void stand_waves(const Composite *c, double time, double angle, double speed)
{
    const Machine *m = &c->pieces.step;
    const int first = m->stations - m->waves, order = one_piece_order(c);
    Pair *waves = c->pieces.waves, *rates = waves + m->waves;
    int k;
    for (k = 0; k < m->waves; k++) {
        waves[k] = machine_place(m, first + k, order, time);
        rates[k] = pair_scaled(machine_velocity(m, first + k, order, time), m->rate);
    }
    one_piece_store_waves(c, waves, rates, angle, speed);
}

/* -- places ------------------------------------------------------------------------------------- */

/* Let the parts stand at a time of the step, in the machine's [1]. */
void one_piece_stand_at(Unit *unit, double time)
{
    Composite *c = unit->own;
    Machine *m = &c->pieces.step;
    const int n = m->stations, own = n - m->waves, order = one_piece_order(c);
    const double speed = machine_speed_at(m, order, time) * m->rate, turned = machine_turned(m, order, time);
    double *rotor = c->parts->unit->memory, *place = rotor + MOTION;
    int k, w, i = 0;
    memcpy(c->states, c->at_begin, c->state_count * sizeof(double));
    angle_turn(rotor, turned);
    for (k = 0; k < own; k++) {
        const Pair displacement = machine_place(m, k, order, time);
        const Pair velocity = pair_scaled(machine_velocity(m, k, order, time), m->rate);
        place[2 * k] = pair_x(displacement);
        place[2 * k + 1] = pair_y(displacement);
        place[2 * own + 2 * k] = pair_x(velocity);
        place[2 * own + 2 * k + 1] = pair_y(velocity);
    }
    place[4 * own] = speed;
    place[4 * own + 1] = 0.0;
    if (m->waves) {
        stand_waves(c, time, rotor[REST], speed);
    }
    for (k = 1; k < c->parts_without_motor; k++) {
        const Balls *balls = part_balls(c->parts + k);
        double *angles = c->parts[k].unit->memory;
        for (w = 0; balls && w < balls->count; w++, i++) {
            const int column = n + i / 2;
            angles[w] = pair_at(machine_place(m, column, order, time), i % 2);
            angles[balls->count + w] =
                pair_at(machine_velocity(m, column, order, time), i % 2) * m->rate;
        }
    }
    if (c->pieces.is_eventful) {
        one_piece_place_sliders(c, order, time);
    }
    if (m->restraints) {
        one_piece_place_stops(c, order, time);
    }
    if (c->motor) {
        angle_turn(c->motor->unit->memory, turned);
        c->motor->unit->memory[ANGLE_SIZE] = speed;
        c->motor->unit->real[c->motor->unit->layout.computed.first + SPEED_OF_MOTOR] = speed;
    }
}

double one_piece_time(const Composite *c, double time)
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
    if (one_piece_expand(unit)) {
        return 1;
    }
    one_piece_stand_at(unit, one_piece_time(c, clock->shown));
    one_piece->placed = 1.0;
    return 0;
}

int one_piece_places(Unit *unit, Pair *places)
{
    const Composite *c = unit->own;
    const Machine *m = &c->pieces.step;
    const double time = one_piece_time(c, c->course->clock.shown);
    int k, order;
    if (one_piece_expand(unit)) {
        return 1;
    }
    order = one_piece_order(c);
    for (k = 0; k < m->width; k++) {
        places[k] = machine_place(m, k, order, time);
    }
    return 0;
}
