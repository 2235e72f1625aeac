#include "fmi/front.h"

#include <stdlib.h>
#include <string.h>

#include "fmi/resource.h"
#include "fmi/unit_token.h"

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

Unit *front_instantiate(const char *name, const char *token, const char *resources, Log log,
                        const void *host, size_t size, bool for_model_exchange)
{
    Unit *unit = instantiate(name, token, resources, log, (void *)host);
    void *kept = unit ? unit_allocate(unit, 1, size) : NULL;
    if (kept) {
        memcpy(kept, host, size);
        unit->host = kept;
    }
    if (unit && (!kept || (for_model_exchange && exchange_begin(unit)))) {
        unit_free(unit);
        return NULL;
    }
    return unit;
}

const char *front_category(Status status)
{
    static const char *const categories[] = {"logAll", "logStatusWarning", "logStatusDiscard",
                                             "logStatusError", "logStatusFatal"};
    return categories[status];
}

Status front_allowed(Unit *unit, const char *function, int phases)
{
    static const char *const names[] = {"before initialisation has begun", "during initialisation",
                                        "after initialisation", "after the end"};
    int k = 0;
    if (!unit) {
        return STATUS_ERROR;
    }
    if (unit->phase & phases) {
        return STATUS_OK;
    }
    while (!(unit->phase >> k & 1)) {
        k++;
    }
    return unit_refuse(unit, function, "not allowed %s", names[k]);
}

Status front_arrays(Unit *unit, const char *function, int phases, size_t count, const void *a,
                    const void *b)
{
    if (unit && count && (!a || !b)) {
        return unit_refuse(unit, function, "an array is missing");
    }
    return front_allowed(unit, function, phases);
}

Status front_refuse(Unit *unit, const char *function, const char *why)
{
    return unit ? unit_refuse(unit, function, why) : STATUS_ERROR;
}

Status front_wrong_type(Unit *unit, const char *function, size_t count)
{
    static const char why[] = "the unit has Reals and Booleans only";
    return unit && !count ? STATUS_OK : front_refuse(unit, function, why);
}

Status front_end_initialisation(Unit *unit, const char *function)
{
    const Status status = front_allowed(unit, function, INITIALISING);
    return status ? status : unit_exit_initialisation(unit);
}

Status front_terminate(Unit *unit, const char *function)
{
    const Status status = front_allowed(unit, function, RUNNING);
    if (!status) {
        unit->phase = TERMINATED;
    }
    return status;
}

Status front_reset(Unit *unit, const char *function)
{
    const Status status = front_allowed(unit, function, ANY_PHASE);
    if (!status) {
        unit_reset(unit);
    }
    return status;
}

Status front_exchange(Unit *unit, const char *function, ExchangeCall call, double *values, size_t count)
{
    const bool only_reads = call < SET_STATES || call == GET_INDICATORS;
    const int phases = only_reads ? AFTER_INSTANTIATION : RUNNING;
    const size_t arrays = call == ENTER_MODE ? 0 : count;
    const Status status = front_arrays(unit, function, phases, arrays, values, values);
    return status ? status : exchange_call(unit, function, call, values, count);
}
