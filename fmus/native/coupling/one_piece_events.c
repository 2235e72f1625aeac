/* Events of a machine in one piece: what follows each, and which is next. */
#include <string.h>

#include "base/elementary.h"
#include "coupling/composite.h"
#include "machine/restraints.h"

/* -- who touches, and what sticks -------------------------------------------------------------------- */

/* Exact distances and one rate in contacts; 1 with the reason, where weights overlap. */
static int align_tracks(Unit *unit)
{
    const Composite *c = unit->own;
    int k;
    for (k = 1; k < c->parts_without_motor; k++) {
        Unit *part = c->parts[k].unit;
        const Balls *balls = part_balls(c->parts + k);
        WeightsInOrder weights;
        Failure failure;
        double *angles = part->memory;
        if (!balls || !balls->track.solid) {
            continue;
        }
        if (order_weights(&balls->track, angles, angles + balls->count, angles + 2 * balls->count, balls->scratch,
                          &weights, &failure)) {
            unit_failed(part, &failure);
            return composite_part_failed(unit, c->parts + k);
        }
        write_weights(&weights, angles, angles + balls->count, angles + 2 * balls->count);
    }
    return 0;
}

/* Write waves and their rates, which jump with their ring. */
static void store_waves(const Composite *c)
{
    const Machine *m = &c->pieces.step;
    const int first = m->stations - m->waves;
    Pair *waves = c->pieces.waves, *rates = waves + m->waves;
    int k;
    for (k = 0; k < m->waves; k++) {
        waves[k] = m->motion[first + k];
        rates[k] = pair_scaled(m->velocity[first + k], m->rate);
    }
    one_piece_store_waves(c, waves, rates, c->parts->unit->memory[REST], m->speed[0] * m->rate);
}

/* A stop is in this state from now on. */
static void set_stop(double *stop_states, int state)
{
    stop_states[STOP_TOUCHES] += state == STOP_PRESSES && stop_states[STOP_STATE] != STOP_PRESSES;
    stop_states[STOP_STATE] = state;
}

static void store_stops(const Composite *c)
{
    const struct Restraints *all = c->pieces.step.restraints;
    double *stop_states = rotor_stop_states(c->parts->unit);
    int k;
    for (k = 0; all && k < all->stop_count; k++) {
        set_stop(stop_states + STOP_DOUBLES * k, all->stops[k].state);
    }
}

/* Write rates, contacts and what sticks into the memories of the parts. */
static void store(const Composite *c)
{
    const Machine *m = &c->pieces.step;
    const struct Phase *phase = m->phase;
    const int own = m->stations - m->waves;
    double *velocity = c->parts->unit->memory + MOTION + 2 * own;
    double *slider_states = rotor_slider_states(c->parts->unit), *kept = c->pieces.phases;
    int k, w, i = 0;
    for (k = 0; k < own; k++) {
        velocity[2 * k] = pair_x(m->velocity[k]) * m->rate;
        velocity[2 * k + 1] = pair_y(m->velocity[k]) * m->rate;
    }
    for (k = 1; k < c->parts_without_motor; k++) {
        const Balls *balls = part_balls(c->parts + k);
        double *angles = c->parts[k].unit->memory;
        for (w = 0; balls && w < balls->count; w++, i++, kept += PHASE_OF_WEIGHT) {
            const PhaseWeight *own = phase->weights + i;
            angles[balls->count + w] = phase_rate(m, i) * m->rate;
            angles[2 * balls->count + w] = own->joined;
            kept[SLIP_OF_WEIGHT] = own->slip;
            kept[SIDE_OF_WEIGHT] = own->side;
        }
    }
    store_waves(c);
    for (k = 0; k < phase->slider_count; k++) {
        const PhaseSlider *own = phase->sliders + k;
        slider_states[SLIDER_DOUBLES * own->number + SLIPS] = own->slip;
        slider_states[SLIDER_DOUBLES * own->number + HOLDS] = (own->slip == 0.0 && own->stiffness == 0.0 ? own->hold[0] : own->force) *
                                                 m->rate * m->rate;
    }
    store_stops(c);
    if (c->motor) {
        c->motor->unit->memory[ANGLE_SIZE] = c->course->one_piece.speed = m->speed[0] * m->rate;
    }
}

int one_piece_meet(Unit *unit)
{
    Composite *c = unit->own;
    OnePiece *one_piece = &c->course->one_piece;
    Machine *m = &c->pieces.step;
    Failure failure;
    double angle;
    if (!(one_piece->undecided > 0.0)) {
        return 0;
    }
    if (align_tracks(unit)) {
        return 1;
    }
    one_piece_push(c, m, c->outer_forces, one_piece->pushed);
    angle = one_piece_load(c, m, c->states, one_piece->speed, one_piece->acceleration);
    one_piece_load_phase(c, m, c->states);
    if (c->motor) {
        one_piece_set_line(m, (int)one_piece->line);
    }
    if (phase_approaches(m)) {
        if (phase_collide(m, angle, c->pieces.impact, &failure)) {
            return unit_failed(unit, &failure);
        }
    } else if (phase_decide(m, angle, INSTANT_ORDER)) {
        return unit_fail(unit, "no solution was found for which weights touch and which weights and supports stick at t = %6 s",
                             unit_host_time(unit, c->course->clock.time));
    }
    store(c);
    c->pieces.key[0] = not_a_number();
    if (align_tracks(unit)) {
        return 1;
    }
    memcpy(c->at_begin, c->states, c->state_count * sizeof(double));
    one_piece->undecided = 0.0;
    one_piece->decided = 1.0;
    return 0;
}

/* -- events ------------------------------------------------------------------------------------------ */

void one_piece_find_event(Unit *unit, double *length)
{
    Composite *c = unit->own;
    OnePiece *one_piece = &c->course->one_piece;
    const PhaseEvent event = phase_first_event(&c->pieces.step, one_piece_order(c), length);
    one_piece->event = event.kind;
    one_piece->which = event.which;
}

/* The part that has a weight of the machine, whose number becomes that among its own. */
static const Part *part_of_weight(const Composite *c, int *weight)
{
    int k;
    for (k = 1; k < c->parts_without_motor; k++) {
        const Balls *balls = part_balls(c->parts + k);
        if (balls && *weight < balls->count) {
            break;
        }
        *weight -= balls ? balls->count : 0;
    }
    return c->parts + k;
}

void one_piece_stop_weight(const Composite *c, int weight)
{
    int number = weight;
    const Part *part = part_of_weight(c, &number);
    part->unit->memory[part_balls(part)->count + number] = 0.0;
    c->pieces.phases[PHASE_OF_WEIGHT * weight + SLIP_OF_WEIGHT] = 0.0;
}

static void stop_group(const Composite *c, int weight)
{
    const struct Phase *phase = c->pieces.step.phase;
    const PhaseGroup *group = phase->groups + phase->weights[weight].group;
    int j, w = group->first;
    for (j = 0; j < group->size; j++, w = phase->weights[w].ahead) {
        one_piece_stop_weight(c, w);
    }
}

void one_piece_stop_slider(const Composite *c, int which)
{
    const PhaseSlider *own = c->pieces.step.phase->sliders + which;
    double *slider_states = rotor_slider_states(c->parts->unit) + SLIDER_DOUBLES * own->number;
    slider_states[SLIPS] = 0.0;
    if (own->stiffness == 0.0) {
        c->parts->unit->memory[MOTION + 2 * (c->pieces.step.stations - c->pieces.rings) + own->place] = 0.0;
        slider_states[HOLDS] = 0.0;
    }
}

/* A slider has come to an end of its free stroke, or leaves its spring. */
static void change_stroke(const Composite *c, int which)
{
    const PhaseSlider *own = c->pieces.step.phase->sliders + which;
    double *slider_state = rotor_slider_states(c->parts->unit) + SLIDER_DOUBLES * own->number;
    const double side = own->side != 0 ? own->side : copy_sign(1.0, slider_state[PLAY]);
    slider_state[PLAY] = side * own->stroke;
    slider_state[SIDE] = own->side != 0 ? 0.0 : side;
    slider_state[HOLDS] = 0.0;
}

/* A stop is touched, lets go, or the rotor is back inside its gap: but for the error of the time of that. */
static void change_stop(const Composite *c, int which, EventKind kind)
{
    const Rotor *rotor = composite_rotor(c);
    const Stop *stop = rotor->stops + which;
    const int n = rotor->stations;
    const double *place = c->parts->unit->memory + MOTION;
    double displacement[2], velocity[2], *stop_states = rotor_stop_states(c->parts->unit) + STOP_DOUBLES * which;
    int state;
    restraint_displacement(stop->rows, n, place, displacement);
    restraint_displacement(stop->rows, n, place + 2 * n, velocity);
    state = kind == STOP_TOUCHED ? STOP_PRESSES
            : kind == STOP_LETS_GO && hypotenuse(displacement[0], displacement[1]) > stop->gap ? STOP_BEYOND
                                                                                                : STOP_APART;
    set_stop(stop_states, stop_state_of(stop, displacement, velocity, state));
}

void one_piece_pass_event(Unit *unit)
{
    Composite *c = unit->own;
    OnePiece *one_piece = &c->course->one_piece;
    const struct Phase *phase = c->pieces.step.phase;
    const int which = (int)one_piece->which;
    c->pieces.events += one_piece->event != NO_EVENT;
    if (one_piece->event == WEIGHT_STOPS && which < c->pieces.step.weight_count) {
        stop_group(c, which);
    } else if (one_piece->event == SLIDER_STOPS && which < phase->slider_count) {
        one_piece_stop_slider(c, which);
    } else if ((one_piece->event == STROKE_ENDS || one_piece->event == STROKE_BEGINS) && which < phase->slider_count) {
        change_stroke(c, which);
    } else if (one_piece->event >= STOP_TOUCHED && one_piece->event <= STOP_LEFT &&
               which < composite_rotor(c)->stop_count) {
        change_stop(c, which, (EventKind)one_piece->event);
    }
    one_piece->undecided = one_piece->event != NO_EVENT ? 1.0 : one_piece->undecided;
    one_piece->event = NO_EVENT;
}
