/* A new instance of any unit, or of a composite of units. */
#include <stdlib.h>

#include "coupling/composite.h"
#include "fmi/unit.h"

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
                               : unit_build(unit, shown, token)) {
        Text text = text_in(unit->message_buffer, sizeof unit->message_buffer);
        text_put(&text, shown);
        text_put(&text, ": instantiation failed: ");
        text_put(&text, unit->reason.at);
        log(host, shown, STATUS_ERROR, text.at);
        unit_free(unit);
        return NULL;
    }
    unit_reset(unit);
    return unit;
}
