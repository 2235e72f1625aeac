/* Motion of a balancer's centre and of the rotor within a communication step. */
#ifndef AUTOBALANCER_CENTRE_H
#define AUTOBALANCER_CENTRE_H

#include "base/cubic.h"
#include "base/spin.h"

/* Acceleration of a balancer's centre over a step, and how the rotor turns at its start. */
typedef struct {
    Complex signal[SIGNAL_ORDERS];
    Spin spin;
} CentreMotion;

/* What drives a balancer at one time: acceleration of the centre and its slope; and how the rotor turns. */
typedef struct {
    Complex motion[2];
    Spin spin;
} Instant;

/* The same `time` after the start of the step [s]. */
Instant find_instant(const CentreMotion *motion, double time);
/* A vector in fixed axes and its slope, in place as they are seen in axes that turn with the rotor, or
   against it. */
void rotate_derivatives(Complex *derivatives, const Spin *spin, int against);
/* The same of a signal over a step of this length: the cubic between both ends. */
void rotate_signal(CentreMotion *motion, double length);

#endif
