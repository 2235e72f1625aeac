#include "fmi/state.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "base/elementary.h"

enum { CHECKSUM_SIZE = 8 };

/* The token says unit, sizes and build, and with them how much there is from `values` on: all that is from
   unit->real on.  Serialised it is the same bytes on every platform, as all of them store the lowest byte
   first, with a checksum behind. */
typedef struct {
    double time, time_left, start, point;
    int32_t phase, stale;
} Moment;

typedef struct {
    char token[TOKEN_SIZE];
    Moment moment;
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

/* STATUS_OK when a state with this token is one of this unit. */
static Status check_token(Unit *unit, const char *token, const char *what)
{
    return text_equal(token, unit->token)
               ? STATUS_OK
               : unit_refuse(unit, what, "the state belongs to '%s', not to '%s'", token, unit->token);
}

static Status check_state(Unit *unit, const State *state, const char *what)
{
    const Status status = check_given(unit, state, what);
    return status ? status : check_token(unit, state->token, what);
}

Status unit_free_state(Unit *unit, void **state)
{
    if (unit && state) {
        free(*state);
        *state = NULL;
    }
    return unit ? STATUS_OK : STATUS_ERROR;
}

static Moment moment_of(const Unit *unit)
{
    const Moment moment = {unit->time,  unit->time_left, unit->start,
                           unit->point, unit->phase,     unit->stale};
    return moment;
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
    saved->moment = moment_of(unit);
    memcpy(saved->values, unit->real, unit_values_size(unit));
    return STATUS_OK;
}

/* The Booleans in a state. */
static const unsigned char *flags_of(const Unit *unit, const State *state)
{
    return (const unsigned char *)state->values + (unit->boolean - (unsigned char *)unit->real);
}

/* Go on from these values; 1 with the reason where the parameters do not fit together.  `anew`: with
   parameters other than the present ones. */
static int take_over(Unit *unit, const Moment *moment, const double *values, int anew)
{
    unit->time = moment->time;
    unit->time_left = moment->time_left;
    unit->start = moment->start;
    unit->point = moment->point;
    unit->phase = moment->phase;
    /* what outputs were observed by beside the memory is of another state */
    unit->stale = moment->stale < OBSERVED ? OBSERVED : moment->stale;
    memcpy(unit->real, values, unit_values_size(unit));
    if (!anew || unit->stale == BEGINNING) {
        return 0;
    }
    if (unit->equations->parameters(unit)) {
        return 1;
    }
    /* to make the equations may have changed values that they had when the state was saved */
    memcpy(unit->real, values, unit_values_size(unit));
    return 0;
}

Status unit_restore(Unit *unit, const void *given)
{
    const char *what = "restoring a state failed";
    const State *state = given;
    const Moment before = moment_of(unit);
    int parameters_changed;
    if (check_state(unit, state, what)) {
        return STATUS_ERROR;
    }
    parameters_changed =
        before.stale == BEGINNING ||
        memcmp(unit->boolean, flags_of(unit, state), unit->layout.boolean_count) ||
        memcmp(unit->real, state->values, unit->layout.parameters.count * sizeof(double));
    memcpy(unit->kept, unit->real, unit_values_size(unit));
    if (take_over(unit, &state->moment, state->values, parameters_changed)) {
        const Status status = unit_report(unit, STATUS_ERROR, what);
        take_over(unit, &before, unit->kept, 1); /* which fit together before */
        return status;
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

/* 0, or 1 with the reason where a state is not one that unit_save can make: of these forged ones alone
   are damaged, as the checksum is right. */
static int holds_more_than_allowed(Unit *unit, const State *state)
{
    const Layout *layout = &unit->layout;
    const double *memory = state->values + layout->real_count;
    const unsigned char *flags = flags_of(unit, state);
    const Moment *moment = &state->moment;
    const int32_t phase = moment->phase;
    Fields fields;
    size_t k;
    if (!is_finite(moment->time + moment->time_left + moment->start + moment->point)) {
        return unit_fail(unit, "time = %v s: must be a finite number", moment->point);
    }
    if ((phase != INSTANTIATED && phase != INITIALISING && phase != RUNNING && phase != TERMINATED) ||
        moment->stale < FRESH || moment->stale > BEGINNING ||
        (moment->stale == BEGINNING && phase >= RUNNING)) {
        return unit_fail(unit, "the phase of the instance is none");
    }
    for (k = 0; k < layout->boolean_count; k++) {
        if (flags[k] > 1) {
            return unit_fail(unit, "%s: must be true or false", layout->table->flags[k].name);
        }
    }
    if (unit_check(unit, NULL, layout->inputs.first + layout->inputs.count, state->values)) {
        return 1;
    }
    fields = fields_of(memory, unit->memory_count, state->values, unit_reason(unit));
    if (moment->stale == BEGINNING || !unit->equations->fields) {
        fields_any(&fields, memory, unit->memory_count); /* which begin sets */
    } else {
        unit->equations->fields(unit, &fields);
    }
    return fields_wrong(&fields);
}

Status unit_deserialise(Unit *unit, const unsigned char *bytes, size_t size, void **state)
{
    const char *what = "reading a serialised state failed";
    const size_t content = size - CHECKSUM_SIZE;
    uint64_t checksum = 0;
    char token[TOKEN_SIZE];
    State *read;
    if (check_given(unit, bytes, what) || check_given(unit, state, what)) {
        return STATUS_ERROR;
    }
    if (size >= sizeof(State)) {
        memcpy(&checksum, bytes + content, CHECKSUM_SIZE);
    }
    if (size < sizeof(State) || checksum != hash_bytes(bytes, content)) {
        return unit_refuse(unit, what, "the bytes are damaged, or are not those of such a state");
    }
    memcpy(token, bytes, sizeof token);
    token[TOKEN_SIZE - 1] = 0;
    if (check_token(unit, token, what) || (*state && check_state(unit, *state, what))) {
        return STATUS_ERROR;
    }
    if (content != state_size(unit)) {
        return unit_refuse(unit, what, "there are too many bytes, or too few");
    }
    read = calloc(1, content);
    if (!read) {
        return unit_refuse(unit, what, "not enough memory");
    }
    memcpy(read, bytes, content);
    if (read->moment.stale == BEGINNING) { /* its memory means nothing yet */
        memset(read->values + unit->layout.real_count, 0, unit->memory_count * sizeof(double));
    }
    if (holds_more_than_allowed(unit, read)) {
        free(read);
        return unit_report(unit, STATUS_ERROR, what);
    }
    free(*state);
    *state = read;
    return STATUS_OK;
}
