/* Step of the linear rotor while its speed changes. */
#ifndef AUTOBALANCER_VARIABLE_SPEED_H
#define AUTOBALANCER_VARIABLE_SPEED_H

#include <stddef.h>

#include "base/failure.h"
#include "rotor/linear_rotor.h"

/* The rotor's matrices split by powers of the speed.  dof = axes n. */
typedef struct {
    int turning_force;
    int axes, parts; /* 1, 2 for an isotropic rotor, else 2, 1: see propagator.h */
    int dof, plane_count;
    double *still, *per_speed; /* (dof, 2 dof) */
    double *planes;            /* (axes p, dof) */
    double *force;             /* (dof, axes p) */
    double *unbalance;         /* (dof, axes) */
    double *falling;           /* (dof,) gravity, NULL without */
    int orders;                /* numbers that tell a force: 4 of a cubic, 6 of a quintic */
} VariableSpeedStep;

/* Doubles of the matrices, of the scratch for making them, and of that for the two functions. */
size_t variable_speed_size(int stations, int planes, int axes);
size_t variable_speed_scratch(int stations, int planes, int axes);

/* The matrices in `memory`; forces are cubics, unless `orders` is changed. */
int variable_speed_step(const LinearRotor *rotor, int turning_force, double *memory,
                        double *scratch, VariableSpeedStep *made, Failure *failure);

/* State (q, v) one `step` [s] later, in place, displacements to a share of 1e-10.

   state: (2 dof) elements, complex for an isotropic rotor, else q (x..., y...), v (x..., y...).
   forces: (orders, p) complex forces on the planes in the rotor frame (fixed axes when turning_force
   is 0) and their derivatives.  angle, speed: of the rotor at the start; spin_up (4,): its angular
   acceleration there and the derivatives of that of order 1 to 3. */
int variable_speed_advance(const VariableSpeedStep *method, double *state, const double *forces,
                           double angle, double speed, const double *spin_up, double step,
                           double *scratch, Failure *failure);

/* The same in `count` equal parts of which nothing is asked. */
int variable_speed_parts(const VariableSpeedStep *method, double *state, const double *forces,
                         double angle, double speed, const double *spin_up, double step,
                         int count, double *scratch, Failure *failure);

/* Acceleration and jerk of the stations, (dof,), at time t into the step; `rates` holds velocity and
   acceleration. */
void variable_speed_motion(const VariableSpeedStep *method, const double *state, const double *forces,
                           double angle, double speed, const double *spin_up, double t, double *rates,
                           double *jerks, double *scratch);

/* Acceleration and jerk of the planes in fixed axes, (axes p) elements, at time t into the step, to
   which `state` belongs; the other arguments belong to the start of the step. */
void variable_speed_plane_motion(const VariableSpeedStep *method, const double *state,
                                 const double *forces, double angle, double speed,
                                 const double *spin_up, double t, double *acceleration,
                                 double *jerk, double *scratch);

/* Under quintic forces the second derivative of the planes' acceleration, likewise. */
void variable_speed_plane_second(const VariableSpeedStep *method, const double *state,
                                 const double *forces, double angle, double speed,
                                 const double *spin_up, double t, double *second, double *scratch);

/* Torque of unbalance and internal damping on the shaft and its slope [N m, N m/s];
   models/steps/variable_speed.py has the equation.

   rates: velocity and acceleration of the stations; jerks: theirs; all else is of the same time. */
void shaft_torque(const VariableSpeedStep *method, const LinearRotor *rotor, const double *state,
                  const double *rates, const double *jerks, double angle, double speed,
                  double angular_acceleration, double *torque);

/* The same with arguments as those of variable_speed_plane_motion. */
void variable_speed_torque(const VariableSpeedStep *method, const LinearRotor *rotor,
                           const double *state, const double *forces, double angle, double speed,
                           const double *spin_up, double t, double *torque, double *scratch);

#endif
