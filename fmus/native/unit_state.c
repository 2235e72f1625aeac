#include "unit_state.h"

#include <stdlib.h>
#include <string.h>

#include "elementary.h"

enum { MAGIC = 0x41425354, VERSION = 1, TRAILER = 8 };

/* Reals, then Booleans as 0 or 1, then the equations' memory. */
struct State {
    uint32_t magic, version;
    char token[TOKEN_SIZE];
    double time;
    int phase, stale;
    size_t count;
    double values[1];
};

static size_t value_count(const Unit *unit)
{
    return unit->layout.real_count + unit->layout.boolean_count + unit->memory_count;
}

static Status refuse(Unit *unit, const char *what, const char *why)
{
    return unit_refuse(unit, what, why);
}

/* STATUS_OK when this is a state of this unit. */
static Status check(Unit *unit, const State *state, const char *what)
{
    if (!state) {
        return refuse(unit, what, "there is no state");
    }
    if (state->magic != MAGIC || state->version != VERSION) {
        return refuse(unit, what, "this is no state of such a unit");
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

/* An empty state, or the one that is to be overwritten; NULL when there is no memory. */
static State *place(const Unit *unit, State *state)
{
    const size_t count = value_count(unit);
    if (!state) {
        state = calloc(1, sizeof *state + count * sizeof(double));
    }
    if (state) {
        state->magic = MAGIC;
        state->version = VERSION;
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
    if (*state && check(unit, *state, what)) {
        return STATUS_ERROR;
    }
    made = place(unit, *state);
    if (!made) {
        return refuse(unit, what, "not enough memory");
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

static void take(Unit *unit, const State *state)
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
    if (check(unit, state, what)) {
        return STATUS_ERROR;
    }
    other = unit->stale == BEGINNING || !same_parameters(unit, state->values);
    if (!other || state->stale == BEGINNING) {
        take(unit, state);
        return STATUS_OK;
    }
    if (unit_save(unit, &before)) {
        return STATUS_ERROR;
    }
    take(unit, state);
    if (unit->equations->parameters(unit)) {
        const Status status = unit_report(unit, STATUS_ERROR, what);
        take(unit, before);
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

/* -- bytes, lowest first whatever the machine ------------------------------------------------ */

static void put_number(unsigned char **at, uint64_t value, int bytes)
{
    int k;
    for (k = 0; k < bytes; k++) {
        *(*at)++ = (unsigned char)(value >> 8 * k);
    }
}

static uint64_t take_number(const unsigned char **at, int bytes)
{
    uint64_t value = 0;
    int k;
    for (k = 0; k < bytes; k++) {
        value |= (uint64_t) * (*at)++ << 8 * k;
    }
    return value;
}

static void put_double(unsigned char **at, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_number(at, bits, 8);
}

static double take_double(const unsigned char **at)
{
    const uint64_t bits = take_number(at, 8);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

size_t unit_state_size(const Unit *unit)
{
    /* magic, version, token, count, time, phase, stale, values, checksum */
    return 4 + 4 + TOKEN_SIZE + 8 + 8 + 4 + 4 + 8 * value_count(unit) + TRAILER;
}

Status unit_serialise(Unit *unit, const State *state, unsigned char *bytes, size_t size)
{
    const char *what = "serialising a state failed";
    unsigned char *at = bytes;
    size_t k;
    if (check(unit, state, what)) {
        return STATUS_ERROR;
    }
    if (size < unit_state_size(unit)) {
        return refuse(unit, what, "there are too few bytes for it");
    }
    put_number(&at, state->magic, 4);
    put_number(&at, state->version, 4);
    memcpy(at, state->token, TOKEN_SIZE);
    at += TOKEN_SIZE;
    put_number(&at, state->count, 8);
    put_double(&at, state->time);
    put_number(&at, (uint64_t)state->phase, 4);
    put_number(&at, (uint64_t)state->stale, 4);
    for (k = 0; k < state->count; k++) {
        put_double(&at, state->values[k]);
    }
    put_number(&at, hash_bytes(hash_start(), bytes, (size_t)(at - bytes)), TRAILER);
    return STATUS_OK;
}

/* 0, or 1 and why bytes with a right checksum are no state all the same. */
static int wrong_content(Unit *unit, const State *state)
{
    const int phase = state->phase;
    const size_t computed = unit->layout.computed.first, real = unit->layout.real_count;
    Text *reason = unit_reason(unit);
    size_t k;
    if (state->count != value_count(unit) ||
        (phase != INSTANTIATED && phase != INITIALISING && phase != RUNNING &&
         phase != TERMINATED) ||
        state->stale < FRESH || state->stale > BEGINNING) {
        text_put(reason, "the bytes are no state of this unit");
        return 1;
    }
    if (!is_finite(state->time)) {
        text_put(reason, "the bytes hold a time that is not finite");
        return 1;
    }
    for (k = 0; k < computed; k++) {
        if (layout_problem(&unit->layout, k, state->values[k], reason)) {
            return 1;
        }
    }
    /* outputs are computed anew before they are read, and may be what a failed step left */
    for (k = real; k < state->count; k++) {
        if (!is_finite(state->values[k])) {
            text_put(reason, "the bytes hold numbers that are not finite");
            return 1;
        }
    }
    return 0;
}

Status unit_deserialise(Unit *unit, const unsigned char *bytes, size_t size, State **state)
{
    const char *what = "reading a serialised state failed";
    const size_t values = value_count(unit);
    const size_t expected = unit_state_size(unit), least = expected - 8 * values;
    const unsigned char *at = bytes, *checksum = bytes + (size < least ? 0 : size - TRAILER);
    State *made;
    size_t k;
    if (*state && check(unit, *state, what)) {
        return STATUS_ERROR;
    }
    if (size < least || take_number(&at, 4) != MAGIC || take_number(&at, 4) != VERSION ||
        take_number(&checksum, TRAILER) != hash_bytes(hash_start(), bytes, size - TRAILER)) {
        return refuse(unit, what, "the bytes are damaged, or are not those of such a state");
    }
    made = place(unit, NULL);
    if (!made) {
        return refuse(unit, what, "not enough memory");
    }
    memcpy(made->token, at, TOKEN_SIZE);
    made->token[TOKEN_SIZE - 1] = 0;
    at += TOKEN_SIZE;
    if (check(unit, made, what)) {
        unit_forget(&made);
        return STATUS_ERROR;
    }
    made->count = (size_t)take_number(&at, 8);
    made->time = take_double(&at);
    made->phase = (int)take_number(&at, 4);
    made->stale = (int)take_number(&at, 4);
    for (k = 0; k < values && size == expected; k++) {
        made->values[k] = take_double(&at);
    }
    made->count = size == expected ? made->count : 0;
    if (wrong_content(unit, made)) {
        unit_forget(&made);
        return unit_report(unit, STATUS_ERROR, what);
    }
    unit_forget(state);
    *state = made;
    return STATUS_OK;
}
