/* The largest force of a stop in model exchange, where the unit sees states at the ends of the host's steps alone. */
#ifndef AUTOBALANCER_EXCHANGE_STOPS_H
#define AUTOBALANCER_EXCHANGE_STOPS_H

#include "fmi/unit.h"

/* Follow the largest force of every stop over the step that the host has completed; 1 with the reason. */
int exchange_stops_follow(Unit *unit);

#endif
