#include "fmi/variables.h"

#include <string.h>

#include "base/elementary.h"
#include "layout.h"

const Table *table_of(const char *unit, const char *kind, const char *shaft)
{
    int k;
    for (k = 0; k < TABLE_COUNT; k++) {
        const Table *table = TABLES + k;
        if (text_equal(table->unit, unit) && text_equal(table->kind, kind) &&
            text_equal(table->shaft, shaft)) {
            return table;
        }
    }
    return NULL;
}

static size_t repeats(int repeat, const Sizes *sizes)
{
    const size_t stations = (size_t)sizes->stations, free = (size_t)(sizes->stations - 2);
    switch (repeat) {
    case SIZE_TWO:
        return 2;
    case SIZE_STATIONS:
        return stations;
    case SIZE_PLANES:
        return (size_t)sizes->planes;
    case SIZE_UNBALANCES:
        return (size_t)sizes->unbalances;
    case SIZE_WEIGHTS:
        return (size_t)sizes->weights;
    case SIZE_UNEQUAL:
        return sizes->unequal ? (size_t)sizes->weights : 0;
    case SIZE_SLIDERS:
        return (size_t)sizes->sliders;
    case SIZE_SLIDING: /* once, where there are sliders or stops */
        return sizes->sliders > 0 || sizes->stops > 0;
    case SIZE_POINTS:
        return (size_t)sizes->points;
    case SIZE_LOBES:
        return (size_t)sizes->lobes;
    case SIZE_SPEEDS:
        return sizes->tables ? (size_t)sizes->speeds : 0;
    case SIZE_SUPPORTS:
        return (size_t)sizes->supports;
    case SIZE_FEET:
        return (size_t)sizes->feet;
    case SIZE_FORCES:
        return (size_t)(sizes->supports + sizes->feet);
    case SIZE_CUBICS:
        return (size_t)sizes->cubics;
    case SIZE_STOPS:
        return (size_t)sizes->stops;
    case SIZE_TRIANGLE:
        return free * (free + 1) / 2;
    case SIZE_SQUARE:
        return stations * stations;
    case SIZE_PLANE_ROWS:
        return (size_t)sizes->planes * stations;
    case SIZE_UNBALANCE_ROWS:
        return (size_t)sizes->unbalances * stations;
    case SIZE_BENDING_ROWS:
        return (stations > 2 ? free : 1) * stations;
    case SIZE_TABLE_ROWS:
        return (size_t)sizes->tables * stations;
    case SIZE_CUBIC_ROWS:
        return (size_t)sizes->cubics * stations;
    case SIZE_STOP_ROWS:
        return (size_t)sizes->stops * stations;
    case SIZE_SLIDER_ROWS:
        return (size_t)sizes->sliders * stations;
    case SIZE_TABLE_SPEEDS:
        return (size_t)sizes->tables * (size_t)sizes->speeds;
    case SIZE_FORCE_ROWS:
        return (size_t)(sizes->supports + sizes->feet) * stations;
    default:
        return 1;
    }
}

size_t layout_count(const Table *table, const Sizes *sizes, size_t most)
{
    size_t total = 0;
    int b;
    for (b = 0; b < table->block_count; b++) {
        const size_t times = repeats(table->blocks[b].repeat, sizes);
        if (times > most) {
            return most + 1;
        }
        total += times * (size_t)table->blocks[b].count;
        if (total > most) {
            return most + 1;
        }
    }
    return total;
}

static Range group_of(const Layout *layout, char group, size_t first)
{
    Range range;
    range.first = first;
    range.count = 0;
    while (first + range.count < layout->real_count &&
           layout->reals[first + range.count].declared->group == group) {
        range.count++;
    }
    return range;
}

Layout layout_in(Variable *reals, const Table *table, const Sizes *sizes)
{
    Layout layout;
    const Declared *declared = table->declared;
    size_t at = 0;
    int b, k;
    layout.table = table;
    layout.sizes = *sizes;
    layout.reals = reals;
    layout.boolean_count = (size_t)table->flag_count;
    for (b = 0; b < table->block_count; b++) {
        const Block *block = table->blocks + b;
        const bool triangle = block->repeat == SIZE_TRIANGLE, rows = block->repeat > SIZE_TRIANGLE;
        const size_t times = repeats(block->repeat, sizes);
        const int in_row = block->repeat == SIZE_TABLE_SPEEDS ? sizes->speeds : sizes->stations;
        int index = 1, second = 1;
        size_t turn;
        for (turn = 0; turn < times; turn++) {
            for (k = 0; k < block->count; k++) {
                reals[at].declared = declared + k;
                reals[at].index = index;
                reals[at].second = second;
                reals[at].owner = NULL;
                at++;
            }
            /* the upper triangle of the stations that are no supports, or all stations, row by row */
            if ((triangle && second < sizes->stations - 2) || (rows && second < in_row)) {
                second++;
            } else if (rows) {
                second = 1;
                index++;
            } else {
                second = ++index;
            }
        }
        declared += block->count;
    }
    layout.real_count = at;
    layout.parameters = group_of(&layout, 'p', 0);
    layout.inputs = group_of(&layout, 'i', layout.parameters.count);
    layout.computed = group_of(&layout, 'o', layout.inputs.first + layout.inputs.count);
    layout.observed = group_of(&layout, 'v', layout.computed.first + layout.computed.count);
    return layout;
}

size_t layout_index(const Layout *layout, const char *pattern, int index)
{
    size_t k;
    for (k = 0; k < layout->real_count; k++) {
        const Variable *variable = layout->reals + k;
        if (variable->index == index && text_equal(variable->declared->name, pattern)) {
            return k;
        }
    }
    return layout->real_count;
}

void layout_starts(const Layout *layout, double *real)
{
    size_t k;
    for (k = 0; k < layout->real_count; k++) {
        if (!(layout->reals[k].declared->flags & START_VARIES)) {
            real[k] = layout->reals[k].declared->start;
        }
    }
}

void layout_name(const Layout *layout, size_t reference, Text *text)
{
    const Variable *variable = layout->reals + reference;
    const char *name = variable->declared->name;
    int indices = 0;
    if (variable->owner) {
        if (!strncmp(name, "der(", 4)) {
            text_put_part(text, name, 4);
            name += 4;
        }
        text_put(text, variable->owner);
        text_put(text, ".");
    }
    for (; *name; name++) {
        if (*name == '#') {
            text_format(text, "%u", (unsigned long)(indices ? variable->second : variable->index));
            indices++;
        } else if (*name == '@') {
            name++;
            if (layout->sizes.fixed_frame) {
                text_put(text, *name == '1' ? "x" : "y");
            } else {
                text_put(text, *name == '1' ? "xi" : "eta");
            }
        } else {
            text_put_part(text, name, 1);
        }
    }
}

void layout_shown(const Layout *layout, size_t reference, double value, Text *text)
{
    const char *unit = layout->reals[reference].declared->unit;
    layout_name(layout, reference, text);
    text_format(text, text_equal(unit, "1") ? " = %v" : " = %v %s", value, unit);
}

bool layout_allows(const Layout *layout, size_t reference, double value)
{
    const Declared *declared = layout->reals[reference].declared;
    return is_finite(value) &&
           (!(declared->flags & HAS_MINIMUM) || value > declared->minimum ||
            (value == declared->minimum && !(declared->flags & ABOVE_MINIMUM)));
}

void layout_refuse(const Layout *layout, size_t reference, double value, Text *text)
{
    const Declared *declared = layout->reals[reference].declared;
    layout_shown(layout, reference, value, text);
    text_put(text, ": must be a finite number");
    if (declared->flags & HAS_MINIMUM) {
        text_format(text, text_equal(declared->unit, "1") ? "%s%6" : "%s%6 %s",
                    declared->flags & ABOVE_MINIMUM ? " above " : ", at least ",
                    (double)declared->minimum, declared->unit);
    }
}

uint64_t hash_bytes(const void *bytes, size_t count)
{
    const unsigned char *byte = bytes;
    uint64_t hash = 0xCBF29CE484222325u;
    size_t k;
    for (k = 0; k < count; k++) {
        hash = (hash ^ byte[k]) * 0x100000001B3u;
    }
    return hash;
}
