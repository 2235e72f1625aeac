/* Exact response of an equation x'' + d x' = g to a forcing g that is a cubic of time. */
#ifndef AUTOBALANCER_RESPONSE_H
#define AUTOBALANCER_RESPONSE_H

#include "base/cubic.h"

/* Of rate and angle over a step, remembered for one damping rate and step: of the rate, to itself and to the
   forcing's derivatives of order 0 to 3, then of the angle. */
typedef struct {
    double damping_rate, step;
    double response[2 * (SIGNAL_ORDERS + 1)];
} Quadrature;

/* phi_0(z)..phi_5(z) for z <= 0. */
void phi_functions(double z, double *phi);
/* A quadrature that remembers nothing, and the response for a damping rate and step. */
Quadrature quadrature_empty(void);
const double *quadrature(Quadrature *memory, double damping_rate, double step);

#endif
