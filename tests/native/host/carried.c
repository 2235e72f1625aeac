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

/* Move weights that cannot touch by one collocation of this step, solved to a share of `tolerance` [rad]; the error that it
   states, whatever that is [rad]. */
double collocated(CarriedWeights *c, const CentreMotion *plane, double step, double tolerance, const double *contacts,
                  double *angles, double *speeds)
{
    Collocation *made = &c->collocation;
    const double *places, *rates;
    double error;
    int k;
    carried_set_pace(c, 1.0 / step);
    carried_load(c, plane->signal, SIGNAL_ORDERS, &plane->spin, angles, speeds, contacts);
    collocation_start(made, &c->step, &c->at, 0.0);
    error = tolerance * collocation_solve(made, step * c->step.rate, tolerance, 1.0);
    places = made->places + (made->rule->stages - 1) * made->unknowns;
    rates = made->speeds + (made->rule->stages - 1) * made->unknowns;
    for (k = 0; k < made->unknowns; k++) {
        angles[k] += places[k];
        speeds[k] += rates[k] * c->step.rate;
    }
    return error;
}

/* Passes of the last step by collocation that was tried; 0: none was. */
int collocated_passes(const CarriedWeights *carried)
{
    return carried->collocation.passes;
}

/* Points up to which the last step by relaxation that was tried was sure; 0: none. */
int relaxed_points(const CarriedWeights *carried)
{
    return carried->relaxation.sure;
}
