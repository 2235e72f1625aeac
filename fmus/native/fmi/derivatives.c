/* Derivatives as FMI asks for them: of inputs and outputs by time, and of outputs by inputs. */
#include <string.h>

#include "base/elementary.h"
#include "fmi/unit.h"

/* Part of a parameter by which it is moved: a difference of order 4 then errs by 1e-12. */
static const double PARAMETER_REACH = 1e-3;

static Range outputs_of(const Layout *layout)
{
    Range outputs;
    outputs.first = layout->computed.first;
    outputs.count = layout->real_count - outputs.first;
    return outputs;
}

static bool within(size_t reference, Range range)
{
    return reference - range.first < range.count;
}

/* -- of inputs by time ----------------------------------------------------------------------- */

/* Number of the signals among inputs or outputs; the first of the inputs. */
static size_t signal_count(const Unit *unit, size_t *first)
{
    *first = 0;
    return unit->equations->signals ? unit->equations->signals(&unit->layout, first) : 0;
}

/* Value reference of the input that holds a derivative of another; of one that is taken at the start of
   a step, and needs none, its own. */
static size_t derivative_input(const Unit *unit, size_t reference, int order)
{
    const char *name = unit->layout.reals[reference].declared->name;
    size_t first, count = signal_count(unit, &first);
    if (reference - first < count) {
        return reference + (size_t)order * count;
    }
    if (text_equal(name, "acceleration")) { /* a composite's is the same over a step */
        const char *behind = unit->layout.reals[reference + 1].declared->name;
        return text_equal(behind, "der(acceleration)") ? reference + (size_t)order : reference;
    }
    return text_equal(name, "speed") && order == 1 ? reference + 1 : reference;
}

Status unit_set_derivatives(Unit *unit, const unsigned *references, size_t count,
                            const int *orders, const double *values)
{
    const char *what = "setting an input's derivative failed";
    size_t k;
    for (k = 0; k < count; k++) {
        if (!within(references[k], unit->layout.inputs)) {
            return unit_refuse(unit, what, "value reference %u: is no input", (unsigned long)references[k]);
        }
        if (text_after(unit->layout.reals[references[k]].declared->name, "der(")) {
            return unit_refuse(unit, what, "value reference %u: is a derivative itself",
                               (unsigned long)references[k]);
        }
        if (orders[k] < 1 || orders[k] >= SIGNAL_ORDERS) {
            return unit_refuse(unit, what, "the order of an input's derivative must be 1 to 3");
        }
        if (!is_finite(values[k])) {
            return unit_refuse(unit, what, "an input's derivative must be a finite number");
        }
    }
    for (k = 0; k < count; k++) {
        const size_t target = derivative_input(unit, references[k], orders[k]);
        if (target != references[k]) {
            unit->real[target] = values[k];
        }
    }
    unit->stale = unit->stale < COMPUTED ? COMPUTED : unit->stale;
    return STATUS_OK;
}

/* -- of outputs by time ---------------------------------------------------------------------- */

/* The first derivative of an output; 0, as both standards have it, where the unit does not know it. */
static int derivative_of(Unit *unit, size_t reference, double *value)
{
    size_t first, block = signal_count(unit, &first);
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
        if (!within(references[k], outputs)) {
            return unit_refuse(unit, what, "value reference %u: is no output", (unsigned long)references[k]);
        }
        if (orders[k] != 1) {
            return unit_refuse(unit, what, "the order of an output's derivative must be 1");
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
    size_t k;
    memcpy(unit->real, unit->kept, unit_values_size(unit));
    unit->stale = within(input, unit->layout.parameters) ? BEGINNING : COMPUTED;
    unit->real[input] += by;
    if (unit_refresh(unit, FRESH)) {
        return 1;
    }
    for (k = 0; k < outputs.count; k++) {
        unit->beside[k] += times * unit->real[outputs.first + k];
    }
    return 0;
}

/* The same with a parameter: of points ahead alone where one behind is not allowed.  1 for one that may
   not move, such as the number of a support or the place of a station. */
static int add_parameter_beside(Unit *unit, size_t parameter, double reach)
{
    static const double ahead[] = {-22.0, 36.0, -18.0, 4.0}, around[] = {1.0, -8.0, 8.0, -1.0};
    const int one_sided =
        !layout_allows(&unit->layout, parameter, unit->kept[parameter] - 2.0 * reach);
    int k;
    for (k = 0; k < 4; k++) {
        const double by = one_sided ? k : k < 2 ? k - 2 : k - 1;
        if (add_beside(unit, parameter, by * reach, one_sided ? ahead[k] : around[k])) {
            return 1;
        }
    }
    return 0;
}

/* Add the change of all outputs by an input or parameter to unit->change; none by a parameter that may
   not move. */
static int add_change(Unit *unit, size_t input, double seed)
{
    const bool is_parameter = within(input, unit->layout.parameters);
    const double reach = reach_of(unit, input);
    const size_t count = outputs_of(&unit->layout).count;
    size_t k;
    memset(unit->beside, 0, count * sizeof(double));
    if (!(reach > 0.0)) {
        return 0;
    }
    if (is_parameter ? add_parameter_beside(unit, input, reach)
                     : add_beside(unit, input, reach, 8.0) || add_beside(unit, input, -reach, -8.0) ||
                           add_beside(unit, input, 2.0 * reach, -1.0) ||
                           add_beside(unit, input, -2.0 * reach, 1.0)) {
        return !is_parameter;
    }
    for (k = 0; k < count; k++) {
        unit->change[k] += seed * (unit->beside[k] / (12.0 * reach));
    }
    return 0;
}

/* The equations of the parameters as they are, where others were tried. */
static int make_again(Unit *unit)
{
    memcpy(unit->real, unit->kept, unit_values_size(unit));
    return unit->equations->parameters(unit);
}

/* Change of all outputs by the inputs, in unit->change; what a step has left to be read stays. */
static int find_change(Unit *unit, const unsigned *knowns, size_t count, const double *seed)
{
    int wrong, stale = unit->stale;
    size_t k;
    memcpy(unit->kept, unit->real, unit_values_size(unit));
    memset(unit->change, 0, outputs_of(&unit->layout).count * sizeof(double));
    unit->stale = COMPUTED;
    wrong = unit_refresh(unit, FRESH);
    unit->frozen = true;
    for (k = 0; k < count && !wrong; k++) {
        memcpy(unit->real, unit->kept, unit_values_size(unit));
        if (seed[k] != 0.0) {
            const bool is_parameter = within(knowns[k], unit->layout.parameters);
            wrong = add_change(unit, knowns[k], seed[k]) || (is_parameter && make_again(unit));
            stale = is_parameter ? BEGINNING : stale;
        }
    }
    memcpy(unit->real, unit->kept, unit_values_size(unit));
    unit->stale = stale;
    unit->frozen = false;
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
