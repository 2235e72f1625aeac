/* The balancer with balls, rollers or pendulums, Filimonikhina 2017 (4), as a unit. */
#include <float.h>
#include <string.h>

#include "units/weights_unit.h"
#include "base/elementary.h"
#include "base/matrix.h"
#include "constants.h"
#include "weights_parameters.h"
#include "contact/pulse.h"

/* Angles, speeds, contacts (N,) each, impulse owed and pulse given as xi, eta each, the same of the torque, of which plain
   weights use the first two; and how long ago the inputs were set. */
static size_t weights_memory_size(const Layout *layout)
{
    return 3 * (size_t)layout->sizes.weights + 7;
}

static void weights_fields(const Unit *unit, Fields *fields)
{
    const size_t count = (size_t)unit->layout.sizes.weights;
    fields_number(fields, "angle", fields_here(fields), count);
    fields_number(fields, "angular velocity", fields_here(fields), count);
    fields_whole(fields, "contact", fields_here(fields), count, 0.0, 1.0);
    fields_number(fields, "impulse", fields_here(fields), 6);
    fields_within(fields, "time since the inputs", fields_here(fields), 1, 0.0, DBL_MAX);
}

static void weights_starts(const Layout *layout, double *real)
{
    int k;
    for (k = 0; k < layout->sizes.weights; k++) {
        real[FIRST_ANGLE + k] = TAU * k / layout->sizes.weights;
    }
}

static int weights_allocate(Unit *unit)
{
    Balls *own = unit->own;
    own->count = unit->layout.sizes.weights;
    own->scratch = unit_allocate(unit, ring_scratch(own->count), sizeof(double));
    own->turned = unit_allocate(unit, 2 * (size_t)own->count, sizeof(Turned));
    own->carried = carried_allocate(unit, own->count, unit->layout.sizes.lobes);
    return !own->scratch || !own->turned || !own->carried;
}

/* A Boolean parameter; 0 where the unit is declared without it. */
static int flag(const Unit *unit, const char *name)
{
    const Table *table = unit->layout.table;
    int k;
    for (k = 0; k < table->flag_count; k++) {
        if (text_equal(table->flags[k].name, name)) {
            return unit->boolean[k];
        }
    }
    return 0;
}

const char WEIGHTS_EVENT_KEYS[] = ".weight_radius, .rolling_resistance";

bool weights_meet(const Unit *unit, const double *parameters)
{
    return unit->layout.sizes.weights > 1 && parameters[WEIGHT_RADIUS] > 0.0;
}

bool weights_stick(const double *parameters)
{
    return parameters[ROLLING_RESISTANCE] > 0.0;
}

static int refuse_size(Unit *unit, double size, double radius)
{
    return unit_fail(unit, "weight_radius = %v m: such weights do not fit on a track of radius %v m, which "
                     "must be larger", size, radius);
}

static int weights_parameters(Unit *unit)
{
    Balls *own = unit->own;
    Track *track = &own->track;
    const double *real = unit->real;
    Failure failure;
    int k;
    track->weights.count = own->count;
    track->weights.mass = real[MASS];
    track->weights.track_radius = real[TRACK_RADIUS];
    track->weights.kappa = real[KAPPA];
    track->weights.drag = real[DRAG];
    track->weights.each =
        unit->layout.sizes.unequal ? real + FIRST_ANGLE + 2 * (size_t)own->count : NULL;
    track->weights.lobes = unit->layout.sizes.lobes;
    track->weights.lobe = real + FIRST_ANGLE + (unit->layout.sizes.unequal ? 5 : 2) * (size_t)own->count;
    track->weight_radius = real[WEIGHT_RADIUS];
    track->restitution = real[RESTITUTION];
    track->mobility = real[TRACK_MOBILITY];
    track->rolling_resistance = real[ROLLING_RESISTANCE];
    track->offset = complex_of(real[TRACK_OFFSET_XI], real[TRACK_OFFSET_ETA]);
    for (k = 0; k < 2 * own->count; k++) {
        own->turned[k].angle = not_a_number();
    }
    if (real[WEIGHT_RADIUS] >= real[TRACK_RADIUS]) {
        return refuse_size(unit, real[WEIGHT_RADIUS], real[TRACK_RADIUS]);
    }
    if (track_prepare(track, &failure)) {
        return unit_failed(unit, &failure);
    }
    carried_take(own->carried, track);
    own->is_given = false;
    own->stop_at_contact = flag(unit, "stop_at_contact") && unit->may_end_early;
    own->through_port = flag(unit, "inertia_as_force") ? 0.0 : weights_added_mass(&track->weights);
    own->sent = weights_added_mass(&track->weights) - own->through_port;
    return 0;
}

static int weights_begin(Unit *unit)
{
    const Balls *own = unit->own;
    const size_t count = (size_t)own->count;
    double *angles = unit->memory;
    Failure failure;
    memset(unit->memory, 0, unit->memory_count * sizeof(double));
    memcpy(angles, unit->real + FIRST_ANGLE, 2 * count * sizeof(double));
    if (track_first_contacts(&own->track, angles, angles + count, angles + 2 * count,
                             own->scratch, &failure)) {
        return unit_failed(unit, &failure);
    }
    return 0;
}

/* Residual force of the weights on the rotor and their torque (NULL: not wanted), each with its slope, in the rotor's
   axes, without pulses; 1 with the reason. */
static int find_push(Unit *unit, const Instant *plane, Complex *force, double *torque)
{
    const Balls *own = unit->own;
    const double *angles = unit->memory, *speeds = angles + own->count;
    Failure failure;
    if (own->is_given) {
        memcpy(force, own->given, sizeof own->given);
        copy_doubles(torque ? 2 : 0, own->given_torque, torque);
        return 0;
    }
    if (carried_look(own->carried, angles, speeds, speeds + own->count, plane, &failure)) {
        return unit_failed(unit, &failure);
    }
    machine_reaction(&own->carried->step, 0, &own->track, force, torque);
    return 0;
}

/* Computed outputs. */
static int weights_put_outputs(Unit *unit)
{
    const Balls *own = unit->own;
    double *out = unit->real + unit->layout.computed.first;
    Complex pulse_acceleration, force[2];
    Instant plane = find_plane_motion(unit, &pulse_acceleration);
    int k;
    if (find_push(unit, &plane, force, NULL)) {
        return 1;
    }
    force[0] = complex_sum(force[0], weights_pulse(unit));
    plane.motion[0] = complex_sum(plane.motion[0], pulse_acceleration);
    for (k = 0; k < 2 && own->sent != 0.0; k++) {
        force[k] = complex_difference(force[k], complex_scaled(own->sent, plane.motion[k]));
    }
    if (unit->layout.sizes.fixed_frame) {
        rotate_derivatives(force, &plane.spin, 1);
    }
    memcpy(out, force, sizeof force);
    out[ADDED_MASS] = own->through_port;
    return 0;
}

/* Take what the plane answers the pulse with off the acceleration over a step of this length, at whose
   end the pulse is `given`. */
static void take_off_answer(double mobility, Complex pulse, Complex given, double length,
                            Complex *cubic)
{
    const Complex start[2] = {complex_scaled(mobility, pulse), {0.0, 0.0}};
    const Complex end[2] = {complex_scaled(mobility, given), {0.0, 0.0}};
    Complex answer[SIGNAL_ORDERS];
    int k;
    cubic_between(start, end, length, answer);
    for (k = 0; k < SIGNAL_ORDERS; k++) {
        cubic[k] = complex_difference(cubic[k], answer[k]);
    }
}

/* Whether a step of this length ends behind its first event. */
static bool ends_at_event(const Unit *unit, double length)
{
    return ((const Balls *)unit->own)->stop_at_contact && length >= unit->real[SHORTEST_STOPPED_STEP];
}

/* One step of weights that may touch or stick. */
static int step_with_events(Unit *unit, CentreMotion *motion, double length, Moved *moved)
{
    const Balls *own = unit->own;
    double *owes = weights_impulses(unit);
    const Complex pulse = weights_pulse(unit);
    Complex owed = complex_of(owes[0], owes[1]), left = owed, given;
    Complex turn_left = complex_of(owes[4], 0.0), turn_given;
    Failure failure;
    given = pulse_ahead(pulse, spin_after(&motion->spin, length).angle, length, &left);
    turn_given = pulse_ahead(complex_of(owes[5], 0.0), 0.0, length, &turn_left);
    take_off_answer(own->track.mobility, pulse, given, length, motion->signal);
    if (carried_advance(own->carried, motion, length, ends_at_event(unit, length), moved, &failure)) {
        return unit_failed(unit, &failure);
    }
    unit->made = moved->reached;
    if (moved->reached == 0.0) {
        return 0;
    }
    if (moved->reached < length) {
        length = moved->reached;
        left = owed;
        given = pulse_ahead(pulse, spin_after(&motion->spin, length).angle, length, &left);
        turn_left = complex_of(owes[4], 0.0);
        turn_given = pulse_ahead(complex_of(owes[5], 0.0), 0.0, length, &turn_left);
    }
    owed = complex_sum(left, moved->impulse);
    owes[0] = owed.re;
    owes[1] = owed.im;
    owes[2] = given.re;
    owes[3] = given.im;
    owes[4] = turn_left.re + moved->turning;
    owes[5] = turn_given.re;
    return 0;
}

/* How the plane's centre moves over a step of this length, in the rotor frame, whose angle is 0. */
static CentreMotion find_step_motion(const Unit *unit, double length)
{
    CentreMotion motion = find_plane_signal(unit);
    if (unit->layout.sizes.fixed_frame) {
        rotate_signal(&motion, length);
    }
    motion.spin.angle = 0.0;
    return motion;
}

static int weights_step_unit(Unit *unit, double length)
{
    const Balls *own = unit->own;
    CentreMotion motion = find_step_motion(unit, length);
    Moved moved = {unit->memory, unit->memory + own->count, unit->memory + 2 * own->count, {0.0, 0.0}, 0.0, 0, length};
    Failure failure;
    if (own->track.eventful) {
        if (step_with_events(unit, &motion, length, &moved)) {
            return 1;
        }
    } else if (carried_advance(own->carried, &motion, length, false, &moved, &failure)) {
        return unit_failed(unit, &failure);
    }
    unit->memory[unit->memory_count - 1] = unit->made;
    return weights_put_outputs(unit);
}

static int weights_outputs(Unit *unit)
{
    unit->memory[unit->memory_count - 1] = 0.0;
    return weights_put_outputs(unit);
}

static int weights_observe(Unit *unit)
{
    const Balls *own = unit->own;
    const size_t count = (size_t)own->count;
    const Complex moment = track_static_moment(&own->track, unit->memory, own->turned);
    double *out = unit->real + unit->layout.observed.first;
    memcpy(out, unit->memory, 2 * count * sizeof(double));
    out[2 * count] = moment.re;
    out[2 * count + 1] = moment.im;
    out[2 * count + 2] = weights_alignment(own->count, unit->memory, own->turned);
    return 0;
}

static int weights_observe_torques(Unit *unit)
{
    double *out = unit->real + unit->layout.real_count - 2;
    Complex pulse_acceleration, force[2];
    const Instant plane = find_plane_motion(unit, &pulse_acceleration);
    if (find_push(unit, &plane, force, out)) {
        return 1;
    }
    out[0] += weights_impulses(unit)[5];
    return 0;
}

static size_t weights_signals(const Layout *layout, size_t *first)
{
    *first = layout->inputs.first;
    return SIGNALS;
}

/* Weights that touch or stick let go beyond. */
static double weights_reach(const Unit *unit, size_t input)
{
    const Track *track = &((const Balls *)unit->own)->track;
    const double size = larger(1.0, absolute(unit->real[input]));
    return text_equal(unit->layout.reals[input].declared->name, "angle") ? 1e-3
           : track->eventful                                             ? 1e-2 * size
                                                                         : size;
}

/* Acceleration of the k-th of weights without events at the present time [rad/s^2]; 1 with the reason. */
static int find_acceleration(Unit *unit, size_t k, double *value)
{
    const Balls *own = unit->own;
    const double *angles = unit->memory, *speeds = angles + own->count;
    Complex pulse_acceleration;
    const Instant plane = find_plane_motion(unit, &pulse_acceleration);
    Failure failure;
    if (carried_look(own->carried, angles, speeds, speeds + own->count, &plane, &failure)) {
        return unit_failed(unit, &failure);
    }
    *value = carried_acceleration(own->carried, (int)k);
    return 0;
}

static int weights_slope(Unit *unit, size_t reference, double *value)
{
    const Balls *own = unit->own;
    const size_t count = (size_t)own->count, output = reference - unit->layout.observed.first;
    if (reference == unit->layout.real_count - 2) { /* the torque, whose slope is beside it */
        const int wrong = unit_refresh(unit, FRESH);
        *value = unit->real[reference + 1];
        return wrong;
    }
    if (output < count) {
        *value = unit->memory[count + output];
    } else if (output < 2 * count && !own->track.eventful) {
        return find_acceleration(unit, output - count, value);
    }
    return 0;
}

static size_t weights_state_count(const Layout *layout)
{
    return 2 * (size_t)layout->sizes.weights;
}

const Equations WEIGHTS_EQUATIONS = {
    .name = "BallBalancer", .own_size = sizeof(Balls), .memory_size = weights_memory_size,
    .fields = weights_fields,
    .starts = weights_starts, .allocate = weights_allocate, .parameters = weights_parameters,
    .begin = weights_begin, .step = weights_step_unit, .outputs = weights_outputs,
    .observe = weights_observe, .observe_torques = weights_observe_torques,
    .is_torque = unit_ends_with, .signals = weights_signals, .reach = weights_reach,
    .slope = weights_slope, .states = weights_state_count, .nominals = {1.0, NOMINAL_ANGULAR_VELOCITY}};
