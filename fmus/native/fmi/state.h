/* A unit's complete state, and its form as bytes: versioned and checked.

   A damaged state, or one of another unit, size or build, is refused and changes nothing. */
#ifndef AUTOBALANCER_UNIT_STATE_H
#define AUTOBALANCER_UNIT_STATE_H

#include "fmi/unit.h"

enum { STATE_MAGIC = 0x41425354, STATE_VERSION = 1 };

/* The values: Reals, then Booleans as 0 or 1, then the equations' memory. */
typedef struct {
    uint32_t magic, version;
    char token[TOKEN_SIZE];
    double time;
    int phase, stale;
    size_t count;
    double values[1];
} State;

/* Save into `*state`, which is NULL or a state to be overwritten. */
Status unit_save(Unit *unit, State **state);
Status unit_restore(Unit *unit, const State *state);
/* Free a state and clear the pointer to it. */
void unit_forget(State **state);

/* Bytes of a serialised state of this unit. */
size_t unit_state_size(const Unit *unit);
Status unit_serialise(Unit *unit, const State *state, unsigned char *bytes, size_t size);
/* As unit_save, from bytes. */
Status unit_deserialise(Unit *unit, const unsigned char *bytes, size_t size, State **state);

/* -- for both files of the state ------------------------------------------------------------- */

size_t state_value_count(const Unit *unit);
/* STATUS_OK when this is a state of this unit. */
Status state_check(Unit *unit, const State *state, const char *what);
/* An empty state, or the one that is to be overwritten; NULL when there is no memory. */
State *state_place(const Unit *unit, State *state);

#endif
