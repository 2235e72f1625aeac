/* Cubic signals, and their change between fixed and rotating axes. */
#ifndef AUTOBALANCER_SIGNALS_H
#define AUTOBALANCER_SIGNALS_H

#include "base/complex_number.h"

enum { SIGNAL_ORDERS = 4 }; /* value and derivatives of order 1 to 3 */
enum { QUINTIC_ORDERS = 6 };

/* Value and derivatives 1 to 3 from the eight inputs of one vector signal. */
void signal_orders(const double *signal, Complex *cubic);
/* Value and derivatives 1 to 5 from its twelve inputs. */
void signal_quintic(const double *signal, Complex *quintic);
/* Value and slope at time t [s] into the step of the signal in these inputs, of order 3, or 5 and then
   the second derivative too. */
void signal_derivatives(const double *signal, int order, double t, Complex *derivatives);
/* Value and slope of a cubic at time t [s] into the step. */
void signal_at(const Complex *cubic, double t, Complex *value, Complex *slope);
/* Value and derivatives 1 to 3 at the start of the cubic with these ends. */
void signal_hermite(Complex start, Complex start_slope, Complex end, Complex end_slope,
                    double step, Complex *cubic);

/* The same of a quintic, from value, slope and second derivative of both ends. */
void signal_quintic_hermite(const Complex *start, const Complex *end, double step,
                            Complex *quintic);

#endif
