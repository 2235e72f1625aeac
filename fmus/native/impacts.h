/* Collisions of the weights of a track, and which contacts last after them; twin of
   models/contact/impacts.py. */
#ifndef AUTOBALANCER_IMPACTS_H
#define AUTOBALANCER_IMPACTS_H

#include "centre.h"
#include "ring.h"

/* True when weights that touch have rates towards each other. */
int approaching(const WeightsInOrder *weights);

/* Let all weights that touch collide, and set who stays in contact; returns the impulse on the
   rotor in the rotor frame [N s].

   closed: weight whose gap to the next has just closed, whatever rounding says of it; -1: none. */
Complex settle(WeightsInOrder *weights, const Instant *now, double angular_acceleration,
               int closed);

#endif
