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

/* The waves of rings of a state of the parts into a machine: y = Y e^{i angle}, y' = (Y' + i w Y) e^{i angle}. */
static void load_waves(const Composite *c, Machine *m, const double *states, double angle)
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
        load_waves(c, m, states, rotor[REST]);
    }
    return rotor[REST];
}

void one_piece_push(const Composite *c, Machine *m, const double *forces, double time)
{
    const LinearRotor *rotor = &composite_rotor(c)->rotor;
    const int n = m->stations, own = rotor->stations, planes = rotor->plane_count, count = (int)outside_count(c);
    double power = m->per_rate * m->per_rate;
    bool is_pushed = false;
    int i, k, order;
    for (i = 0; i < count; i++) {
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
        return unit_fail(unit, "speed = %6 rad/s at t = %6 s: must be %6 to %6 rad/s, the speeds of the bearings' table; "
                         "keep the speed within them, or give the table rows for this one",
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
    if (c->pieces.is_eventful) { /* points have the phase of the step */
        one_piece_load(c, &c->pieces.instant, c->at_begin, c->course->one_piece.speed, 0.0);
        one_piece_load_phase(c, &c->pieces.instant, c->at_begin);
    }
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
