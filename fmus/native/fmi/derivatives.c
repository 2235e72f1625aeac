/* Derivatives as FMI asks for them: of inputs and outputs by time, and of outputs by inputs. */
#include <string.h>

#include "base/elementary.h"
#include "base/signals.h"
#include "fmi/unit.h"

/* The signal inputs' values, of which the derivatives follow in blocks of the same size. */
static Range signal_values(const Unit *unit)
{
    Range range;
    range.count = unit->equations->signals(&unit->layout, &range.first);
    return range;
}

static int within(size_t reference, Range range)
{
    return reference - range.first < range.count;
}

/* -- of inputs by time ----------------------------------------------------------------------- */

/* Reason for refusing the derivative of an input, or NULL. */
static const char *wrong_derivative(const Unit *unit, size_t reference, int order, double value)
{
    const Range values = signal_values(unit);
    const int highest = unit->layout.sizes.order;
    Range signals = values;
    signals.count *= (size_t)highest + 1;
    if (!within(reference, unit->layout.inputs)) {
        return ": is no input";
    }
    if (order < 1 || order > highest) {
        return highest == 5 ? ": the order of a derivative must be 1 to 5"
                            : ": the order of a derivative must be 1 to 3";
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
            Text *reason = unit_reason(unit);
            if (references[k] < unit->layout.real_count) {
                layout_name(&unit->layout, references[k], reason);
            } else {
                text_integer(reason, references[k]);
            }
            text_put(reason, wrong);
            return unit_report(unit, STATUS_ERROR, "setting an input's derivative failed");
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

/* The first derivative of an output; 1 when the unit has none. */
static int derivative_of(Unit *unit, size_t reference, double *value)
{
    Range signals = unit->layout.computed;
    signals.count = signal_values(unit).count;
    if (within(reference, signals)) {
        *value = unit->real[reference + signals.count];
        return 0;
    }
    if (reference < signals.first + (size_t)(unit->layout.sizes.order + 1) / 2 * signals.count) {
        return 1;
    }
    return unit->equations->slope(unit, reference, value);
}

Status unit_get_derivatives(Unit *unit, const unsigned *references, size_t count,
                            const int *orders, double *values)
{
    const char *what = "reading an output's derivative failed";
    size_t k;
    if (unit_refresh(unit, OBSERVED)) {
        return unit_report(unit, STATUS_ERROR, what);
    }
    for (k = 0; k < count; k++) {
        const int known = references[k] < unit->layout.real_count;
        if (!known || orders[k] != 1 || derivative_of(unit, references[k], values + k)) {
            Text *reason = unit_reason(unit);
            if (known) {
                layout_name(&unit->layout, references[k], reason);
            } else {
                text_integer(reason, references[k]);
            }
            text_put(reason, known && orders[k] != 1
                                 ? ": the order of an output's derivative must be 1"
                                 : ": has no derivative to be read");
            return unit_report(unit, STATUS_ERROR, what);
        }
    }
    return STATUS_OK;
}

/* -- of outputs by inputs -------------------------------------------------------------------- */

/* The equations' answer with the outputs of the inputs as they are; what a step has left to be
   read stays. */
static int refresh_response(Unit *unit)
{
    const Range computed = unit->layout.computed;
    const size_t size = computed.count * sizeof(double);
    const size_t memory = unit->memory_count * sizeof(double);
    double *outputs = unit->real + computed.first;
    const int stale = unit->stale;
    int wrong;
    memcpy(unit->kept, outputs, size);
    memcpy(unit->before, unit->memory, memory);
    unit->stale = COMPUTED;
    wrong = unit_refresh(unit, OBSERVED) ||
            unit->equations->directional(unit, unit->seed, unit->change);
    memcpy(outputs, unit->kept, size);
    memcpy(unit->memory, unit->before, memory);
    unit->stale = stale;
    return wrong;
}

/* Why these are no outputs and inputs, or NULL. */
static const char *wrong_sides(const Unit *unit, Range outputs, const unsigned *unknowns,
                               size_t unknown_count, const unsigned *knowns, size_t known_count)
{
    size_t k;
    if (unit->layout.sizes.order != 3) {
        return "a unit with signals of order 5 gives none";
    }
    for (k = 0; k < known_count; k++) {
        if (!within(knowns[k], unit->layout.inputs)) {
            return "knowns must be inputs";
        }
    }
    for (k = 0; k < unknown_count; k++) {
        if (!within(unknowns[k], outputs)) {
            return "unknowns must be outputs";
        }
    }
    return NULL;
}

static Range outputs_of(const Layout *layout)
{
    Range outputs;
    outputs.first = layout->computed.first;
    outputs.count = layout->real_count - outputs.first;
    return outputs;
}

Status unit_directional(Unit *unit, const unsigned *unknowns, size_t unknown_count,
                        const unsigned *knowns, size_t known_count, const double *seed,
                        double *change)
{
    const char *what = "a directional derivative failed";
    const Range inputs = unit->layout.inputs, outputs = outputs_of(&unit->layout);
    const char *wrong =
        wrong_sides(unit, outputs, unknowns, unknown_count, knowns, known_count);
    size_t k;
    if (wrong) {
        return unit_refuse(unit, what, wrong);
    }
    memset(unit->seed, 0, inputs.count * sizeof(double));
    for (k = 0; k < known_count; k++) {
        unit->seed[knowns[k] - inputs.first] += seed[k];
    }
    if (unit_refresh(unit, COMPUTED) || refresh_response(unit)) {
        return unit_report(unit, STATUS_ERROR, what);
    }
    for (k = 0; k < unknown_count; k++) {
        change[k] = unit->change[unknowns[k] - outputs.first];
    }
    return STATUS_OK;
}
