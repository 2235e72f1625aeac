/* Lets the weights of a composite collide where they stand, for tests. */
#include "coupling/composite.h"
#include "coupling/one_piece.h"
#include "fmi/export.h"
#include "fmi/front.h"

EXPORT int collide_now(void *instance)
{
    Unit *unit = instance;
    const int wrong = one_piece_step(unit); /* begins a step behind the impact */
    unit->stale = OBSERVED; /* speeds are read anew from the memories of the parts */
    return wrong ? -1 : 1;
}
