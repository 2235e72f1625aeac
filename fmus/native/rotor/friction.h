/* Step of the linear rotor with dry friction in its supports, at constant or changing speed.

   Between events (a slider sticks, lets go or turns round) the system is linear: displacements,
   velocities and friction forces are Taylor series in time, whose recurrence takes the cubic forces,
   unbalance, gravity and a cubic angular acceleration as they are (Jorba & Zou 2005).  A stretch is
   half of what the fastest rate allows, so that the terms left out are below rounding, and every event
   function is a polynomial on it: its first fall below 0 is isolated by bounds of the polynomial and
   its slope, so that none is missed, and found to rounding.  Nothing is regularised: a rigid slider
   that sticks is a constraint, whose force follows from the acceleration being 0.  Which of several
   at rest let go is the least-squares solution within the limits (Moreau 1988: Gauss' principle), by
   projected Gauss-Seidel sweeps, which converge for any mass matrix. */
#ifndef AUTOBALANCER_FRICTION_H
#define AUTOBALANCER_FRICTION_H

#include <stddef.h>

#include "base/failure.h"
#include "rotor/linear_rotor.h"
#include "rotor/variable_speed.h"

/* Dry friction at a station along one axis (0 is x, 1 is y). */
typedef struct {
    int station, axis; /* from 0 */
    double limit;      /* force at which it slips [N]; 0: there is none */
    double stiffness;  /* of a spring in series [N/m]; 0: none, the slider is rigid */
} Slider;

/* What moves the rotor over a step; forces as for variable_speed_advance. */
typedef struct {
    const double *forces;
    double angle, speed;
    const double *spin_up; /* (4,) angular acceleration and its derivatives */
} Drive;

/* What friction remembers of each slider, in pairs: the direction in which it slips, -1 or 1, 0 while
   it sticks; and its force on the rotor [N]. */
enum { SLIPS, HOLDS };

typedef struct {
    const VariableSpeedStep *smooth; /* of two axes */
    const Slider *sliders;           /* (m,) */
    int count;                       /* m */
    double *push;                    /* (dof, m) acceleration by the sliders' forces */
    double norms[4];
    /* scratch: Taylor coefficients over a stretch, and what they are made of */
    double *motion, *forces, *pushes; /* (terms + 1, 2 dof), (terms + 1, m), (terms + 1, dof) */
    double *turn, *drive;             /* (terms + 1, 2), (terms + 1, 2 p + 2) */
    double *matrix, *rate, *mobility, *hold; /* (dof, 2 dof), (dof,), (m, m), (2 m,) */
    double *state, *slider_states, *limits;    /* (2 dof,), (2 m,), (m,) */
} FrictionStep;

/* Doubles that a step takes, and one in such an array, for a rotor that is not isotropic.

   FAILURE_RIGID_SLIDERS: two rigid ones at one station and axis. */
size_t friction_size(int stations, int planes, int count);
int friction_step(const LinearRotor *rotor, const VariableSpeedStep *smooth, const Slider *sliders,
                  int count, double *memory, FrictionStep *made, Failure *failure);

/* Sliders with slack springs; rigid ones slip with the rotor where it moves.

   rates: velocities of the stations, x and y alternating. */
void friction_at_start(const Slider *sliders, int count, const double *rates, double *slider_states);

/* The same behind a jump of the velocities: springs keep their force. */
void friction_at_jump(const Slider *sliders, int count, const double *rates, double *slider_states);

/* State (q, v), x before y, and sliders one `step` [s] later, in place; with `stops` behind the first
   event at most, such that *reached [s] is 0 for one at the start. */
int friction_advance(FrictionStep *method, double *state, double *slider_states, const Drive *drive,
                     double step, int stops, double *reached, Failure *failure);

/* Whether each rigid slider at rest sticks or slips at time t, in place. */
int friction_resolve(FrictionStep *method, const double *state, double *slider_states, const Drive *drive,
                     double t, Failure *failure);

/* Velocity and acceleration, (2 dof,), and jerk, (dof,), of the stations at time t, x before y; with
   state NULL what the forces alone add to them. */
int friction_motion(FrictionStep *method, const double *state, const double *slider_states,
                    const Drive *drive, double t, double *rates, double *jerks, Failure *failure);

/* Acceleration and jerk of the planes in fixed axes, (2 p,) each, x before y, and the friction
   forces, at time t; with state NULL what the forces alone add to them. */
int friction_plane_motion(FrictionStep *method, const double *state, double *slider_states,
                          const Drive *drive, double t, double *acceleration, double *jerk,
                          Failure *failure);

#endif
