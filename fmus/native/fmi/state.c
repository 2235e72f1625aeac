#include "fmi/state.h"

#include <stdlib.h>
#include <string.h>

#include "base/elementary.h"

size_t state_value_count(const Unit *unit)
{
    return unit->layout.real_count + unit->layout.boolean_count + unit->memory_count;
}

Status state_check(Unit *unit, const State *state, const char *what)
{
    if (!state) {
        return unit_refuse(unit, what, "there is no state");
    }
    if (state->magic != STATE_MAGIC || state->version != STATE_VERSION) {
        return unit_refuse(unit, what, "this is no state of such a unit");
    }
    if (!text_equal(state->token, unit->token)) {
        Text *reason = unit_reason(unit);
        text_put(reason, "the state belongs to '");
        text_put(reason, state->token);
        text_put(reason, "', not to '");
        text_put(reason, unit->token);
        text_put(reason, "'");
        return unit_report(unit, STATUS_ERROR, what);
    }
    return STATUS_OK;
}

State *state_place(const Unit *unit, State *state)
{
    const size_t count = state_value_count(unit);
    if (!state) {
        state = calloc(1, sizeof *state + count * sizeof(double));
    }
    if (state) {
        state->magic = STATE_MAGIC;
        state->version = STATE_VERSION;
        state->count = count;
        memcpy(state->token, unit->token, sizeof state->token);
    }
    return state;
}

Status unit_save(Unit *unit, State **state)
{
    const char *what = "saving the state failed";
    State *made;
    double *at;
    size_t k;
    if (*state && state_check(unit, *state, what)) {
        return STATUS_ERROR;
    }
    made = state_place(unit, *state);
    if (!made) {
        return unit_refuse(unit, what, "not enough memory");
    }
    made->time = unit->time;
    made->phase = unit->phase;
    made->stale = unit->stale;
    at = made->values;
    memcpy(at, unit->real, unit->layout.real_count * sizeof(double));
    at += unit->layout.real_count;
    for (k = 0; k < unit->layout.boolean_count; k++) {
        *at++ = unit->boolean[k];
    }
    memcpy(at, unit->memory, unit->memory_count * sizeof(double));
    *state = made;
    return STATUS_OK;
}

/* True when the parameters are those of the values. */
static int same_parameters(const Unit *unit, const double *values)
{
    const double *flags = values + unit->layout.real_count;
    size_t k;
    for (k = 0; k < unit->layout.boolean_count; k++) {
        if ((unit->boolean[k] != 0) != (flags[k] != 0.0)) {
            return 0;
        }
    }
    return !memcmp(unit->real, values, unit->layout.parameters.count * sizeof(double));
}

static void take_state(Unit *unit, const State *state)
{
    const double *at = state->values;
    size_t k;
    unit->time = state->time;
    unit->phase = state->phase;
    unit->stale = state->stale;
    memcpy(unit->real, at, unit->layout.real_count * sizeof(double));
    at += unit->layout.real_count;
    for (k = 0; k < unit->layout.boolean_count; k++) {
        unit->boolean[k] = *at++ != 0.0;
    }
    memcpy(unit->memory, at, unit->memory_count * sizeof(double));
}

Status unit_restore(Unit *unit, const State *state)
{
    const char *what = "restoring a state failed";
    State *before = NULL;
    int other;
    if (state_check(unit, state, what)) {
        return STATUS_ERROR;
    }
    other = unit->stale == BEGINNING || !same_parameters(unit, state->values);
    if (!other || state->stale == BEGINNING) {
        take_state(unit, state);
        return STATUS_OK;
    }
    if (unit_save(unit, &before)) {
        return STATUS_ERROR;
    }
    take_state(unit, state);
    if (unit->equations->parameters(unit)) {
        const Status status = unit_report(unit, STATUS_ERROR, what);
        take_state(unit, before);
        if (unit->stale < BEGINNING) {
            unit->equations->parameters(unit); /* as they were: they were accepted once */
        }
        unit_forget(&before);
        return status;
    }
    unit_forget(&before);
    return STATUS_OK;
}

void unit_forget(State **state)
{
    if (*state) {
        (*state)->magic = 0;
        free(*state);
        *state = NULL;
    }
}
