/* A unit's values: read and set, and refused with name, value and what is allowed. */
#include "base/elementary.h"
#include "constants.h"
#include "coupling/exchange.h"
#include "fmi/unit.h"

/* 0, or 1 and which of the value references are not within the known ones. */
static int unknown(Unit *unit, const unsigned *references, size_t count, size_t first,
                   size_t known)
{
    int wrong = 0;
    size_t k;
    for (k = 0; k < count; k++) {
        if (references[k] - first >= known) {
            Text *reason = wrong ? &unit->reason : unit_reason(unit);
            text_format(reason, "%s%u", wrong ? ", " : "value references [", (unsigned long)references[k]);
            wrong = 1;
        }
    }
    if (wrong && known) {
        text_format(&unit->reason, "]: unknown, there are %u to %u", (unsigned long)first,
                    (unsigned long)(first + known - 1));
    } else if (wrong) {
        text_put(&unit->reason, "]: unknown, there are none");
    }
    return wrong;
}

/* Whether it is a parameter that may be set between steps. */
static bool is_tunable(const Unit *unit, size_t reference)
{
    return unit->layout.reals[reference].declared->flags & TUNABLE;
}

/* 0, or 1 with the reason where one of these may not be tuned as things are. */
static int refuse_tuning(Unit *unit, const unsigned *references, size_t count, const double *values)
{
    int wrong = 0;
    size_t k;
    for (k = 0; k < count && unit->equations->untunable && !wrong; k++) {
        wrong = references[k] < unit->layout.inputs.first && unit->real[references[k]] != values[k] &&
                unit->equations->untunable(unit, references[k]);
    }
    return wrong;
}

/* 1 and the names of these variables, but the tunable ones, followed by why they are refused. */
static int refuse_values(Unit *unit, const unsigned *references, size_t count, Range range,
                         const char *why)
{
    int wrong = 0;
    size_t k;
    for (k = 0; k < count; k++) {
        if (references[k] - range.first < range.count && !is_tunable(unit, references[k])) {
            text_put(wrong ? &unit->reason : unit_reason(unit), wrong ? ", " : "");
            layout_name(&unit->layout, references[k], &unit->reason);
            wrong = 1;
        }
    }
    if (wrong) {
        text_put(&unit->reason, why);
    }
    return wrong;
}

/* How stale the outputs may be for a value to be read. */
static int level_of(const Unit *unit, size_t reference)
{
    const Equations *equations = unit->equations;
    return reference < unit->layout.computed.first   ? BEGINNING
           : reference < unit->layout.observed.first ? OBSERVED
           : equations->is_torque && equations->is_torque(unit, reference) ? FRESH
                                                                           : WITHOUT_TORQUES;
}

int unit_level(const Unit *unit, const unsigned *references, size_t count)
{
    int level = BEGINNING;
    size_t k;
    for (k = 0; k < count; k++) {
        const int needed = level_of(unit, references[k]);
        level = needed < level ? needed : level;
    }
    return level;
}

Status unit_read(Unit *unit, int level, const unsigned *references, size_t count, double *values)
{
    size_t k;
    if (unit->stale > level && unit_refresh(unit, level)) {
        return unit_report(unit, STATUS_ERROR, "reading failed");
    }
    for (k = 0; k < count; k++) {
        values[k] = unit->real[references[k]];
        if (!is_finite(values[k])) { /* of a finite state: speed times torque overflows */
            layout_shown(&unit->layout, references[k], values[k], unit_reason(unit));
            text_put(&unit->reason, ": is not finite; the motion is too fast or too large");
            return unit_report(unit, STATUS_ERROR, "reading failed");
        }
    }
    return STATUS_OK;
}

Status unit_get_reals(Unit *unit, const unsigned *references, size_t count, double *values)
{
    const size_t states = exchange_count(unit), indicators = exchange_indicators(unit);
    size_t k;
    for (k = 0; k < count; k++) { /* derivatives of states and indicators stand behind all that the layout has */
        const unsigned indicator = references[k] - FIRST_INDICATOR, derivative = references[k] - FIRST_DERIVATIVE;
        const bool is_indicator = indicator < indicators;
        if (is_indicator || derivative < states) {
            const Status status = unit_get_reals(unit, references, k, values);
            if (status) {
                return status;
            }
            if (is_indicator ? exchange_indicator(unit, indicator, values + k)
                             : exchange_derivative(unit, derivative, values + k)) {
                return STATUS_ERROR;
            }
            return unit_get_reals(unit, references + k + 1, count - k - 1, values + k + 1);
        }
    }
    if (unknown(unit, references, count, 0, unit->layout.real_count)) {
        return unit_report(unit, STATUS_ERROR, "reading failed");
    }
    return unit_read(unit, unit_level(unit, references, count), references, count, values);
}

/* 0, or 1 with the reason when these values may not be set now. */
static int not_settable(Unit *unit, const unsigned *references, size_t count,
                        const double *values)
{
    const Layout *layout = &unit->layout;
    Range outputs;
    outputs.first = layout->computed.first;
    outputs.count = layout->computed.count + layout->observed.count;
    return unknown(unit, references, count, 0, layout->real_count) ||
           refuse_values(unit, references, count, outputs, ": outputs cannot be set") ||
           (unit->phase == RUNNING && refuse_values(unit, references, count, layout->parameters,
                                                    ": fixed once initialisation has ended")) ||
           unit_check(unit, references, count, values) ||
           (unit->phase == RUNNING && refuse_tuning(unit, references, count, values));
}

Status unit_set_reals(Unit *unit, const unsigned *references, size_t count, const double *values)
{
    const Equations *equations = unit->equations;
    int tuned = 0;
    size_t k;
    if (not_settable(unit, references, count, values)) {
        return unit_report(unit, STATUS_ERROR, "setting failed");
    }
    for (k = 0; k < count; k++) {
        const bool is_parameter = references[k] < unit->layout.inputs.first;
        if (is_parameter && unit->phase != RUNNING) {
            unit->stale = BEGINNING;
        } else if (unit->stale < COMPUTED) {
            unit->stale = COMPUTED;
        }
        tuned |= is_parameter && unit->phase == RUNNING && unit->real[references[k]] != values[k];
        unit->real[references[k]] = values[k];
    }
    if (tuned && unit->stale < BEGINNING && (equations->tune ? equations->tune : equations->parameters)(unit)) {
        return unit_report(unit, STATUS_ERROR, "setting failed");
    }
    return STATUS_OK;
}

Status unit_get_boolean(Unit *unit, unsigned reference, int *value)
{
    const size_t settable = unit->layout.boolean_count;
    if (unknown(unit, &reference, 1, unit->first_boolean, (size_t)unit->layout.table->flag_count)) {
        return unit_report(unit, STATUS_ERROR, "reading failed");
    }
    if (reference - unit->first_boolean >= settable) {
        if (unit->stale > WITHOUT_TORQUES && unit_refresh(unit, WITHOUT_TORQUES)) {
            return unit_report(unit, STATUS_ERROR, "reading failed");
        }
        *value = unit->equations->verdict(unit);
        return STATUS_OK;
    }
    *value = unit->boolean[reference - unit->first_boolean];
    return STATUS_OK;
}

Status unit_set_boolean(Unit *unit, unsigned reference, int value)
{
    if (unknown(unit, &reference, 1, unit->first_boolean, unit->layout.boolean_count)) {
        return unit_report(unit, STATUS_ERROR, "setting failed");
    }
    if (unit->phase == RUNNING) {
        const Flag *flags = unit->layout.table->flags;
        return unit_refuse(unit, "setting failed", "%s: fixed once initialisation has ended",
                           flags[reference - unit->first_boolean].name);
    }
    unit->boolean[reference - unit->first_boolean] = value != 0;
    unit->stale = BEGINNING;
    return STATUS_OK;
}
