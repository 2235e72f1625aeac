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

/* Add to the value and derivatives of a signal, `count` (at most 4) in all, those of (i w' - w^2) e:
   what an offset e from where it belongs adds to an acceleration; spin_up (4,): w' and its derivatives. */
void shift_signal(Complex *signal, int count, Complex offset, double speed, const double *spin_up);

#endif
