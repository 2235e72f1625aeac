/* Steps of weights by themselves under heavy drag, in which none begins or ceases to touch another and none sticks.

   In the rotor's axes the angle of each, or of weights that touch and move as one, follows on a round race from

       theta'' = N(t, theta) - d theta',    d = b/(kappa m)

   where N has no theta'; of a group it is the mean by m/kappa.  N along the motion is the polynomial through its values
   at Radau's points and a part of e^{-d t}, which is what the first fall of theta' to its slow course does to it; drag
   acts exactly.  So a step may be as long as N is smooth, however heavy the drag is: an exponential Runge-Kutta method
   of collocation, as in Hochbruck & Ostermann 2005, solved by iteration, each of which leaves about (h/d) dN/dtheta of
   the one before. */
#ifndef AUTOBALANCER_RELAXATION_H
#define AUTOBALANCER_RELAXATION_H

#include "machine/collocation.h"

enum { RELAXED_POINTS = 7, RELAXED_TIMES = RELAXED_POINTS + 1 }; /* at most; with the start */

/* What a drag makes of N in a step of one length: of its value at the start, and of those at the points. */
typedef struct {
    double drag, length;                             /* d and h that these are for; 0: none */
    double fall[RELAXED_POINTS];                     /* e^{-d t} at the points */
    double coasted[RELAXED_POINTS];                  /* theta by theta' = 1 at the start */
    double steady[RELAXED_POINTS];                   /* theta by an N that stays as it is */
    double first[RELAXED_POINTS];                    /* theta by N at the start, */
    double places[RELAXED_POINTS][RELAXED_POINTS];   /* and by those at the points */
    double reach;                                    /* of the latter, the largest sum of sizes of a point */
    double first_speed, speeds[RELAXED_POINTS];      /* theta' at the end by them */
    double first_part, part[RELAXED_POINTS];         /* what e^{-d t} has in N by them */
} Relaxed;

/* A rule, and what follows from it. */
typedef struct {
    const Radau *rule;
    double beyond; /* what its last power has beyond lower ones, eight times for safety */
    double powers[RELAXED_POINTS][RELAXED_POINTS]; /* what 1, t, ... have in values at the points */
    Relaxed *of;   /* (N,) */
} RelaxedRule;

typedef struct {
    RelaxedRule few, many; /* three points where N is nearly straight; seven */
    const RelaxedRule *now;
    double *ends;     /* (N,) speeds at the end */
    double *angles;   /* (N, RELAXED_TIMES) at the start and the points, */
    double *pushes;   /* (N, RELAXED_TIMES) and N there */
    Pair felt[RELAXED_TIMES];    /* acceleration of the track's centre, */
    double spun[RELAXED_TIMES];  /* and w' there */
    double strength, rise, bend; /* the first is at most so large in the step, and so its derivatives; */
    double gained, gained_rise, gained_bend; /* the same of w' */
} Relaxation;

/* -- relaxation.c ------------------------------------------------------------------------------------ */

/* Memory for so many weights, in `unit`; 1 where there is none. */
int relaxation_allocate(Unit *unit, Relaxation *made, int weights);
/* Move the weights of a carried machine, whose state is in its coefficients of order 0, by a step in place; its error
   over the tolerance [rad].  Beyond 1, or where it is infinite because the iteration does not come together or weights
   may begin or cease to touch, nothing moves. */
double relaxation_step(Relaxation *r, Machine *machine, double length, double tolerance);

/* -- relaxation_drag.c ------------------------------------------------------------------------------- */

/* What follows from a rule, with memory for so many weights, in `unit`; 1 where there is none. */
int relaxation_allocate_rule(Unit *unit, RelaxedRule *made, const Radau *rule, int weights);
/* What this drag makes of N in a step of this length. */
void relaxation_prepare(const RelaxedRule *rule, Relaxed *made, double drag, double length);

/* -- relaxation_contacts.c --------------------------------------------------------------------------- */

/* Bounds of what moves the weights, of a step in which the plane moves so. */
void relaxation_bound(Relaxation *r, const Machine *machine, double length);
/* Whether N is so nearly straight that three points are right to a tolerance [rad]. */
bool relaxation_is_straight(const Relaxation *r, const Machine *machine, double length, double tolerance);
/* Whether it is sure that every contact lasts and none is made, the weights being where they were found to be. */
bool relaxation_keeps_contacts(const Relaxation *r, const Machine *machine, double length);

#endif
