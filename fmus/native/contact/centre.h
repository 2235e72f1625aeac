/* Motion of the track's centre and of the rotor within a communication step. */
#ifndef AUTOBALANCER_CENTRE_H
#define AUTOBALANCER_CENTRE_H

#include "weights/weights.h"

/* Acceleration of the track's centre as a cubic of time, and a uniformly accelerated rotor. */
typedef struct {
    Complex signal[SIGNAL_ORDERS];
    Spin spin; /* at the start of the step, with the angle 0 */
} CentreMotion;

/* What drives the weights `time` after the start of the step [s]. */
Instant find_instant(const CentreMotion *motion, double time);

/* Add to the value and derivatives of a signal, `count` (at most 4) in all, those of (i w' - w^2) e:
   what an offset e from where it belongs adds to an acceleration; spin_up (4,): w' and its derivatives. */
void shift_signal(Complex *signal, int count, Complex offset, double speed, const double *spin_up);

#endif
