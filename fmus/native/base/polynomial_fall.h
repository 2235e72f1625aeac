/* The first fall of a polynomial below 0. */
#ifndef AUTOBALANCER_POLYNOMIAL_FALL_H
#define AUTOBALANCER_POLYNOMIAL_FALL_H

/* Time in (0, until] at which a polynomial, not below 0 at 0, falls below it; below 0: it does not.

   coefficients: (order + 1,), overwritten.  It is never jumped over, twice neither: each step goes to where
   a parabola falls that is not above the polynomial anywhere up to there. */
double find_polynomial_fall(double *coefficients, int order, double until);

#endif
