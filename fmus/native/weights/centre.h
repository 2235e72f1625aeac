/* Motion of the track's centre and of the rotor within a communication step. */
#ifndef AUTOBALANCER_CENTRE_H
#define AUTOBALANCER_CENTRE_H

#include "base/cubic.h"
#include "base/spin.h"

/* Acceleration of the track's centre in the rotor frame over a step, and how the rotor turns at its
   start. */
typedef struct {
    Complex signal[SIGNAL_ORDERS];
    Spin spin;
} CentreMotion;

/* What drives weights at one time: acceleration of the centre and its slope; and how the rotor turns. */
typedef struct {
    Complex motion[2];
    Spin spin;
} Instant;

/* What drives weights `time` after the start of the step [s]. */
Instant find_instant(const CentreMotion *motion, double time);

#endif
