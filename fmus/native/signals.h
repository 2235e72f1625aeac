/* Cubic signals, and their change between fixed and rotating axes; twin of fmus/signals.py. */
#ifndef AUTOBALANCER_SIGNALS_H
#define AUTOBALANCER_SIGNALS_H

#include "complex_number.h"

enum { SIGNAL_ORDERS = 4 }; /* value and derivatives of order 1 to 3 */

/* Value and derivatives 1 to 3 from the eight inputs of one vector signal. */
void signal_orders(const double *signal, Complex *cubic);
/* Value and slope of a cubic at time t [s] into the step. */
void signal_at(const Complex *cubic, double t, Complex *value, Complex *slope);
/* Value and derivatives 1 to 3 at the start of the cubic with these ends. */
void signal_hermite(Complex start, Complex start_slope, Complex end, Complex end_slope,
                    double step, Complex *cubic);

#endif
