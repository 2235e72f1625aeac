/* Weights by themselves in the tests' library of equations, which has no instances. */
#include <stdlib.h>

#include "machine/carried.h"

void *unit_allocate(Unit *unit, size_t count, size_t size)
{
    return calloc(count ? count : 1, size);
}

/* Weights of a track, which stays where it is; they live as long as the process. */
CarriedWeights *carried_of(const Track *track)
{
    CarriedWeights *made = carried_allocate(NULL, track->weights.count, track->weights.lobes);
    if (made) {
        carried_take(made, track);
    }
    return made;
}

int carried_push(CarriedWeights *carried, const double *angles, const double *speeds, const double *contacts,
                 const Instant *plane, Complex *force, double *torque, Failure *failure)
{
    failure->code = 0;
    if (carried_look(carried, angles, speeds, contacts, plane, failure)) {
        return 1;
    }
    machine_reaction(&carried->step, 0, carried->track, force, torque);
    return 0;
}
