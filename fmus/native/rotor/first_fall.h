/* First fall of a polynomial below 0, found to rounding, none missed. */
#ifndef AUTOBALANCER_FIRST_FALL_H
#define AUTOBALANCER_FIRST_FALL_H

#define MOST_COEFFICIENTS 19

/* First s in 0..until (at most 1) at which a polynomial, not negative at first, falls below 0;
   infinite when it does not.  What has just become 0 is judged by its first term that is not 0.

   coefficients: (count,) of powers of s, count at most MOST_COEFFICIENTS.
   rounding: sizes up to which the first three count as 0. */
double find_first_fall(const double *coefficients, int count, double until, const double *rounding);
/* The coefficients about s: Horner's scheme, repeated. */
void polynomial_about(const double *coefficients, int count, double s, double *shifted);

#endif
