#include "fmi/state.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "base/elementary.h"

enum { STATE_MAGIC = 0x41425354, STATE_VERSION = 1, CHECKSUM_SIZE = 8 };

/* The values: Reals, then Booleans as 0 or 1, then the equations' memory.  Serialised it is the same
   bytes on every platform, as all of them store the lowest byte first, with a checksum behind. */
typedef struct {
    uint32_t magic, version;
    char token[TOKEN_SIZE];
    uint64_t count;
    double time;
    int32_t phase, stale;
    double values[1];
} State;

/* -- a state -------------------------------------------------------------------------------- */

static size_t count_values(const Unit *unit)
{
    return unit->layout.real_count + unit->layout.boolean_count + unit->memory_count;
}

/* STATUS_OK when this is a state of this unit. */
static Status check_state(Unit *unit, const State *state, const char *what)
{
    if (!state) {
        return unit_refuse(unit, what, "there is no state");
    }
    if (state->magic != STATE_MAGIC || state->version != STATE_VERSION) {
        return unit_refuse(unit, what, "this is no state of such a unit");
    }
    if (!text_equal(state->token, unit->token)) {
        return unit_refuse(unit, what, "the state belongs to '%s', not to '%s'", state->token,
                           unit->token);
    }
    return STATUS_OK;
}

void unit_free_state(void **state)
{
    if (*state) {
        ((State *)*state)->magic = 0;
        free(*state);
        *state = NULL;
    }
}

Status unit_save(Unit *unit, void **state)
{
    const char *what = "saving the state failed";
    State *saved = *state;
    double *at;
    size_t k;
    if (saved && check_state(unit, saved, what)) {
        return STATUS_ERROR;
    }
    saved = saved ? saved : calloc(1, sizeof *saved + count_values(unit) * sizeof(double));
    if (!saved) {
        return unit_refuse(unit, what, "not enough memory");
    }
    saved->magic = STATE_MAGIC;
    saved->version = STATE_VERSION;
    memcpy(saved->token, unit->token, sizeof saved->token);
    saved->count = count_values(unit);
    saved->time = unit->time;
    saved->phase = unit->phase;
    saved->stale = unit->stale;
    at = saved->values;
    memcpy(at, unit->real, unit->layout.real_count * sizeof(double));
    at += unit->layout.real_count;
    for (k = 0; k < unit->layout.boolean_count; k++) {
        *at++ = unit->boolean[k];
    }
    memcpy(at, unit->memory, unit->memory_count * sizeof(double));
    *state = saved;
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

static void copy_state(Unit *unit, const State *state)
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

Status unit_restore(Unit *unit, const void *given)
{
    const char *what = "restoring a state failed";
    const State *state = given;
    Status status = check_state(unit, state, what);
    void *before = NULL;
    int parameters_changed;
    if (status) {
        return status;
    }
    parameters_changed = unit->stale == BEGINNING || !same_parameters(unit, state->values);
    if (!parameters_changed || state->stale == BEGINNING) {
        copy_state(unit, state);
        return STATUS_OK;
    }
    if (unit_save(unit, &before)) {
        return STATUS_ERROR;
    }
    copy_state(unit, state);
    if (unit->equations->parameters(unit)) {
        status = unit_report(unit, STATUS_ERROR, what);
        copy_state(unit, before);
        if (unit->stale < BEGINNING) {
            unit->equations->parameters(unit); /* as they were: they were accepted once */
        }
    }
    unit_free_state(&before);
    return status;
}

/* -- as bytes ------------------------------------------------------------------------------- */

size_t unit_state_size(const Unit *unit)
{
    return offsetof(State, values) + count_values(unit) * sizeof(double) + CHECKSUM_SIZE;
}

Status unit_serialise(Unit *unit, const void *state, unsigned char *bytes, size_t size)
{
    const char *what = "serialising a state failed";
    const size_t content = unit_state_size(unit) - CHECKSUM_SIZE;
    uint64_t checksum;
    if (check_state(unit, state, what)) {
        return STATUS_ERROR;
    }
    if (size < unit_state_size(unit)) {
        return unit_refuse(unit, what, "there are too few bytes for it");
    }
    memcpy(bytes, state, content);
    checksum = hash_bytes(hash_start(), bytes, content);
    memcpy(bytes + content, &checksum, CHECKSUM_SIZE);
    return STATUS_OK;
}

/* 0, or 1 and why bytes with a right checksum are no state all the same. */
static int has_wrong_content(Unit *unit, const State *state)
{
    const int phase = state->phase;
    const double *memory = state->values + count_values(unit) - unit->memory_count;
    size_t k;
    if (state->count != count_values(unit) ||
        (phase != INSTANTIATED && phase != INITIALISING && phase != RUNNING &&
         phase != TERMINATED) ||
        state->stale < FRESH || state->stale > BEGINNING) {
        return unit_fail(unit, "the bytes are no state of this unit");
    }
    if (!is_finite(state->time)) {
        return unit_fail(unit, "the bytes hold a time that is not finite");
    }
    for (k = 0; k < unit->layout.computed.first; k++) {
        if (layout_problem(&unit->layout, k, state->values[k], unit_reason(unit))) {
            return 1;
        }
    }
    /* outputs are computed anew before they are read, and may be what a failed step left */
    for (k = unit->layout.real_count; k < state->count; k++) {
        if (!is_finite(state->values[k])) {
            return unit_fail(unit, "the bytes hold numbers that are not finite");
        }
    }
    if (state->stale < COMPUTED && unit->equations->stands_at &&
        !unit->equations->stands_at(memory, state->time)) {
        return unit_fail(unit, "the bytes hold a time that is not that of their motion");
    }
    return 0;
}

Status unit_deserialise(Unit *unit, const unsigned char *bytes, size_t size, void **state)
{
    const char *what = "reading a serialised state failed";
    const size_t content = size - CHECKSUM_SIZE;
    uint64_t checksum = 0;
    void *made;
    Status status;
    if (*state && check_state(unit, *state, what)) {
        return STATUS_ERROR;
    }
    if (size >= sizeof(State)) {
        memcpy(&checksum, bytes + content, CHECKSUM_SIZE);
    }
    if (size < sizeof(State) || checksum != hash_bytes(hash_start(), bytes, content)) {
        return unit_refuse(unit, what, "the bytes are damaged, or are not those of such a state");
    }
    made = calloc(1, size);
    if (!made) {
        return unit_refuse(unit, what, "not enough memory");
    }
    memcpy(made, bytes, content);
    ((State *)made)->token[TOKEN_SIZE - 1] = 0;
    ((State *)made)->count = size == unit_state_size(unit) ? ((State *)made)->count : 0;
    status = check_state(unit, made, what);
    if (!status && has_wrong_content(unit, made)) {
        status = unit_report(unit, STATUS_ERROR, what);
    }
    if (status) {
        unit_free_state(&made);
        return status;
    }
    unit_free_state(state);
    *state = made;
    return STATUS_OK;
}
