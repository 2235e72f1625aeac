/* What may happen to the weights of a track within a stretch of time.

   A gap may close, the pressure in a group turn into tension, a sliding group come to rest, a
   resting one break away: each is a function of time, not negative at the start, whose fall below 0
   is the event. */
#ifndef AUTOBALANCER_EVENT_FUNCTIONS_H
#define AUTOBALANCER_EVENT_FUNCTIONS_H

#include <stdbool.h>

#include "weights/centre.h"
#include "contact/ring.h"

enum { GAP_CLOSES, PULLED_OPEN, COMES_TO_REST, BREAKS_AWAY, KINDS };

/* The functions of all groups from an instant on. */
typedef struct {
    WeightsInOrder *weights; /* with groups as they are at that instant */
    const CentreMotion *motion;
    double begin; /* time of the instant [s] */
    Instant now;
} EventFunctions;

/* One that is `start` >= 0 now and negative `upper` later. */
typedef struct {
    EventFunctions *functions;
    int kind, group; /* what it is of which group */
    int where;       /* weight before the gap or the contact */
    double start;
    double upper; /* [s] */
} EventFunction;

/* Value of an event function `time` after its instant; NaN when the weights' step fails. */
double event_value(const EventFunction *event, double time);

/* Whether a kind of event is possible at all. */
bool may_happen(const EventFunctions *functions, int kind);

/* Find that of group i, if it has changed sign, or may have done so twice, within `length`; 1 when
   there is one.  The groups' end_middle and end_rate are those at the instant `later`. */
int find_event_function(EventFunctions *functions, int kind, int i, const Instant *later,
                        double length, EventFunction *event);

#endif
