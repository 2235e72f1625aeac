/* The liquid balancer of Dubovik 2006 as a unit. */
#include "base/elementary.h"
#include "base/cubic.h"
#include "fmi/unit.h"
#include "weights/liquid.h"

enum { LIQUID_SIGNALS = 2, BEHIND_SIGNALS = LIQUID_SIGNALS * SIGNAL_ORDERS, TOUCHES = 1 };

/* Inputs behind the signal, and outputs behind the force with its derivatives. */
enum { X, Y };
enum { OUT_ADDED_MASS, OUT_LIQUID_MASS, OUT_CLEARANCE };

typedef struct {
    Liquid liquid;
    double carried, sent; /* parts of the added mass: through the port, in the force [kg] */
} Own;

static int liquid_parameters(Unit *unit)
{
    Own *own = unit->own;
    const double *real = unit->real;
    Failure failure;
    own->liquid.chamber_radius = real[0];
    own->liquid.float_radius = real[1];
    own->liquid.height = real[2];
    own->liquid.density = real[3];
    if (liquid_check(&own->liquid, &failure)) {
        return unit_failed(unit, &failure);
    }
    own->carried = unit->boolean[0] ? 0.0 : liquid_added_mass(&own->liquid);
    own->sent = liquid_added_mass(&own->liquid) - own->carried;
    return 0;
}

static int liquid_begin(Unit *unit)
{
    (void)unit;
    return 0;
}

static void warn_of_touch(Unit *unit, Complex displacement, double time)
{
    const Own *own = unit->own;
    char words[160];
    Text text = text_in(words, sizeof words);
    text_format(&text, "bending %6 m exceeds the gap %6 m: the float touches the chamber and the model "
                "is invalid", magnitude(displacement), liquid_gap(&own->liquid));
    unit_warn_once(unit, TOUCHES, time, words);
}

/* Outputs with the input signals taken t after the start of the step. */
static void liquid_put_outputs(Unit *unit, double t)
{
    const Own *own = unit->own;
    const double *in = unit->real + unit->layout.inputs.first;
    const double *place = in + BEHIND_SIGNALS;
    double *out = unit->real + unit->layout.computed.first;
    const Complex displacement = complex_of(place[X], place[Y]);
    const double clearance = liquid_clearance(&own->liquid, displacement);
    Complex motion[2];
    int k;
    cubic_at((const Complex *)(const void *)in, t, motion);
    for (k = 0; k < 2; k++, out += LIQUID_SIGNALS) {
        out[0] = own->sent != 0.0 ? -own->sent * motion[k].re : 0.0;
        out[1] = own->sent != 0.0 ? -own->sent * motion[k].im : 0.0;
    }
    if (clearance < 0.0) {
        warn_of_touch(unit, displacement, unit->time + t);
    }
    out[OUT_ADDED_MASS] = own->carried;
    out[OUT_LIQUID_MASS] = liquid_mass(&own->liquid);
    out[OUT_CLEARANCE] = clearance;
}

static int liquid_step_unit(Unit *unit, double length)
{
    liquid_put_outputs(unit, length);
    return 0;
}

static int liquid_outputs(Unit *unit)
{
    liquid_put_outputs(unit, 0.0);
    return 0;
}

static int liquid_observe(Unit *unit)
{
    (void)unit;
    return 0;
}

static size_t liquid_signals(const Layout *layout, size_t *first)
{
    *first = layout->inputs.first;
    return LIQUID_SIGNALS;
}

/* The gap bends over the displacement; all else is linear. */
static double liquid_reach(const Unit *unit, size_t input)
{
    const size_t behind = unit->layout.inputs.first + BEHIND_SIGNALS;
    const double *place = unit->real + behind;
    return input < behind ? larger(1.0, absolute(unit->real[input]))
                          : 1e-3 * magnitude(complex_of(place[X], place[Y]));
}

static int liquid_slope(Unit *unit, size_t reference, double *value)
{
    (void)unit, (void)reference, (void)value; /* the masses' is 0, that of the clearance not known */
    return 0;
}

const Equations LIQUID_EQUATIONS = {
    .name = "LiquidBalancer", .own_size = sizeof(Own), .parameters = liquid_parameters,
    .begin = liquid_begin, .step = liquid_step_unit, .outputs = liquid_outputs,
    .observe = liquid_observe, .signals = liquid_signals, .reach = liquid_reach,
    .slope = liquid_slope};
