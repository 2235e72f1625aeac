/* A ring part filled with liquid as a unit. */
#include <float.h>
#include <string.h>

#include "base/elementary.h"
#include "constants.h"
#include "units/ring_unit.h"

enum { RING_SIGNALS = 2 };

/* Parameters, inputs behind the signal, and computed and observed outputs. */
enum { RING_WALL, RING_INNER, RING_HEIGHT, RING_DENSITY, RING_DAMPING, RING_VISCOSITY, RING_FIRST_WAVE };
enum { RING_ANGLE = 8, RING_SPEED, RING_ACCELERATION };
enum { RING_ADDED_MASS = 4, RING_LIQUID_MASS };

/* Limits of belief, and the bits of their warnings. */
static const struct {
    double ratio;
    const char *words;
} THINNESS_LIMITS[] = {
    {0.1, "the layer thins to %3 of itself in places: the motion beside the steady one may err by some percent"},
    {0.3, "the layer thins to %3 of itself in places: the waves are too large for the model of small waves"},
    {1.0, "the wall is dry in places: the model of small waves is invalid"}};
enum { THINNESS_LIMIT_COUNT = sizeof THINNESS_LIMITS / sizeof *THINNESS_LIMITS };

static int ring_parameters(Unit *unit)
{
    RingUnit *own = unit->own;
    const double *real = unit->real;
    const LiquidRing ring = {real[RING_WALL],    real[RING_INNER],   real[RING_HEIGHT],
                       real[RING_DENSITY], real[RING_DAMPING], real[RING_VISCOSITY]};
    Failure failure;
    own->ring = ring;
    if (ring_check(&ring, &failure)) {
        return unit_failed(unit, &failure);
    }
    own->carried = unit->boolean[0] ? 0.0 : ring_added_mass(&ring);
    own->sent = ring_added_mass(&ring) - own->carried;
    return 0;
}

static int ring_begin(Unit *unit)
{
    memcpy(unit->memory, unit->real + RING_FIRST_WAVE, RING_STATES * sizeof(double));
    unit->memory[RING_SINCE] = 0.0;
    return 0;
}

static size_t ring_memory(const Layout *layout)
{
    (void)layout;
    return RING_MEMORY;
}

static void ring_fields(const Unit *unit, Fields *fields)
{
    (void)unit;
    fields_number(fields, "wave", fields_here(fields), RING_STATES);
    fields_within(fields, "time since the inputs", fields_here(fields), 1, 0.0, DBL_MAX);
}

static RingState ring_state(const Unit *unit)
{
    const double *memory = unit->memory;
    const RingState state = {{memory[0], memory[1]}, {memory[2], memory[3]}};
    return state;
}

/* How the centre moves over the step, in the axes of the signals. */
static CentreMotion ring_signal(const Unit *unit)
{
    const double *in = unit->real + unit->layout.inputs.first;
    CentreMotion motion;
    memcpy(motion.signal, in, sizeof motion.signal);
    motion.spin = spin_of(in[RING_ANGLE], in[RING_SPEED], in + RING_ACCELERATION);
    return motion;
}

/* The same at the end of the last step, in the rotor. */
static Instant ring_now(const Unit *unit)
{
    const CentreMotion motion = ring_signal(unit);
    Instant now = find_instant(&motion, unit->memory[RING_SINCE]);
    if (unit->layout.sizes.fixed_frame) {
        rotate_derivatives(now.motion, &now.spin, 0);
    }
    return now;
}

static void warn_of_thinness(Unit *unit)
{
    const RingUnit *own = unit->own;
    const double ratio = ring_thinness(&own->ring, ring_state(unit).wave);
    char words[200];
    int k;
    for (k = 0; k < THINNESS_LIMIT_COUNT; k++) {
        if (ratio > THINNESS_LIMITS[k].ratio) {
            Text text = text_in(words, sizeof words);
            text_format(&text, THINNESS_LIMITS[k].words, 1.0 - ratio);
            unit_warn_once(unit, 1 << k, unit->time, words);
        }
    }
}

static int ring_put_outputs(Unit *unit)
{
    const RingUnit *own = unit->own;
    const RingState state = ring_state(unit);
    const Instant now = ring_now(unit);
    double *out = unit->real + unit->layout.computed.first;
    Complex force[2];
    int k;
    ring_force(&own->ring, &state, &now, force);
    for (k = 0; k < 2 && own->sent != 0.0; k++) {
        force[k] = complex_difference(force[k], complex_scaled(own->sent, now.motion[k]));
    }
    if (unit->layout.sizes.fixed_frame) {
        rotate_derivatives(force, &now.spin, 1);
    }
    memcpy(out, force, sizeof force);
    out[RING_ADDED_MASS] = own->carried;
    out[RING_LIQUID_MASS] = ring_mass(&own->ring);
    warn_of_thinness(unit);
    return 0;
}

static int ring_step(Unit *unit, double length)
{
    RingUnit *own = unit->own;
    CentreMotion motion = ring_signal(unit);
    RingState state = ring_state(unit);
    if (!ring_resolves(&own->ring, &motion.spin, length)) {
        return unit_fail(unit, "a step of %6 s is too long: speed or damping of the liquid times it must be below "
                         "75000; use shorter communication steps", length);
    }
    if (unit->layout.sizes.fixed_frame) {
        rotate_signal(&motion, length);
    }
    ring_advance(&own->ring, &motion, length, &state);
    memcpy(unit->memory, &state, sizeof state);
    unit->memory[RING_SINCE] = length;
    return ring_put_outputs(unit);
}

static int ring_outputs(Unit *unit)
{
    unit->memory[RING_SINCE] = 0.0;
    return ring_put_outputs(unit);
}

static int ring_observe(Unit *unit)
{
    const RingUnit *own = unit->own;
    const RingState state = ring_state(unit);
    const double moment = ring_mass(&own->ring) * ring_hollow(&own->ring);
    double *out = unit->real + unit->layout.observed.first;
    memcpy(out, &state, sizeof state);
    out[4] = moment * state.wave.re;
    out[5] = moment * state.wave.im;
    out[6] = ring_thinness(&own->ring, state.wave);
    return 0;
}

static size_t ring_signals(const Layout *layout, size_t *first)
{
    *first = layout->inputs.first;
    return RING_SIGNALS;
}

static int ring_slope(Unit *unit, size_t reference, double *value)
{
    const RingUnit *own = unit->own;
    const size_t output = reference - unit->layout.observed.first;
    const RingState state = ring_state(unit);
    const Instant now = ring_now(unit);
    const Complex second = ring_acceleration(&own->ring, &state, &now);
    if (reference >= unit->layout.observed.first && output < RING_STATES) {
        const double slopes[RING_STATES] = {state.rate.re, state.rate.im, second.re, second.im};
        *value = slopes[output];
    }
    return 0;
}

static size_t ring_states(const Layout *layout)
{
    (void)layout;
    return RING_STATES;
}

const Equations RING_EQUATIONS = {
    .name = "RingBalancer", .own_size = sizeof(RingUnit), .memory_size = ring_memory, .fields = ring_fields,
    .parameters = ring_parameters, .begin = ring_begin, .step = ring_step, .outputs = ring_outputs,
    .observe = ring_observe, .signals = ring_signals, .slope = ring_slope,
    .states = ring_states, .nominals = {NOMINAL_DISPLACEMENT, NOMINAL_VELOCITY}};
