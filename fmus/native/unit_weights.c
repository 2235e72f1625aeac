/* The balancer with balls, rollers or pendulums, Filimonikhina 2017 (4), as a unit; twin of
   fmus/weights.py. */
#include <string.h>

#include "elementary.h"
#include "signals.h"
#include "unit.h"
#include "weights.h"

enum { SIGNALS = 2 };

/* Parameters, and inputs from the first of them on. */
enum { MASS, TRACK_RADIUS, KAPPA, DRAG, WEIGHT_RADIUS, RESTITUTION, ROLLING };
enum { OFFSET_XI = 7, OFFSET_ETA = 8 };
enum { FIRST_ANGLE = 9 };
enum { ANGLE = 8, SPEED = 9, ACCELERATION = 10 };
enum { FORCE = 0, FORCE_SLOPE = 2, ADDED_MASS = 4 };

typedef struct {
    int count;
    Weights model;
    double carried, sent; /* parts of the added mass: through the port, in the force [kg] */
    Quadrature quadrature;
} Own;

/* Angles, speeds, contacts (N,) each, and impulse owed and pulse given as xi, eta each; point
   weights on a centred track use the first two. */
static size_t memory_size(const Layout *layout)
{
    return 3 * (size_t)layout->sizes.weights + 4;
}

static size_t own_size(void)
{
    return sizeof(Own);
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
    Own *own = unit->own;
    own->count = unit->layout.sizes.weights;
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
    Own *own = unit->own;
    const double *real = unit->real;
    Failure failure;
    own->model.count = own->count;
    own->model.mass = real[MASS];
    own->model.track_radius = real[TRACK_RADIUS];
    own->model.kappa = real[KAPPA];
    own->model.drag = real[DRAG];
    own->quadrature = quadrature_empty();
    if (weights_check(&own->model, &failure)) {
        return unit_failed(unit, &failure, NULL, 0);
    }
    if (real[WEIGHT_RADIUS] >= real[TRACK_RADIUS]) {
        return refuse_size(unit, real[WEIGHT_RADIUS], real[TRACK_RADIUS]);
    }
    if ((real[WEIGHT_RADIUS] > 0.0 && own->count > 1) || real[ROLLING] > 0.0 ||
        real[OFFSET_XI] != 0.0 || real[OFFSET_ETA] != 0.0) {
        text_put(unit_reason(unit),
                 "weight_radius of several weights, rolling_resistance, track_offset_xi and "
                 "track_offset_eta must be 0 in this library: it has point weights on a centred "
                 "track only; the Python unit has the others");
        return 1;
    }
    own->carried = unit->boolean[0] ? 0.0 : weights_added_mass(&own->model);
    own->sent = weights_added_mass(&own->model) - own->carried;
    return 0;
}

static int begin(Unit *unit)
{
    const Own *own = unit->own;
    memset(unit->memory, 0, unit->memory_count * sizeof(double));
    memcpy(unit->memory, unit->real + FIRST_ANGLE, 2 * (size_t)own->count * sizeof(double));
    return 0;
}

/* A vector and its slope seen in axes that turn with the rotor. */
static void rotating(double angle, double speed, Complex *value, Complex *slope)
{
    const Complex turn = rect(1.0, -angle);
    /* slope - i w value */
    const Complex seen = complex_of(slope->re + speed * value->im, slope->im - speed * value->re);
    *value = complex_product(*value, turn);
    *slope = complex_product(seen, turn);
}

/* Computed outputs; acceleration and slope in the rotor frame. */
static void put(Unit *unit, Complex acceleration, Complex slope, double angle, double speed,
                double spin_up)
{
    const Own *own = unit->own;
    double *out = unit->real + unit->layout.computed.first;
    Complex force, force_slope;
    weights_reaction(&own->model, unit->memory, unit->memory + own->count, acceleration, slope,
                     speed, spin_up, &force, &force_slope);
    if (own->sent != 0.0) {
        force = complex_difference(force, complex_scaled(own->sent, acceleration));
        force_slope = complex_difference(force_slope, complex_scaled(own->sent, slope));
    }
    if (unit->layout.sizes.fixed_frame) {
        rotating(-angle, -speed, &force, &force_slope);
    }
    out[FORCE] = force.re;
    out[FORCE + 1] = force.im;
    out[FORCE_SLOPE] = force_slope.re;
    out[FORCE_SLOPE + 1] = force_slope.im;
    out[ADDED_MASS] = own->carried;
}

static int step(Unit *unit, double length)
{
    Own *own = unit->own;
    const double *in = unit->real + unit->layout.inputs.first;
    const double speed = in[SPEED], spin_up = in[ACCELERATION];
    const double speed_end = speed + spin_up * length;
    double angle_end = in[ANGLE], *angles = unit->memory, *speeds = unit->memory + own->count;
    Complex cubic[SIGNAL_ORDERS], end, end_slope;
    Failure failure;
    signal_orders(in, cubic);
    signal_at(cubic, length, &end, &end_slope);
    if (unit->layout.sizes.fixed_frame) {
        Complex start = cubic[0], start_slope = cubic[1];
        angle_end += length * (speed + 0.5 * spin_up * length);
        rotating(angle_end, speed_end, &end, &end_slope);
        rotating(in[ANGLE], speed, &start, &start_slope);
        signal_hermite(start, start_slope, end, end_slope, length, cubic);
    }
    if (weights_advance(&own->model, angles, speeds, cubic, spin_up, length, angles, speeds,
                        &own->quadrature, &failure)) {
        return unit_failed(unit, &failure, unit->before, (size_t)own->count);
    }
    put(unit, end, end_slope, angle_end, speed_end, spin_up);
    return 0;
}

/* Acceleration and its slope now, in the rotor frame. */
static void motion_now(const Unit *unit, Complex *acceleration, Complex *slope)
{
    const double *in = unit->real + unit->layout.inputs.first;
    *acceleration = complex_of(in[0], in[1]);
    *slope = complex_of(in[2], in[3]);
    if (unit->layout.sizes.fixed_frame) {
        rotating(in[ANGLE], in[SPEED], acceleration, slope);
    }
}

static int outputs(Unit *unit)
{
    const double *in = unit->real + unit->layout.inputs.first;
    Complex acceleration, slope;
    motion_now(unit, &acceleration, &slope);
    put(unit, acceleration, slope, in[ANGLE], in[SPEED], in[ACCELERATION]);
    return 0;
}

static void observe(Unit *unit)
{
    const Own *own = unit->own;
    const size_t count = (size_t)own->count;
    const Complex moment = weights_static_moment(&own->model, unit->memory);
    double *out = unit->real + unit->layout.observed.first;
    memcpy(out, unit->memory, 2 * count * sizeof(double));
    out[2 * count] = moment.re;
    out[2 * count + 1] = moment.im;
    out[2 * count + 2] = weights_spread(own->count, unit->memory);
}

static size_t signals(const Layout *layout, size_t *first)
{
    *first = layout->inputs.first;
    return SIGNALS;
}

/* -- derivatives ----------------------------------------------------------------------------- */

/* Changes of what the force depends on, in the rotor frame. */
typedef struct {
    Complex acceleration, slope;
    double speed, spin_up;
} Change;

/* The differential of `weights_reaction`, whose symbols these are. */
static void reaction_change(const Unit *unit, const Change *by, Complex acceleration,
                            Complex *force, Complex *force_slope)
{
    const Own *own = unit->own;
    const Weights *model = &own->model;
    const double *in = unit->real + unit->layout.inputs.first;
    const double w = in[SPEED], spin_up = in[ACCELERATION];
    const double gain = -1.0 / (model->kappa * model->track_radius);
    const double rate = weights_damping_rate(model);
    const double scale = -model->mass * model->track_radius;
    Complex moment = {0.0, 0.0}, first = {0.0, 0.0}, second = {0.0, 0.0};
    Complex second_change = {0.0, 0.0}, third_change = {0.0, 0.0}, sum, slope_sum;
    int k;
    for (k = 0; k < own->count; k++) {
        const double nu = unit->memory[own->count + k];
        const Complex unity = rect(1.0, unit->memory[k]), back = complex_conjugate(unity);
        const double bend = gain * complex_product(acceleration, back).im - spin_up - rate * nu;
        const Complex along = complex_scaled(gain, complex_product(by->acceleration, back));
        const double bent = along.im - by->spin_up;
        const double torque = gain * complex_product(by->slope, back).im - along.re * nu;
        moment = complex_sum(moment, unity);
        first = complex_sum(first, complex_product(complex_of(0.0, nu), unity));
        second = complex_sum(second, complex_product(complex_of(-nu * nu, bend), unity));
        second_change = complex_sum(second_change, complex_product(complex_of(0.0, bent), unity));
        third_change = complex_sum(
            third_change,
            complex_product(complex_of(-3.0 * nu * bent, torque - rate * bent), unity));
    }
    sum = complex_sum(second_change, complex_product(complex_of(0.0, 2.0 * by->speed), first));
    sum = complex_sum(
        sum, complex_product(complex_of(-2.0 * w * by->speed, by->spin_up), moment));
    slope_sum = complex_sum(third_change,
                            complex_product(complex_of(0.0, 2.0 * by->speed), second));
    slope_sum = complex_sum(slope_sum, complex_product(complex_of(0.0, 2.0 * w), second_change));
    slope_sum = complex_sum(
        slope_sum, complex_product(complex_of(-2.0 * w * by->speed, 3.0 * by->spin_up), first));
    slope_sum = complex_difference(
        slope_sum, complex_scaled(2.0 * (by->speed * spin_up + w * by->spin_up), moment));
    *force = complex_difference(complex_scaled(scale, sum),
                                complex_scaled(own->sent, by->acceleration));
    *force_slope = complex_difference(complex_scaled(scale, slope_sum),
                                      complex_scaled(own->sent, by->slope));
}

static int directional(Unit *unit, const double *seed, double *change)
{
    const double *in = unit->real + unit->layout.inputs.first;
    const double *out = unit->real + unit->layout.computed.first;
    const double angle = in[ANGLE], speed = in[SPEED];
    Change by;
    Complex acceleration, slope, force, force_slope;
    memset(change, 0,
           (unit->layout.computed.count + unit->layout.observed.count) * sizeof(double));
    motion_now(unit, &acceleration, &slope);
    by.acceleration = complex_of(seed[0], seed[1]);
    by.slope = complex_of(seed[2], seed[3]);
    by.speed = seed[SPEED];
    by.spin_up = seed[ACCELERATION];
    if (unit->layout.sizes.fixed_frame) {
        /* (a' - i w a) e^{-i beta}: by a and a', by w, and by beta */
        rotating(angle, speed, &by.acceleration, &by.slope);
        by.slope.re += seed[SPEED] * acceleration.im + seed[ANGLE] * slope.im;
        by.slope.im -= seed[SPEED] * acceleration.re + seed[ANGLE] * slope.re;
        by.acceleration.re += seed[ANGLE] * acceleration.im;
        by.acceleration.im -= seed[ANGLE] * acceleration.re;
    }
    reaction_change(unit, &by, acceleration, &force, &force_slope);
    if (unit->layout.sizes.fixed_frame) {
        rotating(-angle, -speed, &force, &force_slope);
        /* (F' + i w F) e^{i beta} by w and by beta */
        force_slope.re -= seed[SPEED] * out[FORCE + 1] + seed[ANGLE] * out[FORCE_SLOPE + 1];
        force_slope.im += seed[SPEED] * out[FORCE] + seed[ANGLE] * out[FORCE_SLOPE];
        force.re -= seed[ANGLE] * out[FORCE + 1];
        force.im += seed[ANGLE] * out[FORCE];
    }
    change[FORCE] = force.re;
    change[FORCE + 1] = force.im;
    change[FORCE_SLOPE] = force_slope.re;
    change[FORCE_SLOPE + 1] = force_slope.im;
    return 0;
}

static int slope(Unit *unit, size_t reference, double *value)
{
    const size_t count = (size_t)((const Own *)unit->own)->count;
    const size_t output = reference - unit->layout.observed.first;
    *value = 0.0;
    if (reference == unit->layout.computed.first + ADDED_MASS) {
        return 0;
    }
    if (reference < unit->layout.observed.first || output >= count) {
        return 1;
    }
    *value = unit->memory[count + output];
    return 0;
}

const Equations WEIGHTS_EQUATIONS = {
    "BallBalancer", memory_size, own_size, starts,  allocate,    parameters, begin,
    step,           outputs,     observe,  signals, directional, slope};
