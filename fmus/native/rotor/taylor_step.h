/* Step of the linear rotor at any speed, with and without dry friction in its supports.

   Displacements, velocities and friction forces are Taylor series in time, whose recurrence takes the
   polynomial forces, unbalance, gravity and a cubic angular acceleration as they are (Jorba & Zou 2005).
   A stretch is half of what the fastest rate allows, so that the terms left out are below rounding.

   Between events (a slider sticks, lets go or turns round, a stop is touched or lets go) every event
   function is a polynomial on a stretch: its first fall below 0 is isolated by bounds of the polynomial
   and its slope, so that none is missed, and found to rounding.  With cubic springs and stops the system is
   not linear: the last terms of a stretch shorten it.  Nothing is regularised: a rigid slider
   that sticks is a constraint, whose force follows from the acceleration being 0.  Which of several
   at rest let go is the least-squares solution within the limits (Moreau 1988: Gauss' principle), by
   projected Gauss-Seidel sweeps, which converge for any mass matrix. */
#ifndef AUTOBALANCER_TAYLOR_STEP_H
#define AUTOBALANCER_TAYLOR_STEP_H

#include <stddef.h>

#include "base/failure.h"
#include "rotor/friction.h"
#include "rotor/linear_rotor.h"
#include "rotor/push_series.h"
#include "rotor/restraint.h"

/* What holds a rotor beside its matrices. */
typedef struct {
    const Slider *sliders;
    const CubicSpring *cubics;
    const Stop *stops;
    int slider_count, cubic_count, stop_count;
} Holds;

typedef struct {
    const Slider *sliders; /* (m,) of a rotor of two axes */
    int count;             /* m */
    int parts, dof;        /* as in linear_rotor.h */
    int half, length;      /* doubles of all displacements, and of (q, v, forces, pull) */
    int plane_count;       /* p */
    const double *planes;  /* (p, n) */
    double gravity[2];
    double *still, *per_speed; /* (dof, length doubles) acceleration by (q, v, forces, pull) */
    double *push;              /* (dof, m) acceleration by the sliders' forces */
    double norms[4];
    /* scratch: Taylor coefficients over a stretch, and what they are made of */
    double *series, *forces, *turn; /* (terms + 1, length), (terms + 1, m), (terms + 1, 2) */
    double *matrix, *rate, *faster, *mobility, *hold; /* as still, (half,) twice, (m, m), (2 m,) */
    double *slider_states, *limits;                   /* as of the sliders and stops, (m,) */
    Holds holds;
    double *answers;        /* (cubics + stops, half) acceleration of each place by a force across the row */
    double *restraint_data; /* series of each cubic spring and stop */
} TaylorStep;

/* -- taylor_setup.c --------------------------------------------------------------------------------- */

/* Doubles of the states of sliders, then stops. */
size_t holds_doubles(const Holds *holds);

/* Doubles that a step takes, and one in such an array, for a rotor that carries what its planes do.

   scratch: that of a step matrix; 1: two rigid sliders at one station and axis. */
size_t taylor_step_size(int stations, int planes, const Holds *holds);
int taylor_step_in(double *memory, const LinearRotor *rotor, const Holds *holds, double *scratch, TaylorStep *made,
                   Failure *failure);

/* -- taylor_step.c ---------------------------------------------------------------------------------- */

/* State (q, v), sliders and stops one `step` [s] later, in place; with `stops` behind the first event at most,
   such that *reached [s] is 0 for one at the start. */
int taylor_advance(TaylorStep *method, double *state, double *slider_states,
                   const Excitation *excitation, double step, int stops, double *reached,
                   Failure *failure);

/* Whether each rigid slider at rest sticks or slips at time t, and each stop presses, in place. */
int taylor_resolve(TaylorStep *method, const double *state, double *slider_states,
                   const Excitation *excitation, double t, Failure *failure);

/* Derivatives of the displacements at time t, of order 1 to 3. */
int taylor_motion(TaylorStep *method, const double *state, const double *slider_states,
                  const Excitation *excitation, double t, double *rates, Failure *failure);

/* Acceleration and jerk of the planes in fixed axes at time t, and the friction forces. */
int taylor_plane_motion(TaylorStep *method, const double *state, double *slider_states,
                        const Excitation *excitation, double t, double *planes, Failure *failure);

#endif
