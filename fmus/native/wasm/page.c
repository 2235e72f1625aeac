/* The library in a web page: a thin front over unit.h, as FMI's functions are.  What it returns as a
   status is unit.h's; `words` then says what was wrong. */
#include <stdlib.h>

#include "base/elementary.h"
#include "fmi/unit.h"

#define EXPORTED(name) __attribute__((export_name(name)))

static char message[MESSAGE_SIZE];

static void keep_words(void *host, const char *name, Status status, const char *words)
{
    Text text = text_in(message, sizeof message);
    text_put(&text, words);
}

/* Zeroed memory for the page to write into. */
EXPORTED("room") void *page_room(size_t bytes)
{
    return calloc(1, bytes);
}

/* The last message since this was asked, and none if there was none. */
EXPORTED("words") const char *page_words(void)
{
    static char last[MESSAGE_SIZE];
    Text text = text_in(last, sizeof last);
    text_put(&text, message);
    message[0] = 0;
    return last;
}

EXPORTED("instantiate") Unit *page_instantiate(const char *token)
{
    return unit_instantiate("scene", token, keep_words, NULL);
}

EXPORTED("count") size_t page_count(const Unit *unit)
{
    return unit->layout.real_count;
}

/* Of a variable, by value reference. */
EXPORTED("name") const char *page_name(const Unit *unit, size_t reference)
{
    static char name[256];
    Text text = text_in(name, sizeof name);
    layout_name(&unit->layout, reference, &text);
    return name;
}

/* Start at a time [s] with these values in place of the token's. */
EXPORTED("begin") Status page_begin(Unit *unit, const unsigned *references, size_t count,
                                    const double *values, double time)
{
    Status status;
    unit_reset(unit);
    status = unit_setup(unit, time, infinity());
    status = status ? status : unit_set_reals(unit, references, count, values);
    return status ? status : unit_exit_initialisation(unit);
}

EXPORTED("set") Status page_set(Unit *unit, const unsigned *references, size_t count,
                                const double *values)
{
    return unit_set_reals(unit, references, count, values);
}

EXPORTED("get") Status page_get(Unit *unit, const unsigned *references, size_t count,
                                double *values)
{
    return unit_get_reals(unit, references, count, values);
}

/* Step to a time [s]. */
EXPORTED("advance") Status page_advance(Unit *unit, double until)
{
    return unit_step(unit, unit->point, until - unit->point);
}
