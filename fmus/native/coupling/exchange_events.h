/* Events of model exchange: indicators that are distances from an event, and what follows one.

   Every weight that can meet others has one: the gap to the next weight ahead, or how hard it presses on it.
   Every weight with rolling resistance has two: its speed on the track, or what resistance has left to hold
   it; and the load on the wall that carries it.  Every slider of the supports has one: its speed, or what is
   left of its limit.  Which of them it is stays between two events, when the host enters event mode. */
#ifndef AUTOBALANCER_EXCHANGE_EVENTS_H
#define AUTOBALANCER_EXCHANGE_EVENTS_H

#include "fmi/unit.h"

/* Values of all indicators at the time and the states; 1 with the reason. */
int exchange_events_look(Unit *unit, double *values);
/* Let happen what is due, and whether it has changed states; 1 with the reason. */
int exchange_events_pass(Unit *unit, bool *changed);

#endif
