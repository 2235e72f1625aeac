/* Impulses of collisions, given to the rotor as pulses of a signal known only at points. */
#ifndef AUTOBALANCER_PULSE_H
#define AUTOBALANCER_PULSE_H

#include "base/complex_number.h"

/* Integral of a hat's rising half over one step of length 1, in axes of the step's end. */
Complex hat_half(double turn);

/* The pulse at the end of a step that begins with `pulse` [N], so that what is `owed` [N s] at its
   start will have been given one step later; `owed` becomes what is then left, in the rotor frame at
   the end of the step.  turn, step: of the rotor in the step, and its length [rad, s]. */
Complex pulse_ahead(Complex pulse, double turn, double step, Complex *owed);

#endif
