/* Where the parts stand at a time of the step in one piece. */
#include <string.h>

#include "base/elementary.h"
#include "coupling/composite.h"

/* -- waves -------------------------------------------------------------------------------------- */

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

/* A station stands so, at a velocity [m/s]; and weights, two in a pair [rad/s]. */
static inline void stand_station(double *place, int own, int k, Pair displacement, Pair velocity)
{
    place[2 * k] = pair_x(displacement);
    place[2 * k + 1] = pair_y(displacement);
    place[2 * own + 2 * k] = pair_x(velocity);
    place[2 * own + 2 * k + 1] = pair_y(velocity);
}

static inline void stand_rotor(double *rotor, int own, double turned, double speed)
{
    double *place = rotor + MOTION;
    angle_turn(rotor, turned);
    place[4 * own] = speed;
    place[4 * own + 1] = 0.0;
}

void one_piece_stand_smooth(const Composite *c, double time)
{
    const Machine *m = &c->pieces.step;
    const int order = one_piece_order(c);
    stand_rotor(c->parts->unit->memory, m->stations, machine_turned(m, order, time),
                machine_speed_at(m, order, time) * m->rate);
}

void one_piece_stand_as_loaded(const Composite *c)
{
    const Machine *m = &c->pieces.step;
    const int n = m->stations;
    int k, w, i = 0;
    for (k = 0; k < n; k++) {
        stand_station(c->parts->unit->memory + MOTION, n, k, m->motion[k], pair_scaled(m->velocity[k], m->rate));
    }
    for (k = 1; k < c->parts_without_motor; k++) {
        const Balls *balls = part_balls(c->parts + k);
        double *angles = c->parts[k].unit->memory;
        for (w = 0; balls && w < balls->count; w++, i++) {
            angles[w] = pair_at(m->motion[n + i / 2], i % 2);
            angles[balls->count + w] = pair_at(m->velocity[n + i / 2], i % 2) * m->rate;
        }
    }
}

/* Let the parts stand at a time of the step, in the machine's [1]. */
void one_piece_stand_at(Unit *unit, double time)
{
    Composite *c = unit->own;
    Machine *m = &c->pieces.step;
    const int n = m->stations, own = n - m->waves, order = one_piece_order(c);
    const double speed = machine_speed_at(m, order, time) * m->rate, turned = machine_turned(m, order, time);
    double *rotor = c->parts->unit->memory;
    int k, w, i = 0;
    memcpy(c->states, c->at_begin, c->state_count * sizeof(double));
    stand_rotor(rotor, own, turned, speed);
    for (k = 0; k < own; k++) {
        stand_station(rotor + MOTION, own, k, machine_place(m, k, order, time),
                      pair_scaled(machine_velocity(m, k, order, time), m->rate));
    }
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
