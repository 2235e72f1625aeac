/* Model exchange of a composite: the host integrates.

   The host sets time, inputs and continuous states.  The states go straight into the memories of the
   parts, which own them.  Whatever is read next brings forces and accelerations into agreement at that
   state, as the start of a co-simulation does; then the inputs of all parts are consistent, and each part
   gives the derivatives of its own states.  Corners of a profile and changes of the unbalance are time
   events; where weights meet, part, stop or start, and supports stick or slip, an indicator falls through 0
   (exchange_events.c). */
#ifndef AUTOBALANCER_EXCHANGE_H
#define AUTOBALANCER_EXCHANGE_H

#include "fmi/unit.h"

/* The first four have values of all states, the next has a time [s], the one behind it that and whether states
   have changed, the last has one of each event indicator, the others have none. */
typedef enum {
    GET_STATES,
    GET_NOMINALS,
    GET_DERIVATIVES,
    SET_STATES,
    SET_TIME,
    PASS_EVENTS, /* that are due; the time of the next, infinite where there is none */
    COMPLETE_STEP,
    ENTER_MODE,
    GET_INDICATORS
} ExchangeCall;

/* Make a new instance one for model exchange; an error for a unit that has none. */
Status exchange_begin(Unit *unit);
/* Number of continuous states; 0 for a unit that is no composite. */
size_t exchange_count(Unit *unit);
/* Derivative of one state, at a communication point too. */
Status exchange_derivative(Unit *unit, size_t state, double *value);
/* Number of event indicators, and the value of one. */
size_t exchange_indicators(const Unit *unit);
Status exchange_indicator(Unit *unit, size_t indicator, double *value);
/* The error of a call that is wrong by itself, in `function`. */
Status exchange_call(Unit *unit, const char *function, ExchangeCall call, double *values, size_t count);

#endif
