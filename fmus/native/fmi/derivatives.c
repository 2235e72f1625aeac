/* Derivatives as FMI asks for them: of inputs and outputs by time, and of outputs by inputs. */
#include <string.h>

#include "base/cubic.h"
#include "base/elementary.h"
#include "fmi/unit.h"

/* Part of a parameter by which it is moved: a difference of order 4 then errs by 1e-12. */
static const double PARAMETER_REACH = 1e-3;

/* The signal inputs' values, of which the derivatives follow in blocks of the same size. */
static Range signal_values(const Unit *unit)
{
    Range range = {0, 0};
    if (unit->equations->signals) {
        range.count = unit->equations->signals(&unit->layout, &range.first);
    }
    return range;
}

static Range outputs_of(const Layout *layout)
{
    Range outputs;
    outputs.first = layout->computed.first;
    outputs.count = layout->real_count - outputs.first;
    return outputs;
}

static int within(size_t reference, Range range)
{
    return reference - range.first < range.count;
}

/* An error about a value reference, by the name of its variable if there is one. */
static Status refuse_reference(Unit *unit, size_t reference, const char *what, const char *why)
{
    Text *reason = unit_reason(unit);
    if (reference < unit->layout.real_count) {
        layout_name(&unit->layout, reference, reason);
    } else {
        text_integer(reason, (unsigned long)reference);
    }
    text_put(reason, why);
    return unit_report(unit, STATUS_ERROR, what);
}

/* -- of inputs by time ----------------------------------------------------------------------- */

/* Reason for refusing the derivative of an input, or NULL. */
static const char *wrong_derivative(const Unit *unit, size_t reference, int order, double value)
{
    const Range values = signal_values(unit);
    Range signals = values;
    signals.count *= SIGNAL_ORDERS;
    if (!within(reference, unit->layout.inputs)) {
        return ": is no input";
    }
    if (order < 1 || order >= SIGNAL_ORDERS) {
        return ": the order of a derivative must be 1 to 3";
    }
    if (!is_finite(value)) {
        return ": a derivative must be a finite number";
    }
    if (within(reference, signals) && !within(reference, values)) {
        return ": is a derivative itself";
    }
    return NULL;
}

Status unit_set_derivatives(Unit *unit, const unsigned *references, size_t count,
                            const int *orders, const double *values)
{
    const Range signals = signal_values(unit);
    size_t k;
    for (k = 0; k < count; k++) {
        const char *wrong =
            references[k] < unit->layout.real_count
                ? wrong_derivative(unit, references[k], orders[k], values[k])
                : ": unknown value reference";
        if (wrong) {
            return refuse_reference(unit, references[k], "setting an input's derivative failed",
                                    wrong);
        }
    }
    for (k = 0; k < count; k++) {
        const unsigned reference = references[k];
        /* any other input is taken at the start of the step, and needs no derivative */
        if (within(reference, signals)) {
            unit->real[reference + (size_t)orders[k] * signals.count] = values[k];
        } else if (text_equal(unit->layout.reals[reference].declared->name, "speed") &&
                   orders[k] == 1) {
            unit->real[reference + 1] = values[k]; /* `acceleration` */
        } else if (text_equal(unit->layout.reals[reference].declared->name, "acceleration")) {
            unit->real[reference + (size_t)orders[k]] = values[k]; /* its derivatives follow it */
        }
        if (unit->stale < COMPUTED) {
            unit->stale = COMPUTED;
        }
    }
    return STATUS_OK;
}

/* -- of outputs by time ---------------------------------------------------------------------- */

/* The first derivative of an output; 0, as both standards have it, where the unit does not know it. */
static int derivative_of(Unit *unit, size_t reference, double *value)
{
    const size_t block = signal_values(unit).count;
    Range signals = unit->layout.computed, both = signals; /* their slopes stand behind them */
    signals.count = block;
    both.count = 2 * block;
    *value = within(reference, signals) ? unit->real[reference + block] : 0.0;
    return within(reference, both) ? 0 : unit->equations->slope(unit, reference, value);
}

Status unit_get_derivatives(Unit *unit, const unsigned *references, size_t count,
                            const int *orders, double *values)
{
    const char *what = "reading an output's derivative failed";
    const Range outputs = outputs_of(&unit->layout);
    size_t k;
    if (!unit->equations->slope) {
        return unit_refuse(unit, what, "a composite has none");
    }
    if (unit_refresh(unit, OBSERVED)) {
        return unit_report(unit, STATUS_ERROR, what);
    }
    for (k = 0; k < count; k++) {
        const int known = references[k] < unit->layout.real_count;
        if (!within(references[k], outputs) || orders[k] != 1) {
            return refuse_reference(unit, references[k], what,
                                    known && orders[k] != 1
                                        ? ": the order of an output's derivative must be 1"
                                        : ": is no output");
        }
        if (derivative_of(unit, references[k], values + k)) {
            return unit_report(unit, STATUS_ERROR, what);
        }
    }
    return STATUS_OK;
}

/* -- of outputs by inputs and parameters -------------------------------------------------------------------- */

/* How far beside an input the outputs are computed: where they are cubics of it, as most are,
   differences of order 4 are exact, and err by rounding the less the farther.  Elsewhere they err by
   1e-13 within a thousandth. */
static double reach_of(const Unit *unit, size_t input)
{
    const char *name = unit->layout.reals[input].declared->name;
    const double size = larger(1.0, absolute(unit->real[input]));
    if (within(input, unit->layout.parameters)) {
        return PARAMETER_REACH * (unit->real[input] != 0.0 ? absolute(unit->real[input]) : 1.0);
    }
    if (unit->equations->reach) {
        return unit->equations->reach(unit, input);
    }
    return text_equal(name, "angle") ? 1e-3 : text_equal(name, "plane[#].added_mass") ? 1e-3 * size : size;
}

/* Add so many times the outputs with an input `by` more to unit->beside. */
static int add_beside(Unit *unit, size_t input, double by, double times)
{
    const Range outputs = outputs_of(&unit->layout);
    const double present = unit->real[input];
    size_t k;
    int wrong;
    memcpy(unit->memory, unit->before, unit->memory_count * sizeof(double));
    unit->stale = within(input, unit->layout.parameters) ? BEGINNING : COMPUTED;
    unit->real[input] = present + by;
    wrong = unit_refresh(unit, FRESH);
    unit->real[input] = present;
    for (k = 0; k < outputs.count && !wrong; k++) {
        unit->beside[k] += times * unit->real[outputs.first + k];
    }
    return wrong;
}

/* The same with a parameter: of points ahead alone where one behind is not allowed.  0 for one that may
   not move, such as the number of a support or the place of a station. */
static int add_parameter_beside(Unit *unit, size_t parameter, double reach)
{
    static const double ahead[] = {-22.0, 36.0, -18.0, 4.0}, around[] = {1.0, -8.0, 8.0, -1.0};
    const size_t count = outputs_of(&unit->layout).count;
    const double present = unit->real[parameter];
    Text problem = text_in(unit->message_buffer, sizeof unit->message_buffer);
    const int one_sided = layout_problem(&unit->layout, parameter, present - 2.0 * reach, &problem);
    int k;
    memset(unit->beside, 0, count * sizeof(double));
    for (k = 0; k < 4; k++) {
        const double by = one_sided ? k : k < 2 ? k - 2 : k - 1;
        if (add_beside(unit, parameter, by * reach, one_sided ? ahead[k] : around[k])) {
            return 0;
        }
    }
    return 1;
}

/* Add the change of all outputs by an input or parameter to unit->change. */
static int add_change(Unit *unit, size_t input, double seed)
{
    const double reach = reach_of(unit, input);
    const size_t count = outputs_of(&unit->layout).count;
    size_t k;
    memset(unit->beside, 0, count * sizeof(double));
    if (!(reach > 0.0)) {
        return 0;
    }
    if (within(input, unit->layout.parameters)) {
        if (!add_parameter_beside(unit, input, reach)) {
            memset(unit->beside, 0, count * sizeof(double));
        }
    } else if (add_beside(unit, input, reach, 8.0) || add_beside(unit, input, -reach, -8.0) ||
        add_beside(unit, input, 2.0 * reach, -1.0) || add_beside(unit, input, -2.0 * reach, 1.0)) {
        return 1;
    }
    for (k = 0; k < count; k++) {
        unit->change[k] += seed * (unit->beside[k] / (12.0 * reach));
    }
    return 0;
}

/* Change of all outputs by the inputs, in unit->change; what a step has left to be read stays. */
static int find_change(Unit *unit, const unsigned *knowns, size_t count, const double *seed)
{
    const Range outputs = outputs_of(&unit->layout);
    const size_t size = outputs.count * sizeof(double);
    const size_t memory = unit->memory_count * sizeof(double);
    int wrong, stale = unit->stale;
    size_t k;
    memcpy(unit->saved_outputs, unit->real + outputs.first, size);
    memcpy(unit->before, unit->memory, memory);
    memset(unit->change, 0, size);
    unit->stale = COMPUTED;
    wrong = unit_refresh(unit, FRESH);
    unit->frozen = 1;
    for (k = 0; k < count && !wrong; k++) {
        if (seed[k] != 0.0) {
            wrong = add_change(unit, knowns[k], seed[k]);
            stale = within(knowns[k], unit->layout.parameters) ? BEGINNING : stale;
        }
    }
    memcpy(unit->real + outputs.first, unit->saved_outputs, size);
    memcpy(unit->memory, unit->before, memory);
    unit->stale = stale;
    unit->frozen = 0;
    return wrong;
}

/* Why these are no outputs and inputs, or NULL. */
static const char *wrong_sides(const Unit *unit, Range outputs, const unsigned *unknowns,
                               size_t unknown_count, const unsigned *knowns, size_t known_count)
{
    size_t k;
    if (unit->equations == &COMPOSITE_EQUATIONS) {
        return "a composite has no directional derivatives";
    }
    for (k = 0; k < known_count; k++) {
        if (!within(knowns[k], unit->layout.inputs) &&
            !(unit->phase == INITIALISING && within(knowns[k], unit->layout.parameters))) {
            return "knowns must be inputs, before the end of initialisation also parameters";
        }
    }
    for (k = 0; k < unknown_count; k++) {
        if (!within(unknowns[k], outputs)) {
            return "unknowns must be outputs";
        }
    }
    return NULL;
}

Status unit_directional(Unit *unit, const unsigned *unknowns, size_t unknown_count,
                        const unsigned *knowns, size_t known_count, const double *seed,
                        double *change)
{
    const char *what = "a directional derivative failed";
    const Range outputs = outputs_of(&unit->layout);
    const char *wrong =
        wrong_sides(unit, outputs, unknowns, unknown_count, knowns, known_count);
    size_t k;
    if (wrong) {
        return unit_refuse(unit, what, wrong);
    }
    if (unit_refresh(unit, COMPUTED) || find_change(unit, knowns, known_count, seed)) {
        return unit_report(unit, STATUS_ERROR, what);
    }
    for (k = 0; k < unknown_count; k++) {
        change[k] = unit->change[unknowns[k] - outputs.first];
    }
    return STATUS_OK;
}
