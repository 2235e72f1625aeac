/* A state as bytes, lowest first whatever the machine, with a checksum at the end. */
#include <string.h>

#include "base/elementary.h"
#include "fmi/state.h"

enum { TRAILER = 8 };

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
    return 4 + 4 + TOKEN_SIZE + 8 + 8 + 4 + 4 + 8 * state_value_count(unit) + TRAILER;
}

Status unit_serialise(Unit *unit, const State *state, unsigned char *bytes, size_t size)
{
    const char *what = "serialising a state failed";
    unsigned char *at = bytes;
    size_t k;
    if (state_check(unit, state, what)) {
        return STATUS_ERROR;
    }
    if (size < unit_state_size(unit)) {
        return unit_refuse(unit, what, "there are too few bytes for it");
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
    if (state->count != state_value_count(unit) ||
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
    if (state->stale < COMPUTED && unit->equations->stands_at &&
        !unit->equations->stands_at(state->values + state->count - unit->memory_count, state->time)) {
        text_put(reason, "the bytes hold a time that is not that of their motion");
        return 1;
    }
    return 0;
}

Status unit_deserialise(Unit *unit, const unsigned char *bytes, size_t size, State **state)
{
    const char *what = "reading a serialised state failed";
    const size_t values = state_value_count(unit);
    const size_t expected = unit_state_size(unit), least = expected - 8 * values;
    const unsigned char *at = bytes, *checksum = bytes + (size < least ? 0 : size - TRAILER);
    State *made;
    size_t k;
    if (*state && state_check(unit, *state, what)) {
        return STATUS_ERROR;
    }
    if (size < least || take_number(&at, 4) != STATE_MAGIC ||
        take_number(&at, 4) != STATE_VERSION ||
        take_number(&checksum, TRAILER) != hash_bytes(hash_start(), bytes, size - TRAILER)) {
        return unit_refuse(unit, what, "the bytes are damaged, or are not those of such a state");
    }
    made = state_place(unit, NULL);
    if (!made) {
        return unit_refuse(unit, what, "not enough memory");
    }
    memcpy(made->token, at, TOKEN_SIZE);
    made->token[TOKEN_SIZE - 1] = 0;
    at += TOKEN_SIZE;
    if (state_check(unit, made, what)) {
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
