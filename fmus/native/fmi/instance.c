/* A new instance of any unit, or of a composite of units. */
#include <stdlib.h>

#include "coupling/composite.h"
#include "fmi/unit.h"

/* A single unit; 1 with the reason. */
static int build_alone(Unit *unit, const char *name, const char *text)
{
    const char *rest;
    if (unit_build(unit, name, text, &rest)) {
        return 1;
    }
    return *rest && unit_fail(unit, "its start values are not those of variables that it has: %s", rest);
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
                               : build_alone(unit, shown, token)) {
        Text text = text_in(unit->message_buffer, sizeof unit->message_buffer);
        text_format(&text, "%s: instantiation failed: %s", shown, unit->reason.at);
        log(host, shown, STATUS_ERROR, text.at);
        unit_free(unit);
        return NULL;
    }
    unit_reset(unit);
    return unit;
}
