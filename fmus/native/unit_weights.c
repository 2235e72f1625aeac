/* The balancer with balls, rollers or pendulums, Filimonikhina 2017 (4), as a unit; twin of
   fmus/weights.py. */
#include <string.h>

#include "elementary.h"
#include "pulse.h"
#include "unit_weights.h"

/* Angles, speeds, contacts (N,) each, and impulse owed and pulse given as xi, eta each; plain
   weights use the first two. */
static size_t memory_size(const Layout *layout)
{
    return 3 * (size_t)layout->sizes.weights + 4;
}

static size_t own_size(void)
{
    return sizeof(Balls);
}

static void starts(const Layout *layout, double *real)
{
    int k;
    for (k = 0; k < layout->sizes.weights; k++) {
        real[FIRST_ANGLE + k] = TAU * k / layout->sizes.weights;
    }
}

static int allocate(Unit *unit)
{
    Balls *own = unit->own;
    own->count = unit->layout.sizes.weights;
    own->scratch = unit_allocate(unit, track_scratch(own->count), sizeof(double));
    return !own->scratch;
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

static int refuse_size(Unit *unit, double size, double radius)
{
    Text *reason = unit_reason(unit);
    text_put(reason, "weight_radius = ");
    text_number(reason, size);
    text_put(reason, " m: such weights do not fit on a track of radius ");
    text_number(reason, radius);
    text_put(reason, " m, which must be larger");
    return 1;
}

static int parameters(Unit *unit)
{
    Balls *own = unit->own;
    Track *track = &own->track;
    const double *real = unit->real;
    Failure failure;
    track->weights.count = own->count;
    track->weights.mass = real[MASS];
    track->weights.track_radius = real[TRACK_RADIUS];
    track->weights.kappa = real[KAPPA];
    track->weights.drag = real[DRAG];
    track->weight_radius = real[WEIGHT_RADIUS];
    track->restitution = real[RESTITUTION];
    track->rolling_resistance = real[ROLLING];
    track->offset = complex_of(real[OFFSET_XI], real[OFFSET_ETA]);
    own->quadrature = quadrature_empty();
    if (real[WEIGHT_RADIUS] >= real[TRACK_RADIUS]) {
        return refuse_size(unit, real[WEIGHT_RADIUS], real[TRACK_RADIUS]);
    }
    if (track_prepare(track, &failure)) {
        return unit_failed(unit, &failure, NULL, 0);
    }
    own->plain = !track->eventful && real[OFFSET_XI] == 0.0 && real[OFFSET_ETA] == 0.0;
    own->stop_at_contact = flag(unit, "stop_at_contact") && unit->may_end_early;
    own->carried = flag(unit, "inertia_as_force") ? 0.0 : weights_added_mass(&track->weights);
    own->sent = weights_added_mass(&track->weights) - own->carried;
    return 0;
}

static int begin(Unit *unit)
{
    const Balls *own = unit->own;
    const size_t count = (size_t)own->count;
    double *angles = unit->memory;
    Failure failure;
    memset(unit->memory, 0, unit->memory_count * sizeof(double));
    memcpy(angles, unit->real + FIRST_ANGLE, 2 * count * sizeof(double));
    if (!own->plain && track_first_contacts(&own->track, angles, angles + count,
                                            angles + 2 * count, own->scratch, &failure)) {
        return unit_failed(unit, &failure, angles, count);
    }
    return 0;
}

void weights_rotating(double angle, double speed, Complex *value, Complex *slope)
{
    const Complex turn = rect(1.0, -angle);
    /* slope - i w value */
    const Complex seen = complex_of(slope->re + speed * value->im, slope->im - speed * value->re);
    *value = complex_product(*value, turn);
    *slope = complex_product(seen, turn);
}

/* Force of the weights and its slope, in the rotor frame; acceleration and slope too. */
static int react(Unit *unit, Complex acceleration, Complex slope, double speed, double spin_up,
                 Complex *force, Complex *force_slope)
{
    const Balls *own = unit->own;
    const size_t count = (size_t)own->count;
    const double *angles = unit->memory, *pulse = unit->memory + 3 * count + 2;
    Failure failure;
    if (own->plain) {
        weights_reaction(&own->track.weights, angles, angles + count, acceleration, slope, speed,
                         spin_up, force, force_slope);
    } else {
        if (track_reaction(&own->track, angles, angles + count, angles + 2 * count, acceleration,
                           slope, speed, spin_up, force, force_slope, own->scratch, &failure)) {
            return unit_failed(unit, &failure, angles, count);
        }
        *force = complex_sum(*force, complex_of(pulse[0], pulse[1]));
    }
    if (own->sent != 0.0) {
        *force = complex_difference(*force, complex_scaled(own->sent, acceleration));
        *force_slope = complex_difference(*force_slope, complex_scaled(own->sent, slope));
    }
    return 0;
}

/* Computed outputs; acceleration and slope in the rotor frame. */
static int put(Unit *unit, Complex acceleration, Complex slope, double angle, double speed,
               double spin_up)
{
    const Balls *own = unit->own;
    double *out = unit->real + unit->layout.computed.first;
    Complex force, force_slope;
    if (react(unit, acceleration, slope, speed, spin_up, &force, &force_slope)) {
        return 1;
    }
    if (unit->layout.sizes.fixed_frame) {
        weights_rotating(-angle, -speed, &force, &force_slope);
    }
    out[FORCE] = force.re;
    out[FORCE + 1] = force.im;
    out[FORCE_SLOPE] = force_slope.re;
    out[FORCE_SLOPE + 1] = force_slope.im;
    out[ADDED_MASS] = own->carried;
    return 0;
}

/* One step of weights that may touch, stick or run off centre. */
static int meet(Unit *unit, const Complex *cubic, double speed, double spin_up, double length)
{
    Balls *own = unit->own;
    const size_t count = (size_t)own->count;
    double *angles = unit->memory, *impulses = unit->memory + 3 * count;
    Complex owed = complex_of(impulses[0], impulses[1]);
    Complex pulse = complex_of(impulses[2], impulses[3]);
    const double shortest = unit->real[SHORTEST_STOPPED];
    const int stops = own->stop_at_contact && length >= shortest;
    /* a host that takes brief steps can be told of a collision that it must take one for */
    const int stop = !stops ? 0 : shortest > 0.0 ? STOP_BEFORE : STOP_BEHIND;
    Moved moved;
    Failure failure;
    moved.angles = angles;
    moved.speeds = angles + count;
    moved.contacts = angles + 2 * count;
    if (track_advance(&own->track, moved.angles, moved.speeds, moved.contacts, cubic, speed,
                      spin_up, length, stop, &moved, own->scratch, &failure)) {
        return unit_failed(unit, &failure, unit->before, count);
    }
    unit->made = length = moved.reached;
    if (length == 0.0) {
        return 0;
    }
    discharge(&owed, &pulse, moved.impulse, length * (speed + 0.5 * spin_up * length), length);
    impulses[0] = owed.re;
    impulses[1] = owed.im;
    impulses[2] = pulse.re;
    impulses[3] = pulse.im;
    return 0;
}

static int step(Unit *unit, double length)
{
    Balls *own = unit->own;
    const double *in = unit->real + unit->layout.inputs.first;
    const int fixed = unit->layout.sizes.fixed_frame;
    const double speed = in[SPEED], spin_up = in[ACCELERATION];
    double *angles = unit->memory, *speeds = unit->memory + own->count, angle = in[ANGLE];
    Complex cubic[SIGNAL_ORDERS], end, end_slope;
    Failure failure;
    signal_orders(in, cubic);
    signal_at(cubic, length, &end, &end_slope);
    if (fixed) {
        Complex start = cubic[0], start_slope = cubic[1];
        angle += length * (speed + 0.5 * spin_up * length);
        weights_rotating(angle, speed + spin_up * length, &end, &end_slope);
        weights_rotating(in[ANGLE], speed, &start, &start_slope);
        signal_hermite(start, start_slope, end, end_slope, length, cubic);
    }
    if (!own->plain) {
        if (meet(unit, cubic, speed, spin_up, length)) {
            return 1;
        }
    } else if (weights_advance(&own->track.weights, angles, speeds, cubic, spin_up, length,
                               angles, speeds, &own->quadrature, &failure)) {
        return unit_failed(unit, &failure, unit->before, (size_t)own->count);
    }
    if (unit->made < length) {
        length = unit->made;
        angle = in[ANGLE] + (fixed ? length * (speed + 0.5 * spin_up * length) : 0.0);
        signal_at(cubic, length, &end, &end_slope);
    }
    return put(unit, end, end_slope, angle, speed + spin_up * length, spin_up);
}

void weights_motion_now(const Unit *unit, Complex *acceleration, Complex *slope)
{
    const double *in = unit->real + unit->layout.inputs.first;
    *acceleration = complex_of(in[0], in[1]);
    *slope = complex_of(in[2], in[3]);
    if (unit->layout.sizes.fixed_frame) {
        weights_rotating(in[ANGLE], in[SPEED], acceleration, slope);
    }
}

static int outputs(Unit *unit)
{
    const double *in = unit->real + unit->layout.inputs.first;
    Complex acceleration, slope;
    weights_motion_now(unit, &acceleration, &slope);
    return put(unit, acceleration, slope, in[ANGLE], in[SPEED], in[ACCELERATION]);
}

static void observe(Unit *unit)
{
    const Balls *own = unit->own;
    const size_t count = (size_t)own->count;
    const Complex moment = track_static_moment(&own->track, unit->memory);
    double *out = unit->real + unit->layout.observed.first;
    memcpy(out, unit->memory, 2 * count * sizeof(double));
    out[2 * count] = moment.re;
    out[2 * count + 1] = moment.im;
    out[2 * count + 2] = weights_alignment(own->count, unit->memory);
}

static size_t signals(const Layout *layout, size_t *first)
{
    *first = layout->inputs.first;
    return SIGNALS;
}

const Equations WEIGHTS_EQUATIONS = {
    "BallBalancer", memory_size, own_size, starts,  allocate,    parameters, begin,
    step,           outputs,     observe,  signals, weights_directional, weights_slope};
