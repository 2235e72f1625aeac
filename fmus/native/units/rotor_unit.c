/* The rotor on its supports as a unit: forces on its planes in, accelerations of the planes out. */
#include <float.h>
#include <string.h>

#include "units/rotor_unit.h"
#include "base/elementary.h"
#include "constants.h"
#include "base/matrix.h"
#include "base/spin.h"
#include "rotor/propagator.h"

static size_t rotor_memory_size(const Layout *layout)
{
    return MOTION + 4 * (size_t)layout->sizes.stations + 2 + 2 * SLIDER_DOUBLES * (size_t)layout->sizes.sliders +
           STOP_DOUBLES * (size_t)layout->sizes.stops;
}

static void rotor_fields(const Unit *unit, Fields *fields)
{
    const size_t stations = (size_t)unit->layout.sizes.stations;
    int k;
    angle_fields(fields);
    fields_number(fields, "displacement", fields_here(fields), 2 * stations);
    fields_number(fields, "velocity", fields_here(fields), 2 * stations);
    fields_number(fields, "speed", fields_here(fields), 1);
    fields_within(fields, "time since the inputs", fields_here(fields), 1, 0.0, DBL_MAX);
    for (k = 0; k < 2 * unit->layout.sizes.sliders; k++) {
        fields_whole(fields, "slider's direction", fields_here(fields), 1, -1.0, 1.0);
        fields_number(fields, "slider's force", fields_here(fields), 1);
        fields_whole(fields, "slider's side", fields_here(fields), 1, -1.0, 1.0);
        fields_number(fields, "slider's place in its stroke", fields_here(fields), 1);
    }
    for (k = 0; k < unit->layout.sizes.stops; k++) {
        fields_whole(fields, "stop's state", fields_here(fields), 1, 0.0, STOP_STATES - 1.0);
        fields_whole(fields, "touches of a stop", fields_here(fields), 1, 0.0, MOST_COUNTED);
        fields_within(fields, "largest force of a stop", fields_here(fields), 1, 0.0, DBL_MAX);
    }
}

static double *doubles(Unit *unit, size_t count, int *missing)
{
    double *block = unit_allocate(unit, count, sizeof(double));
    *missing |= !block;
    return block;
}

static int rotor_allocate(Unit *unit)
{
    Rotor *own = unit->own;
    const Sizes *sizes = &unit->layout.sizes;
    const int n = sizes->stations, p = sizes->planes;
    const size_t stations = (size_t)n, planes = (size_t)p, free = n > 2 ? stations - 2 : 0;
    /* of two axes: half as much would do for one */
    const size_t columns = (size_t)step_matrix_columns(n, p, 2);
    const size_t matrix = (size_t)step_matrix_rows(n, p, 2) * columns;
    Holds holds;
    int k, missing = 0;
    own->kind = rotor_kind(&unit->layout);
    own->stations = n;
    own->planes = p;
    own->unbalances = sizes->unbalances;
    own->turning = !sizes->fixed_frame;
    own->slider_count = 2 * sizes->sliders;
    own->force_count = sizes->supports + sizes->feet;
    own->forces = unit_allocate(unit, (size_t)own->force_count, sizeof(Force));
    own->force_rows = doubles(unit, (size_t)own->force_count * stations * BEARING_NUMBERS, &missing);
    own->sliders = unit_allocate(unit, (size_t)own->slider_count, sizeof(Slider));
    own->ports = unit_allocate(unit, planes, sizeof(int));
    own->cubic_count = sizes->cubics;
    own->stop_count = sizes->stops;
    own->cubics = unit_allocate(unit, (size_t)own->cubic_count + 1, sizeof(CubicSpring));
    own->stops = unit_allocate(unit, (size_t)own->stop_count + 1, sizeof(Stop));
    own->restraint_rows = doubles(unit, 2 * stations * (size_t)(own->cubic_count + own->stop_count), &missing);
    own->slider_rows = doubles(unit, 2 * stations * (size_t)sizes->sliders, &missing);
    holds = rotor_holds(own);
    own->slider_states = doubles(unit, holds_doubles(&holds), &missing);
    own->taylor_memory = doubles(unit, taylor_step_size(n, p, &holds), &missing);
    own->taylor_of.added_mass = doubles(unit, planes, &missing);
    own->later_forces = doubles(unit, 2 * SIGNAL_ORDERS * planes, &missing);
    own->motion = doubles(unit, 6 * stations, &missing);
    own->rotor_memory = doubles(unit, linear_rotor_size(n, p), &missing);
    own->loaded_mass = doubles(unit, stations * stations, &missing);
    own->values = doubles(unit, 2 * stations + 3 * (size_t)sizes->unbalances + free * free +
                                    linear_rotor_flexible_scratch(n), &missing);
    own->unsorted = doubles(unit, matrix, &missing);
    own->matrix_scratch = doubles(unit, step_matrix_scratch(n, p, 2), &missing);
    own->operand = doubles(unit, columns, &missing);
    own->result = doubles(unit, 4 * (stations + planes), &missing);
    own->sag = doubles(unit, 2 * stations, &missing);
    own->sag_of.added_mass = doubles(unit, planes, &missing);
    for (k = 0; k < KEPT_MATRICES; k++) {
        own->kept[k].of.added_mass = doubles(unit, planes, &missing);
        own->kept[k].matrix = doubles(unit, matrix, &missing);
    }
    return missing || !own->sliders || !own->ports || !own->forces || !own->cubics || !own->stops;
}

static int rotor_parameters(Unit *unit)
{
    Rotor *own = unit->own;
    Failure failure;
    int k;
    if (rotor_of_parameters(unit)) {
        return 1;
    }
    own->axes = linear_rotor_isotropic(&own->rotor) ? 1 : 2;
    own->parts = 3 - own->axes;
    own->rows = step_matrix_rows(own->stations, own->planes, own->axes);
    own->columns = step_matrix_columns(own->stations, own->planes, own->axes);
    for (k = 0; k < KEPT_MATRICES; k++) {
        own->kept[k].of.made = false;
    }
    own->taylor_of.made = own->sag_of.made = false;
    own->turned[0].angle = own->turned[1].angle = not_a_number();
    if (linear_rotor_heavy(&own->rotor) &&
        linear_rotor_sag(&own->rotor, own->rotor.bearings.count ? own->rotor.bearings.speeds[0] : 0.0, own->sag, own->matrix_scratch, &failure)) {
        return unit_failed(unit, &failure);
    }
    return own->rotor.sliders ? rotor_make_first_taylor(unit) : 0;
}

static int rotor_begin(Unit *unit)
{
    const Rotor *own = unit->own;
    const size_t motion = 4 * (size_t)own->stations;
    const double *start = unit->real + unit->layout.parameters.count - motion;
    angle_start(unit->memory, start[-1]);
    memcpy(unit->memory + MOTION, start, motion * sizeof(double));
    friction_at_start(own->sliders, own->slider_count, own->stations, start, start + motion / 2, rotor_slider_states(unit));
    fill_doubles(STOP_DOUBLES * (size_t)own->stop_count, 0.0, rotor_stop_states(unit));
    return 0;
}

static int rotor_step_unit(Unit *unit, double length)
{
    Rotor *own = unit->own;
    const size_t motion = 4 * (size_t)own->stations;
    const Spin start = spin_of(0.0, rotor_inputs(unit)[0], rotor_inputs(unit) + SPIN_UP);
    double *end_speed = unit->memory + MOTION + motion;
    Spin end;
    if (rotor_propagate(unit, length)) {
        return 1;
    }
    unit->made = length = own->reached;
    end = spin_after(&start, length);
    angle_turn(unit->memory, end.angle);
    copy_doubles(motion, own->result, unit->memory + MOTION);
    end_speed[0] = end.speed;
    end_speed[1] = length;
    copy_doubles(holds_doubles(&own->taylor.holds), own->slider_states, rotor_slider_states(unit));
    rotor_put(own, own->result + motion, unit->memory[REST], end.speed,
              unit->real + unit->layout.computed.first);
    return 0;
}

static int rotor_outputs(Unit *unit)
{
    rotor_speed_now(unit)[0] = rotor_inputs(unit)[0];
    rotor_speed_now(unit)[1] = 0.0;
    return rotor_outputs_now(unit, unit->real + unit->layout.computed.first);
}

static double largest_bending(const Rotor *own, const double *stations)
{
    const LinearRotor *rotor = &own->rotor;
    double largest = 0.0;
    int i;
    for (i = 0; i < rotor->deflections; i++) {
        double bending[2];
        const double *row = rotor->deflection + i * own->stations;
        combine_vectors(row, 1, own->stations, stations, bending);
        largest = larger(largest, magnitude(complex_of(bending[0], bending[1])));
    }
    return largest;
}

static int rotor_observe(Unit *unit)
{
    const Rotor *own = unit->own;
    const double *memory = unit->memory, *motion = memory + MOTION;
    const size_t count = 4 * (size_t)own->stations;
    double *out = unit->real + unit->layout.observed.first;
    int k;
    out[0] = angle_total(memory);
    memcpy(out + 1, motion, count * sizeof(double));
    out += 1 + count;
    combine_vectors(own->rotor.planes, own->planes, own->stations, motion, out);
    out += 2 * own->planes;
    *out++ = largest_bending(own, motion);
    for (k = 0; k < own->slider_count; k++) {
        *out++ = rotor_slider_states(unit)[SLIDER_DOUBLES * k + HOLDS];
    }
    for (k = 0; k < own->stop_count; k++, out += 4) {
        const double *states = rotor_stop_states(unit) + STOP_DOUBLES * k;
        double across[2], rate[2];
        restraint_displacement(own->stops[k].rows, own->stations, motion, across);
        restraint_displacement(own->stops[k].rows, own->stations, motion + count / 2, rate);
        stop_force(own->stops + k, (int)states[STOP_STATE], across, rate, out);
        out[2] = states[STOP_LARGEST];
        out[3] = states[STOP_TOUCHES];
    }
    rotor_observe_forces(unit, out);
    return 0;
}

static int rotor_observe_torques(Unit *unit)
{
    return rotor_torque_now(unit, unit->real + unit->layout.real_count - 2);
}

static size_t rotor_signals(const Layout *layout, size_t *first)
{
    *first = layout->inputs.first + (size_t)layout->sizes.planes + SPUN;
    return 2 * (size_t)layout->sizes.planes;
}

/* What the observed outputs are, in their order: the angle, displacements and velocities of the
   stations, then displacements of the planes. */
enum { OF_ANGLE, OF_DISPLACEMENT, OF_VELOCITY, OF_PLANE, OF_NOTHING };

/* Which of them one is, counted from the first observed; `number` is its place among its kind. */
static int output_kind(const Rotor *own, size_t output, size_t *number)
{
    const size_t n = 2 * (size_t)own->stations, p = 2 * (size_t)own->planes;
    const size_t counts[4] = {1, n, n, p};
    int kind;
    *number = output;
    for (kind = OF_ANGLE; kind < OF_NOTHING && *number >= counts[kind]; kind++) {
        *number -= counts[kind];
    }
    return kind;
}

static int rotor_slope(Unit *unit, size_t reference, double *value)
{
    const Rotor *own = unit->own;
    const size_t n = 2 * (size_t)own->stations;
    const double *velocity = unit->memory + MOTION + n;
    const double angle = unit->memory[REST], *seen = unit->real + unit->layout.computed.first;
    double both[2];
    size_t k;
    if (reference == unit->layout.real_count - 2) {
        const int wrong = unit_refresh(unit, FRESH);
        *value = unit->real[reference + 1];
        return wrong;
    }
    switch (output_kind(own, reference - unit->layout.observed.first, &k)) {
    case OF_ANGLE:
        *value = unit->memory[MOTION + 2 * n];
        break;
    case OF_DISPLACEMENT:
        *value = velocity[k];
        break;
    case OF_VELOCITY:
        if (own->stations == 1) {
            /* a disc alone moves as its planes do, whose acceleration is less gravity's */
            rotor_rotated(seen, 1, own->turning ? cosine(angle) : 1.0, own->turning ? sine(angle) : 0.0, both);
            *value = both[k] + own->rotor.gravity[k];
        }
        break;
    case OF_PLANE:
        combine_vectors(own->rotor.planes + k / 2 * (n / 2), 1, own->stations, velocity, both);
        *value = both[k % 2];
        break;
    default: /* it has no slope */
        break;
    }
    return 0;
}

static size_t rotor_state_count(const Layout *layout)
{
    return 4 * (size_t)layout->sizes.stations;
}

const Equations ROTOR_EQUATIONS = {
    .name = "RotorOnSupports", .own_size = sizeof(Rotor), .memory_size = rotor_memory_size,
    .fields = rotor_fields,
    .starts = rotor_starts, .allocate = rotor_allocate, .parameters = rotor_parameters,
    .begin = rotor_begin, .step = rotor_step_unit, .outputs = rotor_outputs,
    .observe = rotor_observe, .observe_torques = rotor_observe_torques, .is_torque = unit_ends_with,
    .signals = rotor_signals, .slope = rotor_slope, .states = rotor_state_count, .turns = 1,
    .nominals = {NOMINAL_DISPLACEMENT, NOMINAL_VELOCITY}};
