#include "fmi/state.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { CHECKSUM_SIZE = 8 };

/* The token says unit, sizes and build, and with them how much there is from `values` on: all that is from
   unit->real on.  Serialised it is the same bytes on every platform, as all of them store the lowest byte
   first, with a checksum behind. */
typedef struct {
    char token[TOKEN_SIZE];
    double time, time_left, start, point;
    int32_t phase, stale;
    double values[1];
} State;

/* Bytes of a state. */
static size_t state_size(const Unit *unit)
{
    return offsetof(State, values) + unit_values_size(unit);
}

/* STATUS_OK when there are an instance and what it was given. */
static Status check_given(Unit *unit, const void *given, const char *what)
{
    return !unit ? STATUS_ERROR : given ? STATUS_OK : unit_refuse(unit, what, "an array is missing");
}

/* STATUS_OK when this is a state of this unit. */
static Status check_state(Unit *unit, const State *state, const char *what)
{
    Status status = check_given(unit, state, what);
    if (!status && !text_equal(state->token, unit->token)) {
        status = unit_refuse(unit, what, "the state belongs to '%s', not to '%s'", state->token,
                             unit->token);
    }
    return status;
}

Status unit_free_state(Unit *unit, void **state)
{
    if (unit && state) {
        free(*state);
        *state = NULL;
    }
    return unit ? STATUS_OK : STATUS_ERROR;
}

Status unit_save(Unit *unit, void **state)
{
    const char *what = "saving the state failed";
    State *saved;
    if (check_given(unit, state, what) || (*state && check_state(unit, *state, what))) {
        return STATUS_ERROR;
    }
    *state = saved = *state ? *state : calloc(1, state_size(unit));
    if (!saved) {
        return unit_refuse(unit, what, "not enough memory");
    }
    memcpy(saved->token, unit->token, sizeof saved->token);
    saved->time = unit->time;
    saved->time_left = unit->time_left;
    saved->start = unit->start;
    saved->point = unit->point;
    saved->phase = unit->phase;
    saved->stale = unit->stale;
    memcpy(saved->values, unit->real, unit_values_size(unit));
    return STATUS_OK;
}

Status unit_restore(Unit *unit, const void *given)
{
    const char *what = "restoring a state failed";
    const State *state = given;
    const unsigned char *flags;
    int parameters_changed;
    if (check_state(unit, state, what)) {
        return STATUS_ERROR;
    }
    flags = (const unsigned char *)state->values + (unit->boolean - (unsigned char *)unit->real);
    parameters_changed =
        unit->stale == BEGINNING || memcmp(unit->boolean, flags, unit->layout.boolean_count) ||
        memcmp(unit->real, state->values, unit->layout.parameters.count * sizeof(double));
    unit->time = state->time;
    unit->time_left = state->time_left;
    unit->start = state->start;
    unit->point = state->point;
    unit->phase = state->phase;
    unit->stale = state->stale;
    memcpy(unit->real, state->values, unit_values_size(unit));
    if (parameters_changed && unit->stale < BEGINNING && unit->equations->parameters(unit)) {
        return unit_report(unit, STATUS_ERROR, what);
    }
    return STATUS_OK;
}

/* -- as bytes ------------------------------------------------------------------------------- */

Status unit_measure_state(Unit *unit, const void *state, size_t *size)
{
    const char *what = "measuring a state failed";
    if (check_given(unit, state, what) || check_given(unit, size, what)) {
        return STATUS_ERROR;
    }
    *size = state_size(unit) + CHECKSUM_SIZE;
    return STATUS_OK;
}

Status unit_serialise(Unit *unit, const void *state, unsigned char *bytes, size_t size)
{
    const char *what = "serialising a state failed";
    uint64_t checksum;
    size_t content;
    if (check_state(unit, state, what) || check_given(unit, bytes, what)) {
        return STATUS_ERROR;
    }
    content = state_size(unit);
    if (size < content + CHECKSUM_SIZE) {
        return unit_refuse(unit, what, "there are too few bytes for it");
    }
    memcpy(bytes, state, content);
    checksum = hash_bytes(bytes, content);
    memcpy(bytes + content, &checksum, CHECKSUM_SIZE);
    return STATUS_OK;
}

Status unit_deserialise(Unit *unit, const unsigned char *bytes, size_t size, void **state)
{
    const char *what = "reading a serialised state failed";
    const size_t content = size - CHECKSUM_SIZE;
    uint64_t checksum = 0;
    if (check_given(unit, bytes, what) || check_given(unit, state, what)) {
        return STATUS_ERROR;
    }
    if (size >= sizeof(State)) {
        memcpy(&checksum, bytes + content, CHECKSUM_SIZE);
    }
    if (size < sizeof(State) || checksum != hash_bytes(bytes, content)) {
        return unit_refuse(unit, what, "the bytes are damaged, or are not those of such a state");
    }
    if (check_state(unit, (const State *)(const void *)bytes, what)) {
        return STATUS_ERROR;
    }
    if (content != state_size(unit)) {
        return unit_refuse(unit, what, "there are too many bytes, or too few");
    }
    if (unit_save(unit, state)) {
        return STATUS_ERROR;
    }
    memcpy(*state, bytes, content);
    return STATUS_OK;
}
