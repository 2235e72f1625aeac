/* Signals that are polynomials over a step: cubics, of 4 numbers, and quintics, of 6 (`orders`), given
   by the value and the derivatives at its start. */
#ifndef AUTOBALANCER_SIGNALS_H
#define AUTOBALANCER_SIGNALS_H

#include "base/complex_number.h"

enum { SIGNAL_ORDERS = 4, QUINTIC_ORDERS = 6 };

/* Value and derivatives, orders / 2 in all, at time t [s] into the step. */
void signal_at(const Complex *signal, int orders, double t, Complex *derivatives);

/* The signal over a step with these orders / 2 values and derivatives at both ends. */
void signal_hermite(const Complex *start, const Complex *end, int orders, double step,
                    Complex *signal);

/* The derivatives of a real one that `start` does not hold. */
void hermite_rates(const double *start, const double *end, int orders, double step, double *higher);

#endif
