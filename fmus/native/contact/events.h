/* Weights that collide, pack and stick, moved from event to event within a communication step.

   The earliest event of a substep is located by stepping again from the same point, to 1e-12 of the
   substep, so that smooth parts keep order 4. */
#ifndef AUTOBALANCER_EVENTS_H
#define AUTOBALANCER_EVENTS_H

#include "weights/centre.h"
#include "contact/ring.h"

/* Weights on their way through one communication step. */
typedef struct {
    WeightsInOrder *weights;
    const CentreMotion *motion;
    bool stops; /* whether a step ends behind its first event */
    double time; /* since the start of the step [s] */
    Complex impulse; /* of all collisions on the rotor, rotor frame at the step's start [N s] */
    int events; /* collisions, contacts opened, weights stuck or broken away: their number */
} EventStepper;

EventStepper event_stepper(WeightsInOrder *weights, const CentreMotion *motion, bool stops);

/* Move to the end of the step, or to an event that stops it; 0, or the code of what went wrong. */
int advance_events(EventStepper *stepper, double step);

#endif
