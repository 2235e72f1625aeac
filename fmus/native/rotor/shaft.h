/* Compliance and stiffness of a massless elastic shaft on two supports. */
#ifndef AUTOBALANCER_SHAFT_H
#define AUTOBALANCER_SHAFT_H

#include "base/failure.h"

/* T (n - 2, n): bending of the discs relative to the line through the supports p and q (from 0). */
void bending_rows(int n, const double *z, int p, int q, double *rows);

/* Euler-Bernoulli influence coefficients delta (n - 2, n - 2) [m/N]; scratch of n (n - 2). */
void beam_compliance(int n, const double *z, const double *rows, double bending_stiffness,
                     double *delta, double *scratch);

/* Shares (n,) of the discs in a force at a position between them; scratch of 2 n. */
void beam_shares(int n, const double *z, double position, double *shares, double *scratch);

/* A compliance given as numbers (size, size), made symmetric in delta. */
int given_compliance(int size, const double *compliance, double *delta, Failure *failure);

/* T^T delta^-1 T (n, n) [N/m]; scratch of (n - 2)(2 n - 1). */
int shaft_stiffness(int n, const double *delta, const double *rows, double *stiffness,
                    double *scratch, Failure *failure);

#endif
