/* A unit's complete state, and its form as bytes: versioned and checked.

   A damaged state, or one of another unit, size or build, is refused and changes nothing. */
#ifndef AUTOBALANCER_UNIT_STATE_H
#define AUTOBALANCER_UNIT_STATE_H

#include "unit.h"

typedef struct State State;

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

#endif
