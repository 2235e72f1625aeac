/* Arrays of FMI 3.0: one value reference for a row of Reals that differ in their index alone. */
#include "unit.h"

size_t unit_element_count(const Unit *unit, unsigned reference)
{
    const int array = unit->layout.sizes.arrays && reference < unit->layout.real_count;
    return array ? (size_t)unit->layout.reals[reference].members : 1;
}

/* 0, or 1 when there is no memory for so many. */
static int make_room(Unit *unit, Elements *elements, size_t count)
{
    const size_t room = count > 2 * elements->room ? count : 2 * elements->room;
    if (count > elements->room) {
        unsigned *own = unit_allocate(unit, room, sizeof *own);
        if (!own) {
            return 1;
        }
        elements->own = own;
        elements->room = room;
    }
    return 0;
}

int unit_allocate_elements(Unit *unit)
{
    /* every Real once, and time */
    const size_t count = unit->layout.sizes.arrays ? unit->layout.real_count + 1 : 0;
    return make_room(unit, unit->elements, count) || make_room(unit, unit->elements + 1, count);
}

/* 0, or 1 and the name of one that is an element, but not an array's first. */
static int within_array(Unit *unit, const unsigned *references, size_t count)
{
    size_t k;
    for (k = 0; k < count; k++) {
        if (unit_element_count(unit, references[k]) > 1 &&
            unit->layout.reals[references[k]].index > 1) {
            Text *reason = unit_reason(unit);
            layout_name(&unit->layout, references[k], reason);
            text_put(reason, ": is read and set with its array, by the value reference of the first");
            return 1;
        }
    }
    return 0;
}

static void write_out(const Unit *unit, const unsigned *references, size_t count, unsigned *at)
{
    size_t k, e;
    for (k = 0; k < count; k++) {
        const size_t members = unit_element_count(unit, references[k]);
        for (e = 0; e < members; e++) {
            const int stride = e ? unit->layout.reals[references[k]].stride : 0;
            *at++ = references[k] + (unsigned)e * (unsigned)stride;
        }
    }
}

Status unit_elements(Unit *unit, const char *function, const unsigned *references, size_t count,
                     size_t value_count, Elements *elements)
{
    size_t k;
    elements->at = references;
    elements->count = count;
    if (unit->layout.sizes.arrays) {
        if (within_array(unit, references, count)) {
            return unit_report(unit, STATUS_ERROR, function);
        }
        elements->count = 0;
        for (k = 0; k < count; k++) {
            elements->count += unit_element_count(unit, references[k]);
        }
    }
    if (value_count != elements->count) {
        Text *reason = unit_reason(unit);
        text_put(reason, "there must be as many values as value references have elements, ");
        text_integer(reason, (unsigned long)elements->count);
        text_put(reason, ", not ");
        text_integer(reason, (unsigned long)value_count);
        return unit_report(unit, STATUS_ERROR, function);
    }
    if (elements->count > count) {
        if (make_room(unit, elements, elements->count)) {
            return unit_refuse(unit, function, "not enough memory");
        }
        write_out(unit, references, count, elements->own);
        elements->at = elements->own;
    }
    return STATUS_OK;
}
