/* A unit's variables: names, start values and limits by value reference.

   What varies with a unit's sizes is worked out from `layout.h`, which layout.py writes from the
   declarations in Python. */
#ifndef AUTOBALANCER_VARIABLES_H
#define AUTOBALANCER_VARIABLES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/text.h"

/* How often a block of variables stands there. */
enum { SIZE_ONE, SIZE_TWO, SIZE_STATIONS, SIZE_PLANES, SIZE_UNBALANCES, SIZE_WEIGHTS, SIZE_UNEQUAL, SIZE_SLIDERS,
       SIZE_SLIDING, SIZE_POINTS, SIZE_LOBES, SIZE_SPEEDS, SIZE_SUPPORTS, SIZE_FEET, SIZE_FORCES, SIZE_CUBICS,
       SIZE_STOPS,
       SIZE_TRIANGLE, SIZE_SQUARE, SIZE_PLANE_ROWS, SIZE_UNBALANCE_ROWS, SIZE_BENDING_ROWS, SIZE_TABLE_ROWS,
       SIZE_CUBIC_ROWS, SIZE_STOP_ROWS, SIZE_SLIDER_ROWS, SIZE_TABLE_SPEEDS, SIZE_FORCE_ROWS };

enum { HAS_MINIMUM = 1, ABOVE_MINIMUM = 2, START_VARIES = 4, TUNABLE = 8 };

/* A Real, or a row of them that differ in their index: `group` is p (parameter), i (input),
   o (computed output) or v (observed output). */
typedef struct {
    const char *name;
    char unit[8]; /* in place: a pointer would take three times the room, with its relocation */
    char group;
    unsigned char flags;
    float minimum; /* small whole numbers */
    double start;
} Declared;

/* So many of a table's Reals, repeated together. */
typedef struct {
    int repeat;
    int count;
} Block;

/* A Boolean: a parameter, of a composite an output. */
typedef struct {
    const char *name;
    int start;
} Flag;

/* The variables of a kind of unit. */
typedef struct {
    const char *unit, *kind, *shaft;
    const Declared *declared;
    const Block *blocks;
    int block_count;
    const Flag *flags;
    int flag_count;
} Table;

/* What is fixed when a unit is built. */
typedef struct {
    int stations, planes, unbalances, weights, sliders, points;
    int tables, speeds; /* of bearings that change with the speed, and rows of each */
    int supports, feet; /* of a rotor, whose forces are outputs */
    int cubics, stops;  /* springs that are not linear, and stops */
    int fixed_frame; /* signals along fixed axes */
    int unequal;     /* weights each with a mass, drag and radius of its own */
    int lobes;       /* kinds of lobes of a race that is not round */
} Sizes;

/* A Real's declaration, and its indices, from 1. */
typedef struct {
    const Declared *declared;
    int index, second;
    const char *owner; /* the part of a composite it belongs to, or NULL */
} Variable;

/* Value references first..first + count - 1. */
typedef struct {
    size_t first, count;
} Range;

/* Value references of a unit's variables. */
typedef struct {
    const Table *table;
    Sizes sizes;
    Variable *reals;
    size_t real_count, boolean_count;
    Range parameters, inputs, computed, observed;
} Layout;

/* The table of this unit, kind and shaft (those not had are ""), or NULL. */
const Table *table_of(const char *unit, const char *kind, const char *shaft);

/* Number of Reals; above `most` for any larger number. */
size_t layout_count(const Table *table, const Sizes *sizes, size_t most);
/* A layout in an array of layout_count variables. */
Layout layout_in(Variable *reals, const Table *table, const Sizes *sizes);
/* Value reference of the Real with this pattern and index; the layout must have it. */
size_t layout_index(const Layout *layout, const char *pattern, int index);
/* Start values that are the same for every index and size; the others are left. */
void layout_starts(const Layout *layout, double *real);

void layout_name(const Layout *layout, size_t reference, Text *text);
/* Name, value and unit in words. */
void layout_shown(const Layout *layout, size_t reference, double value, Text *text);
/* Whether a variable may have a value, and the words for one that it may not. */
bool layout_allows(const Layout *layout, size_t reference, double value);
void layout_refuse(const Layout *layout, size_t reference, double value, Text *text);

/* FNV-1a of some bytes. */
uint64_t hash_bytes(const void *bytes, size_t count);

#endif
