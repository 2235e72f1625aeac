/* What holds together in a machine with events, and its series in one such phase.

   Weights that touch for good and move as one share phi'': a group.  Its equation is the sum of those of
   its weights, so that with shares m/kappa as weights of a mean

       phi''_G = mean of free phi'' - 1/(kappa R) (mean of b) x,    M x = ... - sum over groups of (sum of m/kappa) c (b x)

   where x are the unknowns of machine.h, c x = Im(a p*) is what the track's acceleration a pushes a weight by,
   and b = c but for a weight that slides against rolling resistance (a cause of residual unbalance named by Goncharov 2017,
   section 2, after Nesterenko 1985 and Yang 2005; mu: its lever arm over the weight's radius for balls and rollers,
   friction times journal radius over R for pendulums; the load is that in the plane),

       phi'' = ... - s sigma mu/(kappa R) (R phi'^2 - Re(a p*)),   b x = Im(a p*) - s sigma mu Re(a p*),

   s the way it slides and sigma the wall that carries it.  Both are kept, so all stays polynomial.  A group
   that rests has phi'' = w'.  A slider of the supports that slips is a force; one that sticks holds its
   displacement in place of that row of the equations, and what it holds by is the row's remainder. */
#ifndef AUTOBALANCER_PHASE_H
#define AUTOBALANCER_PHASE_H

#include "machine/machine.h"
#include "rotor/friction.h"

typedef struct {
    int track;
    int ahead;       /* the weight ahead on a track where weights can meet; -1: none */
    int lasts;       /* they touch whatever happens: the track is full */
    int joined;      /* whether it touches that for good */
    int touches;     /* whether it did before the phase was decided */
    int group, begins; /* the group it is in, and whether as its first */
    double within;   /* its angle within a turn, when that was found [rad] */
    double spacing;  /* to the next where they touch [rad] */
    double radius;   /* R [m] */
    double grip;     /* mu */
    Touch touch;
    double slip;     /* way it slides against its resistance: -1 or 1; 0: there is none, or it rests */
    double side;     /* wall that carries it: 1 the outer, -1 the inner */
    double free;     /* phi'' of the coefficient to come on a track that is held */
    double *alone;   /* (K + 1,) series of phi'' that it would have without its neighbours or rest */
    double *load;    /* (K + 1,) series of R phi'^2 - Re(a p*) */
} PhaseWeight;

/* Weights that move as one, `size` of them one ahead of the other. */
typedef struct {
    int first, size;
    int rests;
    double share;         /* sum of m/kappa [kg] */
    double *row, *action; /* (unknowns,) means of c and b */
} PhaseGroup;

typedef struct {
    int number;   /* among those of the rotor */
    int place;    /* of its displacement among the unknowns, of one at a station */
    int axis;
    const double *row; /* (n, 2) of one with a spring across a row of the stations; NULL: it is at one */
    double limit, stiffness; /* in the machine's time; a stiffness of 0: it is rigid */
    double stroke; /* half of the free stroke [m] */
    int side;      /* of its contact where it has a free stroke; 0: within it */
    double play;   /* displacement from the middle of the stroke there, at the start [m] */
    double slip;  /* way it slips; 0: it sticks */
    double force; /* on the rotor, at the start */
    double known; /* right-hand side of the row it has taken */
    double *held; /* (unknowns,) that row */
    double *hold; /* (K + 1,) series of its force on the rotor */
} PhaseSlider;

struct Phase {
    PhaseWeight *weights;
    PhaseGroup *groups;
    PhaseSlider *sliders;
    int group_count, slider_count;
    double grain;   /* of impacts: which gaps and bounces are too small to be followed, over the usual ones */
    double *series; /* (K + 3,) scratch */
};

/* -- phase.c ------------------------------------------------------------------------------------ */

/* Memory for the phases of a machine; NULL where there is none. */
struct Phase *phase_allocate(Unit *unit, int stations, int weights, int sliders);
/* Set groups from contacts, and who rests. */
void phase_group(Machine *machine);
/* Angle between a weight and the one ahead, less that at which they touch [rad]. */
double phase_gap(const Machine *machine, int weight);
/* Angle of a weight in the rotor and its rate, at the start. */
double phase_angle(const Machine *machine, int weight);
double phase_rate(const Machine *machine, int weight);

/* -- phase_track.c ---------------------------------------------------------------------------------- */

/* What does not change of the weights of a track. */
void phase_take_track(Machine *machine, int number, const Track *track);
/* As each stands before the next; `first`: of its weights among the machine's. */
void phase_order_track(const Machine *machine, const Track *track, int first);

/* -- phase_series.c -------------------------------------------------------------------------------- */

/* The machine's matrix in this phase, and its factors; the unknowns in place of right-hand sides. */
void phase_factorise(Machine *machine);
void phase_solve(const Machine *machine, double *right);
/* Right-hand sides of order k: of the weights; of sliders and shaft once all others are known. */
void phase_push_weights(Machine *machine, int k, Pair spun_twice);
void phase_push_shaft(Machine *machine, int k);
void phase_push_sliders(Machine *machine, int k);
/* Displacement of a slider by the coefficients of one order of `motion`, or its rate by those of `velocity`. */
double phase_slider_along(const Machine *machine, const PhaseSlider *slider, const Pair *coefficients);
/* Whether a slider sticks within its free stroke. */
bool phase_slider_is_loose(const PhaseSlider *slider);
/* Coefficients of order k from the solution. */
void phase_take(Machine *machine, int k, double speed_gained);

/* -- phase_forces.c -------------------------------------------------------------------------------- */

#define PULL_ROUNDING 1e-12 /* of what drives the weights of a track: tension that is rounding */

/* That, of the weights of a group [1/time^2]. */
double phase_slack(const Machine *machine, const PhaseGroup *group);
/* The rounding of a weight's load [m/time^2]. */
double phase_load_slack(const Machine *machine, int weight);
/* Add to a series up to an order: what presses the first `count` weights of a group on those ahead, as an
   acceleration of the whole group; */
void phase_press(const Machine *machine, const PhaseGroup *group, int count, int order, double *series);
/* what resistance has left to hold `count` weights of a group that rests, from its last (ahead) or first on,
   against moving on that side. */
void phase_hold(const Machine *machine, const PhaseGroup *group, int count, int ahead, int order, double *series);

/* -- phase_decide.c -------------------------------------------------------------------------------- */

enum { INSTANT_ORDER = 2 };

/* Which contacts last, which weights and sliders start to move, so that nothing pulls, holds more than it can, or
   goes through another; by the accelerations of the whole machine at this angle, whose series then go up to that order,
   INSTANT_ORDER at least.  1: none was found. */
int phase_decide(Machine *machine, double angle, int order);
/* Acceleration of a weight on its track, behind that. */
double phase_acceleration(const Machine *machine, int weight);
/* phi' of a weight, of order k. */
double phase_turning(const Machine *machine, const SeriesWeight *weight, int k);

/* -- phase_impact.c -------------------------------------------------------------------------------- */

/* Whether weights that touch have rates towards each other. */
int phase_approaches(const Machine *machine);
/* Doubles of the memory of an impact. */
size_t phase_impact_doubles(int stations, int weights);
/* Let rotor and weights jump until none approaches; 1 with the failure. */
int phase_collide(Machine *machine, double angle, double *memory, Failure *failure);

/* -- phase_events.c ------------------------------------------------------------------------------- */

typedef enum {
    NO_EVENT, GAP_SHUTS, CONTACT_PULLS, WEIGHT_STOPS, WEIGHT_LETS_GO, WALL_CHANGES, SLIDER_STOPS, SLIDER_LETS_GO,
    STROKE_ENDS, STROKE_BEGINS, STOP_TOUCHED, STOP_LETS_GO, STOP_LEFT, SPRING_ENDS,
    EVENT_KINDS
} EventKind;

/* What ends a phase, and of which weight, slider, stop or spring. */
typedef struct {
    EventKind kind;
    int which;
} PhaseEvent;

/* The first event within `length`, which is shortened up to there. */
PhaseEvent phase_first_event(Machine *machine, int order, double *length);

#endif
