/* Cubic springs and stops in a machine's series: rotor/restraint.h has their laws.

   Their forces follow from displacement and velocity, so that those of order k are known before the
   acceleration of that order.  A machine with stops has phases: a stop presses, or it does not. */
#ifndef AUTOBALANCER_RESTRAINTS_H
#define AUTOBALANCER_RESTRAINTS_H

#include "machine/machine.h"
#include "rotor/restraint.h"

/* In the machine's time. */
typedef struct {
    CubicSpring spring;
    RestraintSeries series;
} MachineCubic;

typedef struct {
    Stop stop;
    int state; /* of restraint.h */
    RestraintSeries series;
} MachineStop;

struct Restraints {
    int cubic_count, stop_count;
    MachineCubic *cubics;
    MachineStop *stops;
};

/* Memory for so many of each; NULL where there is none. */
struct Restraints *restraints_allocate(Unit *unit, int cubics, int stops);
/* Those of a rotor, in this unit of time. */
void restraints_take(Machine *machine, const CubicSpring *cubics, const Stop *stops);
/* Add forces of order k on the stations. */
void restraints_push(Machine *machine, int k);
/* Complete what is watched of a stop or a spring, up to an order of the displacement. */
void restraints_complete(Machine *machine, RestraintSeries *series, const double *rows, int order);
/* Set the state of every stop to that of the machine's displacements and velocities. */
void restraints_settle(Machine *machine);
/* The largest force of a stop up to a time of a step whose series of it has this order. */
double restraints_largest(const MachineStop *stop, int order, double time);
/* Displacement and velocity (2,) across one. */
void restraints_across(const Machine *machine, const double *rows, double *displacement, double *velocity);

#endif
