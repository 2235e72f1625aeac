/* Motion of the track's centre and of the rotor within a communication step. */
#ifndef AUTOBALANCER_CENTRE_H
#define AUTOBALANCER_CENTRE_H

#include "base/complex_number.h"

/* What drives the weights at one time: acceleration of the track's centre and its slope in the
   rotor frame, and the rotor's speed. */
typedef struct {
    Complex acceleration, slope;
    double rotor_speed;
} Instant;

/* Acceleration of the track's centre as a cubic of time, and a uniformly accelerated rotor. */
typedef struct {
    Complex signal[4]; /* value at the start of the step and derivatives of order 1 to 3 */
    double rotor_speed, angular_acceleration; /* w at the start of the step, and w' */
} CentreMotion;

/* What drives the weights `time` after the start of the step [s]. */
Instant instant(const CentreMotion *motion, double time);

/* Angle by which the rotor has turned `time` after the start of the step [rad]. */
double rotor_turned(const CentreMotion *motion, double time);

/* Signal of the track's centre from that of the plane's: (i w' - w^2) e, exact for linear w;
   spin_up (4,): w' at the start and its derivatives; result may be the signal. */
void shifted(const Complex *signal, Complex offset, double rotor_speed, const double *spin_up,
             Complex *result);
/* The same of a quintic, in place. */
void shift_quintic(Complex *signal, Complex offset, double rotor_speed, const double *spin_up);

#endif
