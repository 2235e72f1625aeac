/* What a composite in one piece shows of its present state: signals of its parts, derivatives. */
#include <string.h>

#include "base/elementary.h"
#include "base/matrix.h"
#include "coupling/composite.h"

enum { ACCELERATION_ORDER = 2, SLOPE_ORDER = 3 }; /* of the motion, that show A, and A' */

/* -- the present state's machine ------------------------------------------------------------------- */

/* Load a state of the parts at this speed, so long after these forces from outside were told; the rotor's angle. */
static double load_instant(Composite *c, const double *states, double speed, double acceleration, const double *forces,
                           double since)
{
    Machine *m = &c->pieces.instant;
    double angle;
    if (c->motor) {
        one_piece_set_line(m, motor_line(m->drive.motor, speed));
    }
    one_piece_push(c, m, forces, since);
    angle = one_piece_load(c, m, states, speed, acceleration);
    if (c->pieces.is_eventful) {
        one_piece_load_phase(c, m, states);
    }
    return angle;
}

int one_piece_expand_instant(Unit *unit, int order)
{
    Composite *c = unit->own;
    Machine *m = &c->pieces.instant;
    double angle;
    if (one_piece_make(unit)) { /* the state may be one that was restored, with another unbalance */
        return 1;
    }
    angle = load_instant(c, c->states, composite_speed_now(unit), c->motor ? 0.0 : c->course->drive.acceleration,
                         c->outer_forces, unit->time - c->course->drive.pushed_at);
    if (c->pieces.is_eventful) {
        if (c->course->one_piece.undecided > 0.0 && phase_decide(m, angle, INSTANT_ORDER)) {
            return unit_fail(unit, "no solution was found for which weights touch and which weights and supports stick at t = %6 s",
                             unit_host_time(unit, unit->time));
        }
    }
    machine_expand(m, angle, order);
    return 0;
}

int one_piece_expand_begin(Unit *unit, int order)
{
    Composite *c = unit->own;
    const OnePiece *begin = &c->course->one_piece;
    double angle;
    if (one_piece_make(unit)) {
        return 1;
    }
    angle = load_instant(c, c->at_begin, begin->speed, begin->acceleration, c->pieces.begun_forces, begin->pushed);
    machine_expand(&c->pieces.instant, angle, order);
    return 0;
}

/* Acceleration of a plane in the rotor's axes, less gravity, and its slope [m/s^2, m/s^3]. */
static Knot plane_signal(const Composite *c, int plane)
{
    const Machine *m = &c->pieces.instant;
    const int n = m->stations, own = n - m->waves;
    const double *row = composite_rotor(c)->rotor.planes + plane * own;
    Pair a = pair_both(0.0), slope = a, back = m->spin[0];
    Knot knot;
    int i;
    back = pair_of(pair_x(back), -pair_y(back));
    for (i = 0; i < own; i++) {
        a = pair_add_scaled(a, m->acceleration[i], row[i]);
        slope = pair_add_scaled(slope, m->acceleration[n + i], row[i]);
    }
    slope = pair_product(pair_difference(slope, pair_scaled(pair_turned(a), m->speed[0])), back);
    a = pair_product(a, back);
    a = pair_scaled(a, m->rate * m->rate);
    slope = pair_scaled(slope, m->rate * m->rate * m->rate);
    knot.value = complex_of(pair_x(a), pair_y(a));
    knot.slope = complex_of(pair_x(slope), pair_y(slope));
    return knot;
}

/* Tell all parts how the rotor turns. */
static void tell_spin(const Composite *c)
{
    const Machine *m = &c->pieces.instant;
    const double square = m->rate * m->rate;
    const double rates[SIGNAL_ORDERS] = {m->speed[1] * square,
                                         c->motor ? 2.0 * m->speed[2] * square * m->rate : 0.0, 0.0, 0.0};
    int k;
    for (k = 0; k < c->parts_without_motor; k++) {
        double *speed = c->parts[k].unit->real + c->parts[k].speed_input;
        if (c->parts[k].speed_input >= 0) {
            speed[0] = m->speed[0] * m->rate;
            memcpy(speed + SPIN_UP, rates, sizeof rates);
        }
    }
}

/* Tell weights what they push with. */
static void give_push(const Composite *c, const Part *part)
{
    const Machine *m = &c->pieces.instant;
    Balls *balls = part_balls(part);
    int k, track = 0;
    if (!balls) {
        return;
    }
    for (k = 1; c->parts + k < part; k++) {
        track += part_balls(c->parts + k) != NULL;
    }
    machine_reaction(m, track, &balls->track, balls->given, balls->given_torque);
    balls->is_given = true;
}

/* Outputs of a balancer on its plane. */
static int show_balancer(Unit *unit, const Part *part)
{
    const Composite *c = unit->own;
    Unit *inner = part->unit;
    composite_place(c, part);
    if (part->force_number >= 0) {
        const Knot knot = plane_signal(c, part->plane);
        double *input = inner->real + inner->layout.inputs.first;
        memset(input, 0, SIGNAL_ORDERS * sizeof(Complex));
        memcpy(input, &knot, sizeof knot);
    }
    give_push(c, part);
    inner->time = unit->time;
    inner->start = unit->start;
    return inner->equations->outputs(inner) && composite_part_failed(unit, part);
}

int one_piece_signals(Unit *unit)
{
    Composite *c = unit->own;
    int k;
    if (one_piece_place(unit) || one_piece_expand_instant(unit, SLOPE_ORDER)) {
        return 1;
    }
    tell_spin(c);
    for (k = 1; k < c->parts_without_motor; k++) {
        if (show_balancer(unit, c->parts + k)) {
            return 1;
        }
    }
    composite_read_forces(c, c->answers);
    for (k = 0; k < c->force_count; k++) {
        knot_from_start(c->answers + k, c->sent + SIGNAL_ORDERS * k);
    }
    composite_set_forces(unit, c->sent);
    if (c->parts->unit->equations->outputs(c->parts->unit)) {
        return composite_part_failed(unit, c->parts);
    }
    return c->motor && composite_answer_torque(unit);
}

/* -- model exchange ------------------------------------------------------------------------------- */

/* Y' and Y'' of a ring, Y'' e^{i angle} = y'' - 2 i w y' - w^2 y - i w' y. */
static void write_wave_rates(const Composite *c, const Part *part, int station, double *rates)
{
    const Machine *m = &c->pieces.instant;
    const Pair back = pair_direction(-c->parts->unit->memory[REST]), wave = m->motion[station];
    const Number w = m->speed[0];
    Pair second = pair_add_scaled(m->acceleration[station], pair_turned(m->velocity[station]), -2.0 * w);
    second = pair_add_scaled(second, wave, -w * w);
    second = pair_add_scaled(second, pair_turned(wave), -m->speed[1]);
    second = pair_scaled(pair_product(second, back), m->rate * m->rate);
    copy_doubles(2, part->unit->memory + RING_RATE, rates);
    rates[2] = pair_x(second);
    rates[3] = pair_y(second);
}

int one_piece_rates(Unit *unit, double *rates)
{
    Composite *c = unit->own;
    const Machine *m = &c->pieces.instant;
    const int n = m->stations, own = n - m->waves;
    const double square = m->rate * m->rate;
    int k, w, i = 0, wave = own;
    if (one_piece_expand_instant(unit, ACCELERATION_ORDER)) {
        return 1;
    }
    *rates++ = m->speed[0] * m->rate;
    copy_doubles(2 * (size_t)own, c->parts->unit->memory + MOTION + 2 * own, rates);
    for (k = 0; k < own; k++) {
        const Pair a = pair_scaled(pair_sum(m->acceleration[k], m->gravity), square);
        rates[2 * own + 2 * k] = pair_x(a);
        rates[2 * own + 2 * k + 1] = pair_y(a);
    }
    rates += 4 * own;
    for (k = 1; k < c->parts_without_motor; k++) {
        const Balls *balls = part_balls(c->parts + k);
        const int count = balls ? balls->count : 0;
        for (w = 0; w < count; w++, i++) {
            rates[w] = c->parts[k].unit->memory[count + w];
            rates[count + w] = pair_at(m->velocity[m->width + n + i / 2], i % 2) * square;
        }
        rates += 2 * count;
        if (part_ring(c->parts + k)) {
            write_wave_rates(c, c->parts + k, wave++, rates);
            rates += RING_STATES;
        }
    }
    if (c->motor) {
        rates[0] = m->speed[0] * m->rate;
        rates[1] = m->speed[1] * square;
    }
    return 0;
}
