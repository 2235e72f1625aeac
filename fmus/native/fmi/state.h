/* A unit's complete state, and its form as bytes, with a checksum.

   A damaged state, or one of another unit, size or build, is refused and changes nothing.  A host
   keeps states as pointers without type. */
#ifndef AUTOBALANCER_UNIT_STATE_H
#define AUTOBALANCER_UNIT_STATE_H

#include "fmi/unit.h"

/* Save into `*state`, which is NULL or a state to be overwritten. */
Status unit_save(Unit *unit, void **state);
Status unit_restore(Unit *unit, const void *state);
/* Free a state, if there is one, and clear the pointer to it. */
Status unit_free_state(Unit *unit, void **state);

/* Bytes of a serialised state of this unit. */
Status unit_measure_state(Unit *unit, const void *state, size_t *size);
Status unit_serialise(Unit *unit, const void *state, unsigned char *bytes, size_t size);
/* As unit_save, from bytes. */
Status unit_deserialise(Unit *unit, const unsigned char *bytes, size_t size, void **state);

#endif
