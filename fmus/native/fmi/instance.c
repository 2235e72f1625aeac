/* A new instance of any unit, or of a composite of units. */
#include <stdlib.h>
#include <string.h>

#include "coupling/composite.h"
#include "fmi/unit.h"

/* A single unit, with the start values that follow its token; 1 with the reason. */
static int build_started(Unit *unit, const char *name, const char *text)
{
    const char *at = text ? token_next(text) : NULL, *value;
    const size_t length = at ? (size_t)(at - text) - 1 : 0;
    char token[TOKEN_SIZE];
    if (at && length < TOKEN_SIZE) {
        memcpy(token, text, length);
        token[length] = 0;
    }
    if (unit_build(unit, name, at && length < TOKEN_SIZE ? token : text)) {
        return 1;
    }
    for (; at; at = token_next(at)) {
        const int wrong =
            (value = text_after(at, "start=")) ? token_starts(value, unit->starts, unit->layout.computed.first)
            : (value = text_after(at, "flags=")) ? token_flags(value, unit->flags, unit->layout.boolean_count)
                                                 : 1;
        if (wrong) {
            return unit_fail(unit, "its start values are not those of variables that it has");
        }
    }
    return 0;
}

Unit *unit_instantiate(const char *name, const char *token, Log log, void *host)
{
    Unit *unit = calloc(1, sizeof *unit);
    const char *shown = name ? name : "";
    if (!unit) {
        log(host, shown, STATUS_ERROR, "instantiation failed: not enough memory");
        return NULL;
    }
    unit->log = log;
    unit->host = host;
    if (composite_named(token) ? composite_build(unit, token) || unit_build_arrays(unit, shown)
                               : build_started(unit, shown, token)) {
        Text text = text_in(unit->message_buffer, sizeof unit->message_buffer);
        text_format(&text, "%s: instantiation failed: %s", shown, unit->reason.at);
        log(host, shown, STATUS_ERROR, text.at);
        unit_free(unit);
        return NULL;
    }
    unit_reset(unit);
    return unit;
}
