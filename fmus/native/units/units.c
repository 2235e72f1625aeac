/* The units of the library, by name. */
#include <string.h>

#include "base/elementary.h"
#include "fmi/unit.h"

static const char NO_MEMORY[] = "not enough memory for a unit of this size";

static const Equations *equations_of(const char *name)
{
    const Equations *const all[] = {&ROTOR_EQUATIONS, &LIQUID_EQUATIONS, &WEIGHTS_EQUATIONS, &RING_EQUATIONS,
                                     &MOTOR_EQUATIONS};
    size_t k;
    for (k = 0; k < sizeof all / sizeof *all; k++) {
        if (text_equal(all[k]->name, name)) {
            return all[k];
        }
    }
    return NULL;
}

/* Equations, layout and start values of a unit's token; 1 with the reason. */
static int build_single(Unit *unit, const char *token)
{
    const Table *table;
    Sizes sizes;
    Variable *reals;
    size_t count;
    if (token_read(token, &table, &sizes, unit_reason(unit))) {
        return 1;
    }
    unit->equations = equations_of(table->unit);
    if (!unit->equations) {
        text_put(unit_reason(unit), "the identity names no unit of this library");
        return 1;
    }
    count = layout_count(table, &sizes, MOST_REALS);
    reals = unit_allocate(unit, count, sizeof *reals);
    unit->starts = unit_allocate(unit, count, sizeof(double));
    unit->own = unit_allocate(unit, 1, unit->equations->own_size);
    if (!reals || !unit->starts || !unit->own) {
        text_put(unit_reason(unit), NO_MEMORY);
        return 1;
    }
    unit->layout = layout_in(reals, table, &sizes);
    layout_starts(&unit->layout, unit->starts);
    if (unit->equations->starts) {
        unit->equations->starts(&unit->layout, unit->starts);
    }
    memcpy(unit->token, token, strlen(token) + 1);
    unit->memory_count =
        unit->equations->memory_size ? unit->equations->memory_size(&unit->layout) : 0;
    return 0;
}

size_t unit_values_size(const Unit *unit)
{
    return (unit->layout.real_count + unit->memory_count) * sizeof(double) + unit->layout.boolean_count;
}

int unit_build_arrays(Unit *unit, const char *name)
{
    const size_t count = unit->layout.real_count;
    const size_t outputs = unit->layout.computed.count + unit->layout.observed.count;
    size_t k;
    unit->real = unit_allocate(unit, unit_values_size(unit), 1);
    unit->name = unit_allocate(unit, strlen(name) + 1, 1);
    unit->flags = unit_allocate(unit, unit->layout.boolean_count, 1);
    unit->before = unit_allocate(unit, unit->memory_count, sizeof(double));
    unit->change = unit_allocate(unit, outputs, sizeof(double));
    unit->beside = unit_allocate(unit, outputs, sizeof(double));
    unit->kept = unit_allocate(unit, unit_values_size(unit), 1);
    unit->memory = unit->real + count;
    unit->boolean = (unsigned char *)(unit->memory + unit->memory_count);
    if (!unit->real || !unit->name || !unit->flags || !unit->before || !unit->change || !unit->beside ||
        !unit->kept ||
        (unit->equations->allocate && unit->equations->allocate(unit))) {
        text_put(unit_reason(unit), NO_MEMORY);
        return 1;
    }
    memcpy(unit->name, name, strlen(name) + 1);
    for (k = 0; k < unit->layout.boolean_count; k++) {
        unit->boolean[k] = unit->flags[k] = (unsigned char)unit->layout.table->flags[k].start;
    }
    return 0;
}

int unit_build(Unit *unit, const char *name, const char *text, const char **rest)
{
    char token[TOKEN_SIZE];
    const char *at = text ? token_word(text, ';', token, sizeof token) : NULL, *value;
    if (build_single(unit, at ? token : text) || unit_build_arrays(unit, name)) {
        return 1;
    }
    for (; (value = text_after(at, "start=")) || text_after(at, "flags="); at = token_next(at)) {
        if (value ? token_starts(value, unit->starts, unit->layout.computed.first)
                  : token_flags(text_after(at, "flags="), unit->flags, unit->layout.boolean_count)) {
            return unit_fail(unit, "its start values are not those of variables that it has");
        }
    }
    memcpy(unit->boolean, unit->flags, unit->layout.boolean_count);
    *rest = at;
    return 0;
}
