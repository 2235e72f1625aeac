/* Where a function that was positive becomes negative. */
#ifndef AUTOBALANCER_ROOTS_H
#define AUTOBALANCER_ROOTS_H

/* A function of time; NaN says that it failed and ends the search. */
typedef double (*TimeFunction)(void *context, double time);

/* Time at which a function, `value_at_start` >= 0 at 0 and negative at `upper`, becomes negative.

   Chandrupatla 1997 to a bracket of `width`; returns its end at which the value is negative. */
double find_crossing(TimeFunction value, void *context, double value_at_start, double upper,
                     double width);

#endif
