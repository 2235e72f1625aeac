/* Quintics over a step, given by the value and the derivatives 1 to 5 at its start. */
#ifndef AUTOBALANCER_QUINTIC_H
#define AUTOBALANCER_QUINTIC_H

#include "base/complex_number.h"

/* Derivatives 3 to 5 at the start of the quintic with these values, slopes and second derivatives;
   every `stride`-th number of each is meant: 1, or 2 for a part of complex ones. */
void quintic_hermite(const double *start, const double *end, int stride, double step,
                     double *higher);

/* Value, slope and second derivative of a complex quintic `time` after its start. */
void quintic_at(const Complex *quintic, double time, Complex *derivatives);

#endif
