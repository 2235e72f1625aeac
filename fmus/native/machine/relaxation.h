/* Steps of weights by themselves under heavy drag, which can neither touch nor stick.

   In the rotor's axes the angle of each follows on a round race from

       theta'' = N(t, theta) - d theta',    d = b/(kappa m)

   where N has no theta'.  N along the motion is the polynomial through its values at Radau's points and a part of
   e^{-d t}, which is what the first fall of theta' to its slow course does to it; drag acts exactly.  So a step may
   be as long as N is smooth, however heavy the drag is: an exponential Runge-Kutta method of collocation, as in
   Hochbruck & Ostermann 2005, solved by iteration, each of which leaves about (h/d) dN/dtheta of the one before. */
#ifndef AUTOBALANCER_RELAXATION_H
#define AUTOBALANCER_RELAXATION_H

#include "machine/collocation.h"

enum { RELAXED_POINTS = 7 };

/* What a drag makes of values of N at the points in a step of one length. */
typedef struct {
    double drag, length;                             /* d and h that these are for; 0: none */
    double fall[RELAXED_POINTS];                     /* e^{-d t} at the points */
    double coasted[RELAXED_POINTS];                  /* theta by theta' = 1 at the start */
    double places[RELAXED_POINTS][RELAXED_POINTS];   /* theta by the values */
    double falling[RELAXED_POINTS];                  /* theta by N = e^{-d t} */
    double speeds[RELAXED_POINTS];                   /* theta' at the end by the values */
    double part;                                     /* what e^{-d t} has at the start beyond the polynomial */
} Relaxed;

typedef struct {
    double powers[RELAXED_POINTS][RELAXED_POINTS]; /* what 1, t, ... have in values at the points */
    Relaxed *of;      /* (N,) */
    double *ends;     /* (2, N) angles, speeds at the end */
    Pair felt[RELAXED_POINTS + 1];    /* acceleration of the track's centre, at the start and the points */
    double spun[RELAXED_POINTS + 1];  /* w' there */
} Relaxation;

/* Memory for so many weights, in `unit`; 1 where there is none. */
int relaxation_allocate(Unit *unit, Relaxation *made, int weights);
/* Move the weights of a carried machine, whose state is in its coefficients of order 0, by a step in place; its error over
   the tolerance [rad].  Beyond 1, or where it is infinite because the iteration does not come together, nothing moves. */
double relaxation_step(Relaxation *r, Machine *machine, double length, double tolerance);

#endif
