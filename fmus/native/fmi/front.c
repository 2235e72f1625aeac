#include "fmi/front.h"

#include <stdlib.h>
#include <string.h>

#include "fmi/resource.h"
#include "fmi/state.h"
#include "fmi/token.h"

/* The text that an identity is the hash of; NULL with the reason. */
static char *composition(const char *token, const char *resources, Text *reason)
{
    char expected[TOKEN_SIZE], *text = resource_text(resources, COMPOSITION, reason);
    Text identity = text_in(expected, sizeof expected);
    if (text) {
        token_identity(text, &identity);
        if (!text_equal(expected, token)) {
            text_format(reason,
                        "resources: %s: its identity is %s, and must be that of the model "
                        "description, %s", COMPOSITION, expected, token);
            free(text);
            return NULL;
        }
    }
    return text;
}

static Unit *instantiate(const char *name, const char *token, const char *resources, Log log,
                         void *host)
{
    char words[REASON_SIZE], *text;
    Text reason = text_in(words, sizeof words);
    Unit *unit;
    if (!token_abbreviated(token)) {
        return unit_instantiate(name, token, log, host);
    }
    text_put(&reason, "instantiation failed: ");
    text = composition(token, resources, &reason);
    if (!text) {
        log(host, name ? name : "", STATUS_ERROR, words);
        return NULL;
    }
    unit = unit_instantiate(name, text, log, host);
    free(text);
    return unit;
}

void *front_instantiate(const char *name, const char *token, const char *resources, Log log,
                        void *host, size_t size, int exchanges)
{
    Unit *unit = instantiate(name, token, resources, log, host);
    void *instance = unit ? unit_allocate(unit, 1, size) : NULL;
    if (instance) {
        memcpy(instance, host, size);
        *(Unit **)instance = unit;
        unit->host = instance;
    }
    if (unit && (!instance || (exchanges && exchange_begin(unit)))) {
        unit_free(unit);
        return NULL;
    }
    return instance;
}

void front_free(void *instance)
{
    if (instance) {
        unit_free(front_unit(instance));
    }
}

Unit *front_unit(void *instance)
{
    return *(Unit **)instance;
}

const char *front_category(Status status)
{
    static const char *const categories[] = {"logAll", "logStatusWarning", "logStatusDiscard",
                                             "logStatusError", "logStatusFatal"};
    return categories[status];
}

Status front_allowed(void *instance, const char *function, int phases, size_t count,
                     const void *a, const void *b)
{
    if (!instance) {
        return STATUS_ERROR;
    }
    if (count && (!a || !b)) {
        return unit_refuse(front_unit(instance), function, "an array is missing");
    }
    return unit_allowed(front_unit(instance), function, phases);
}

Status front_refuse(void *instance, const char *function, const char *why)
{
    return instance ? unit_refuse(front_unit(instance), function, why) : STATUS_ERROR;
}

Status front_wrong_type(void *instance, const char *function, size_t count)
{
    static const char why[] = "the unit has Reals and Booleans only";
    return instance && !count ? STATUS_OK : front_refuse(instance, function, why);
}

Status front_exchange(void *instance, const char *function, ExchangeCall call, double *values, size_t count)
{
    const int phases = call < SET_STATES ? AFTER_INSTANTIATION : RUNNING;
    const size_t arrays = call == ENTER_MODE ? 0 : count;
    const Status status = front_allowed(instance, function, phases, arrays, values, values);
    return status ? status : exchange_call(front_unit(instance), function, call, values, count);
}

Status front_save(void *instance, const char *function, void **state)
{
    const Status status = front_allowed(instance, function, ANY_PHASE, 1, state, state);
    return status ? status : unit_save(front_unit(instance), state);
}

Status front_restore(void *instance, const char *function, void *state)
{
    const Status status = front_allowed(instance, function, ANY_PHASE, 1, state, state);
    return status ? status : unit_restore(front_unit(instance), state);
}

Status front_free_state(void *instance, void **state)
{
    if (instance && state) {
        unit_free_state(state);
    }
    return instance ? STATUS_OK : STATUS_ERROR;
}

Status front_state_size(void *instance, const char *function, void *state, size_t *size)
{
    const Status status = front_allowed(instance, function, ANY_PHASE, 1, state, size);
    if (!status) {
        *size = unit_state_size(front_unit(instance));
    }
    return status;
}

Status front_serialise(void *instance, const char *function, void *state, void *bytes, size_t size)
{
    const Status status = front_allowed(instance, function, ANY_PHASE, 1, state, bytes);
    return status ? status : unit_serialise(front_unit(instance), state, bytes, size);
}

Status front_deserialise(void *instance, const char *function, const void *bytes, size_t size,
                         void **state)
{
    const Status status = front_allowed(instance, function, ANY_PHASE, 1, bytes, state);
    return status ? status : unit_deserialise(front_unit(instance), bytes, size, state);
}
