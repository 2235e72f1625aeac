/* Steps of weights by themselves under heavy drag, in which none begins or ceases to touch another, to rest or to slide.

   In the rotor's axes the angle of each, or of weights that touch and move as one, follows on a round race from

       theta'' = N(t, theta) - d theta',    d = b/(kappa m)

   where N has little of theta': what rolling resistance has by it, 2 mu w/kappa of a weight that slides, is small beside d;
   of a group it is the mean by m/kappa.  N along the motion is the polynomial through its values
   at Radau's points and a part of e^{-d t}, which is what the first fall of theta' to its slow course does to it; drag
   acts exactly.  So a step may be as long as N is smooth, however heavy the drag is: an exponential Runge-Kutta method
   of collocation, as in Hochbruck & Ostermann 2005, solved by iteration, each of which leaves about
   (h/d) dN/dtheta + (1/d) dN/dtheta' of the one before. */
#ifndef AUTOBALANCER_RELAXATION_H
#define AUTOBALANCER_RELAXATION_H

#include "machine/collocation.h"
#include "machine/phase.h"

enum { RELAXED_POINTS = 7, RELAXED_TIMES = RELAXED_POINTS + 1 }; /* at most; with the start */

/* What a drag makes of N in a step of one length: of its value at the start, and of those at the points. */
typedef struct {
    double drag, length;                             /* d and h that these are for; 0: none */
    double fall[RELAXED_POINTS];                     /* e^{-d t} at the points */
    double coasted[RELAXED_POINTS];                  /* theta by theta' = 1 at the start */
    double steady[RELAXED_POINTS];                   /* theta by an N that stays as it is */
    double first[RELAXED_POINTS];                    /* theta by N at the start, */
    double places[RELAXED_POINTS][RELAXED_POINTS];   /* and by those at the points */
    double first_speed[RELAXED_POINTS];              /* theta' by the same */
    double speeds[RELAXED_POINTS][RELAXED_POINTS];
    double reach, reach_speed;                       /* of the points' parts, the largest sum of sizes of a point */
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
    double *angles;   /* (N, RELAXED_TIMES) at the start and the points, */
    double *speeds;   /* (N, RELAXED_TIMES) theta' there, of one that slides against no resistance at the ends alone, */
    double *pushes;   /* (N, RELAXED_TIMES) N, where it slides against resistance less what that has by theta', */
    double *loads;    /* (N, RELAXED_TIMES) and its load without that */
    double *fastest;  /* (N,) the greatest theta' in the step */
    Pair felt[RELAXED_TIMES];    /* acceleration of the track's centre, */
    double turning[RELAXED_TIMES], spun[RELAXED_TIMES]; /* w and w' there */
    double strength, rise, bend; /* the first is at most so large in the step, and so its derivatives; */
    double spin;                 /* w is at most so large, */
    double gained, gained_rise, gained_bend; /* and w' and its derivatives */
    int sure;                    /* points of the step up to which it is sure that nothing happens */
    double unsure;               /* time from there to the next point */
} Relaxation;

/* -- relaxation.c ------------------------------------------------------------------------------------ */

/* Memory for so many weights, in `unit`; 1 where there is none. */
int relaxation_allocate(Unit *unit, Relaxation *made, int weights);
/* Move the weights of a carried machine, whose state is in its coefficients of order 0, in place, by a step with an error
   of at most `tolerance` [rad]; its length: this one, or, where that is `least` or more, up to the last point before which
   it is sure that none begins or ceases to touch, to rest or to slide.  0: nothing moves, and `sure` is 0 where that is
   because one may. */
double relaxation_step(Relaxation *r, Machine *machine, double length, double least, double tolerance);

/* -- relaxation_drag.c ------------------------------------------------------------------------------- */

/* What follows from a rule, with memory for so many weights, in `unit`; 1 where there is none. */
int relaxation_allocate_rule(Unit *unit, RelaxedRule *made, const Radau *rule, int weights);
/* What this drag makes of N in a step of this length. */
void relaxation_prepare(const RelaxedRule *rule, Relaxed *made, double drag, double length);

/* -- relaxation_bounds.c ----------------------------------------------------------------------------- */

/* Of N, at most: its size P, what it changes by with time and with an angle, how it bends with time, and the slope of
   that with an angle. */
typedef struct {
    double size, rise, slope, bend, turn;
} RelaxedBounds;

/* Bounds of what moves the weights, of a step in which the plane moves so. */
void relaxation_bound(Relaxation *r, const Machine *machine, double length);
RelaxedBounds relaxation_bounds_of(const Relaxation *r, const Machine *machine);
/* theta' of a weight, at most. */
double relaxation_greatest_speed(const Machine *machine, const RelaxedBounds *bounds, int weight);
/* mu/(kappa R) of a weight; 0: it has no resistance. */
double relaxation_grip(const Machine *machine, int weight);
/* What N of a weight changes by with theta', at most, where that is no more than so much. */
double relaxation_by_speed(const Relaxation *r, const Machine *machine, int weight, double fastest);
/* Whether N is so nearly straight that three points are right to a tolerance [rad]. */
bool relaxation_is_straight(const Relaxation *r, const Machine *machine, double length, double tolerance);
/* Limit `sure` to where a function stays above `least` that changes by at most so much in the unit of time. */
void relaxation_limit_above(Relaxation *r, const double *values, double least, double change, double length);

/* -- relaxation_resistance.c ------------------------------------------------------------------------- */

/* Set what N without theta' in its resistance and the load of a weight are at a point, where its direction is found; N with
   all that resistance does to it at this theta'. */
double relaxation_resist(const Relaxation *r, const Machine *machine, int weight, int point, double speed, double push);
/* What is not in `pushes` of a group: what theta' has in its resistance; and what they change by, at most. */
double relaxation_turned(const Relaxation *r, const Machine *machine, const PhaseGroup *group, double fastest);
double relaxation_change(const Relaxation *r, const Machine *machine, const PhaseGroup *group, const RelaxedBounds *bounds,
                         double fastest);
/* The greatest theta' of each weight. */
void relaxation_find_fastest(Relaxation *r, const Machine *machine, const RelaxedBounds *bounds, double length);
/* Limit `sure` to where all that roll go on, all that rest stay, and the wall of each carries it. */
void relaxation_limit_rolling(Relaxation *r, const Machine *machine, const RelaxedBounds *bounds, double length);

/* -- relaxation_contacts.c --------------------------------------------------------------------------- */

/* Limit `sure` to where every contact lasts and none is made, the weights being where they were found to be. */
void relaxation_limit_contacts(Relaxation *r, const Machine *machine, const RelaxedBounds *bounds, double length);

#endif
