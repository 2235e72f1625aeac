/* Weights by themselves: a machine whose one station moves as a host tells. */
#ifndef AUTOBALANCER_CARRIED_H
#define AUTOBALANCER_CARRIED_H

#include "contact/ring.h"
#include "machine/collocation.h"
#include "machine/phase.h"
#include "machine/relaxation.h"

typedef struct {
    Machine step, at;                 /* series of a step; accelerations that a collocation asks for */
    Carried start, step_now, at_now;  /* how the plane moves: over the whole step, and where the machines stand */
    struct Phase *phase;
    Collocation collocation;
    Relaxation relaxation;
    double worth;                     /* length of the next step by relaxation that is tried */
    double *impact, *scratch, *rates; /* of impacts; of weights in order; (N,) */
    const Track *track;
    double fastest, slowest;          /* rate of drag, the fastest and the slowest of any weight [1/s] */
} CarriedWeights;

/* State at the end of a step. */
typedef struct {
    double *angles, *speeds; /* (N,) in the rotor [rad, rad/s] */
    double *contacts; /* (N,) 1 where a weight lastingly touches the next along the track */
    Complex impulse; /* of the collisions in this step on the rotor, in its axes at the end
                        [N s]; what is not in the force */
    double turning; /* theirs on the shaft, about the plane's centre [N m s]; what is not in the torque */
    int events; /* collisions, contacts opened, weights stuck or broken away */
    double reached; /* time since the start of the step [s]: its length, or the first event */
} Moved;

/* -- carried.c ---------------------------------------------------------------------------------- */

/* Memory for so many weights on a race with so many lobes, in `unit`; NULL where there is none. */
CarriedWeights *carried_allocate(Unit *unit, int count, int lobes);
/* The weights of a track whose parameters are checked, and which stays where it is. */
void carried_take(CarriedWeights *carried, const Track *track);
/* Both machines in the unit of time of so fast a motion [1/s]; a power of two rounds nothing. */
void carried_set_pace(CarriedWeights *carried, double fastest);
/* The weights in this state on a plane that moves so, as coefficients of order 0; orders: how many the signal has. */
void carried_load(CarriedWeights *carried, const Complex *signal, int orders, const Spin *spin, const double *angles,
                  const double *speeds, const double *contacts);
/* Expand the weights where they stand: `series` shows then accelerations and forces (machine_reaction).  0, or with the
   reason. */
int carried_look(CarriedWeights *carried, const double *angles, const double *speeds, const double *contacts,
                 const Instant *plane, Failure *failure);
/* Acceleration of the angle of a weight, behind that [rad/s^2]. */
double carried_acceleration(const CarriedWeights *carried, int weight);

/* -- carried_step.c ------------------------------------------------------------------------------ */

/* Move weights whose state is in `moved`, in place, under this motion of their plane's centre, whose angle counts from 0;
   stops: whether the step ends behind its first event.  0, or with the reason, and a state without meaning. */
int carried_advance(CarriedWeights *carried, const CentreMotion *plane, double step, bool stops, Moved *moved,
                    Failure *failure);

#endif
