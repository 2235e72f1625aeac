/* The composite's own equations: parameters, begin, step, outputs, observe. */
#include "coupling/composite.h"

#include <string.h>

#include "base/elementary.h"
#include "base/matrix.h"

static const double LOOSEST = 0.1; /* tolerance */
static const double MOST_TURNS = 2.5e6; /* revolutions in a step of the host */
static const size_t REMADE = (size_t)-1; /* changes that a rotor is made with which is to be made anew */

/* -- memory ---------------------------------------------------------------------------------- */

size_t composite_memory(Composite *c, double *memory)
{
    enum { BLOCKS = 7 };
    const size_t outer = outside_count(c);
    const size_t counts[BLOCKS] = {sizeof(Course) / sizeof(double), outer, c->state_count, verdict_doubles(c), outer,
                                   one_piece_phase_doubles(c), c->state_count};
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
        c->at_begin = memory + at[2];
        c->extent = memory + at[3];
        c->pieces.begun_forces = memory + at[4];
        c->pieces.phases = memory + at[5];
        c->states = memory + at[6];
    }
    return total;
}

static int composite_allocate(Unit *unit)
{
    Composite *c = unit->own;
    const size_t stations = (size_t)c->parts->unit->layout.sizes.stations, forces = (size_t)c->force_count;
    int k;
    composite_memory(c, unit->memory);
    for (k = 0; k < c->part_count; k++) {
        c->real_count += c->parts[k].unit->layout.real_count;
    }
    c->sent = unit_allocate(unit, SIGNAL_ORDERS * forces, sizeof(Complex));
    c->answers = unit_allocate(unit, forces, sizeof(Knot));
    c->square = unit_allocate(unit, 3 * stations * stations, sizeof(double));
    c->saved_reals = unit_allocate(unit, c->real_count, sizeof(double));
    return one_piece_allocate(unit) || !c->sent || !c->answers || !c->square || !c->saved_reals;
}

/* -- the start ------------------------------------------------------------------------------- */

/* The tolerance of the experiment that was set up last, if it has one, counts where the host has set no other. */
static void take_tolerance(Unit *unit, double *tolerance, double given)
{
    if (unit->taken_tolerance > 0.0 && *tolerance == unit->taken_tolerance) {
        *tolerance = given;
    }
    unit->taken_tolerance = 0.0;
    if (unit->asks_tolerance && *tolerance == given) {
        *tolerance = unit->taken_tolerance = unit->tolerance;
    }
}

/* 1 with the reason where a motor drives a ring, which scenes refuse with the same words. */
static int refuse_driven_ring(Unit *unit)
{
    const Composite *c = unit->own;
    int k;
    for (k = 1; k < c->parts_without_motor && c->motor; k++) {
        if (part_ring(c->parts + k)) {
            return unit_fail(unit, "operation.motor: does not support a ring of liquid (%s): the liquid lags behind a rotor "
                             "that changes its speed, by a law that is not known here; give operation.run_up",
                             c->parts[k].unit->name);
        }
    }
    return 0;
}

static int composite_parameters(Unit *unit)
{
    Composite *c = unit->own;
    double *tolerance = unit->real + c->tolerance;
    int k;
    take_tolerance(unit, tolerance, unit->starts[c->tolerance]);
    if (refuse_driven_ring(unit)) {
        return 1;
    }
    if (!(*tolerance > 0.0 && *tolerance <= LOOSEST)) {
        return unit_fail(unit, "coupling.tolerance: must be above 0 and at most 0.1");
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

/* All parts at their start, and the balancers' masses on the rotor. */
static int begin_parts(Unit *unit)
{
    Composite *c = unit->own;
    Unit *rotor = c->parts->unit;
    int k;
    for (k = 0; k < c->part_count; k++) {
        Unit *part = c->parts[k].unit;
        const Range inputs = part->layout.inputs;
        memcpy(part->real + inputs.first, part->starts + inputs.first,
               inputs.count * sizeof(double));
        if (part->equations->begin(part)) {
            return composite_part_failed(unit, c->parts + k);
        }
    }
    composite_drive(unit, unit->time);
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

static int start(Unit *unit)
{
    Composite *c = unit->own;
    Course *course = c->course;
    memset(course, 0, sizeof *course);
    course->clock.begin = course->clock.time = unit->time;
    if (drive_begin(unit) || begin_parts(unit) || one_piece_begin(unit)) {
        return 1;
    }
    verdict_begin(c);
    course->clock.started = 1.0;
    return 0;
}

/* Another unbalance of the rotor from now on. */
static int composite_tune(Unit *unit)
{
    Composite *c = unit->own;
    if (c->course->clock.started > 0.0 && !unit->for_model_exchange) {
        if (composite_begin_anew(unit, unit->time)) {
            return 1;
        }
    }
    c->made_with = REMADE;
    return composite_follow_changes(unit);
}

/* Signals at the time, inputs and states of model exchange. */
static int agree(Unit *unit)
{
    const Composite *c = unit->own;
    if (composite_meet_host(unit)) {
        return 1;
    }
    c->course->clock.time = unit->time;
    composite_drive(unit, unit->time);
    return one_piece_signals(unit);
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

/* -- steps ----------------------------------------------------------------------------------- */

/* 1 with the reason where the units do not stand at the unit's time: a step would first have to reach it. */
static int stands_elsewhere(Unit *unit)
{
    const Clock *clock = &((const Composite *)unit->own)->course->clock;
    if (clock->started > 0.0 && !(unit->time >= clock->begin - clock->length &&
                                  unit->time <= clock->time + clock->length)) {
        return unit_fail(unit, "the state that was restored has the time %6 s, its motion stands at %6 s",
                         unit_host_time(unit, unit->time),
                         unit_host_time(unit, clock->within > 0.0 ? clock->shown : clock->time));
    }
    return 0;
}

static int composite_step_unit(Unit *unit, double length)
{
    const double end = unit->time + length;
    if (stands_elsewhere(unit) || composite_meet_host(unit)) { /* the state may be one that was restored */
        return 1;
    }
    if (!(length * ((const Composite *)unit->own)->course->drive.fastest < MOST_TURNS * TAU)) {
        return unit_fail(unit, "a step of %6 s is too long: the rotor may turn 2.5e6 times in one; use shorter "
                         "communication steps", length);
    }
    return composite_go_to(unit, end);
}

/* -- outputs --------------------------------------------------------------------------------- */

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
    results[0] = composite_speed_now(unit);
    results[1] = c->course->total.steps;
    results[2] = c->course->total.error;
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
        *rotor_speed_now(c->parts->unit) = composite_speed_now(unit);
        return one_piece_place(unit) || one_piece_place_followers(unit, c->parts->unit->memory + MOTION, unit->time);
    default:
        return one_piece_signals(unit);
    }
}

static int composite_observe(Unit *unit)
{
    const Composite *c = unit->own;
    const OutputKind kind = one_piece_outputs(unit);
    int k;
    if (stand_for(unit, kind)) {
        return 1;
    }
    for (k = 0; k < c->part_count && kind != OUTPUTS_ARE_PLACES; k++) {
        if (composite_asked(unit, c->parts + k)) {
            if (c->parts[k].unit->equations->observe(c->parts[k].unit)) {
                return composite_part_failed(unit, c->parts + k);
            }
            show_outputs(unit, c->parts + k);
        }
    }
    if (kind == OUTPUTS_OF_SIGNALS || (kind == OUTPUTS_OF_STATE && one_piece_asks_results(unit))) {
        observe_results(unit);
    }
    return 0;
}

static int composite_observe_torques(Unit *unit)
{
    const Composite *c = unit->own;
    int k;
    for (k = 0; k < c->part_count; k++) {
        Unit *part = c->parts[k].unit;
        if (part->equations->observe_torques && composite_asked(unit, c->parts + k)) {
            if (part->equations->observe_torques(part)) {
                return composite_part_failed(unit, c->parts + k);
            }
            show_outputs(unit, c->parts + k);
        }
    }
    return 0;
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
