/* Impulses of collisions, given to the rotor as pulses of a signal known only at points; twin of
   models/contact/pulse.py. */
#ifndef AUTOBALANCER_PULSE_H
#define AUTOBALANCER_PULSE_H

#include "complex_number.h"

/* Integral of a hat's rising half over one step of length 1, in axes of the step's end. */
Complex hat_half(double turn);

/* What is owed after a step, and the pulse at its end; in place.

   impulse: of the collisions in the step, in the rotor frame at its end [N s]; turn, step: of the
   rotor in the step, and its length [rad, s]. */
void discharge(Complex *owed, Complex *pulse, Complex impulse, double turn, double step);

#endif
