/* Impacts of the weights of a track: who takes part, and who stays in contact behind it. */
#ifndef AUTOBALANCER_IMPACTS_H
#define AUTOBALANCER_IMPACTS_H

#include "weights/centre.h"
#include "contact/impact_law.h"
#include "contact/ring.h"

/* True when weights that touch, or do so within `soon` [s], have rates towards each other. */
int approaching(const WeightsInOrder *weights, double soon);

/* Add the weights of a track on a plane, and the pairs that take part in the impact.

   closed: weight whose gap to the next has just closed, whatever rounding makes of it; -1: none. */
void impact_add(Impact *impact, const WeightsInOrder *weights, int plane, int closed, double soon);

/* Take over the rates of weights that were added as the `first` and those behind it, and contacts.
   Returns the number of pairs that would bounce less than is followed: from then on they last, and
   the impact is to be solved again. */
int impact_apply(Impact *impact, int first, WeightsInOrder *weights, const Instant *now);

/* Let the weights of one track on a rotor with the track's mobility collide; returns the impulse on
   the rotor in its axes [N s]. */
Complex collide_weights(WeightsInOrder *weights, const Instant *now, int closed);

#endif
