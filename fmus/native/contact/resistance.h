/* Rolling resistance with true sticking, and a track whose centre is off the rotor's.

   The two causes of residual unbalance named by Goncharov 2017 (section 2, after Nesterenko 1985 and
   Yang 2005).  A weight at e + R e^{i theta} in the rotor (e: offset of the track's centre) moves by

       theta'' + d theta' = g - sign(theta') c |n|,        theta' = 0 while |g| <= c |n|,
       g = -Im(a_c e^{-i theta})/(kappa R) - s w',         n = R (w + theta')^2 - Re(a_c e^{-i theta}),
       a_c = a + (i w' - w^2) e,                           c = mu/(kappa R),

   with a_c the acceleration of the track's centre, m |n| the force between weight and race (either
   wall of the race may carry it), and mu the coefficient of rolling resistance: lever arm of the
   resistance over the weight's radius for balls and rollers, friction times journal radius over R for
   pendulums.  The load is that in the plane.  With resistance every position with
   |Im(a_c e^{-i theta})| <= mu |R w^2 - Re(a_c e^{-i theta})| is an equilibrium: the dead zone. */
#ifndef AUTOBALANCER_RESISTANCE_H
#define AUTOBALANCER_RESISTANCE_H

#include "weights/weights.h"

/* A packed group that slides one way. */
typedef struct {
    double radius;       /* R [m] */
    double lever;        /* -1/(kappa R) [1/m] */
    double grip;         /* sign(theta') mu/(kappa R) [1/m] */
    double damping_rate; /* d [1/s] */
    int count;
    double spin_share; /* s of Track */
    double factor;     /* of the mean forcing, as of Groups */
    double inertia;    /* sum of */
    const double *mass, *offset; /* (count,) of each, and its angle from the middle [rad] */
} SlidingGroup;

/* Which wall of the race carries each weight: sides (count,) 1.0 outer, -1.0 inner.  Returns how
   many are set; 0: all are the outer one. */
int find_sides(const SlidingGroup *group, const Instant *now, double angle, double angle_rate,
               double *sides);

/* Mean of g - grip |n| over the group, and its time derivative along the motion. */
void find_sliding_forcing(const SlidingGroup *group, const Instant *now, double angle,
                          double angle_rate, const double *sides, int side_count, double *forcing);

/* Angle and rate after `step`, in place; as weights_substep.  sides: (count,) scratch. */
int sliding_substep(const SlidingGroup *group, double *angle, double *angle_rate,
                    const Instant *now, const Instant *later, const double *response, double step,
                    double *sides, Failure *failure);

#endif
