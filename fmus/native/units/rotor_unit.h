/* What the files of the rotor's unit share. */
#ifndef AUTOBALANCER_ROTOR_UNIT_H
#define AUTOBALANCER_ROTOR_UNIT_H

#include <stdbool.h>

#include "base/elementary.h"
#include "fmi/unit.h"
#include "rotor/linear_rotor.h"
#include "rotor/propagator.h"
#include "rotor/restraint.h"
#include "rotor/taylor_step.h"
#include "units/angle.h"

enum { PLANAR, TWO_SUPPORT, FLEXIBLE, MATRICES };

/* Step matrices an instance keeps: a master that repeats steps asks for few. */
enum { KEPT_MATRICES = 8 };

/* In memory: the angle, then displacements and velocities of the stations, x and y alternating,
   then the speed the outputs belong to, how long ago the inputs were set, of every slider along
   x and y what friction.h says, and of every stop what restraint.h says. */
enum { MOTION = ANGLE_SIZE };

/* The speed and the added masses (p,) that something was made for; not made: something else. */
typedef struct {
    bool made;
    double speed, *added_mass;
} MadeFor;

/* A step matrix by columns, and what it is of. */
typedef struct {
    MadeFor of;
    uint64_t last; /* when it was asked for */
    double step;
    double *matrix;
} Kept;

/* A force of a support or foot: the bearing over the speed that it is of, from 0; below 0: none. */
typedef struct {
    int bearing;
} Force;

typedef struct {
    int kind, stations, planes, unbalances, turning;
    LinearRotor rotor;
    int axes, parts; /* as in propagator.h */
    int rows, columns; /* of a step matrix, in elements */
    double *rotor_memory, *loaded_mass;
    double *values; /* scratch for making the rotor */
    int *ports;
    Kept kept[KEPT_MATRICES];
    uint64_t clock;
    Turned turned[2]; /* the last two: passes ask for the ends of a step again and again */
    double *unsorted, *matrix_scratch;
    double *operand, *result; /* of a step matrix */
    TaylorStep taylor;
    MadeFor taylor_of; /* of a line of the bearings' table, whatever the speed on it */
    double *taylor_memory;
    double *later_forces; /* (4, 2p) on the planes, some time into a step */
    double *motion; /* (3, 2n) derivatives of the stations' displacements */
    double *sag; /* (2n,) of the stations under gravity */
    MadeFor sag_of;
    bool lifted;
    int slider_count; /* two for each of the unit's: along x and y */
    Slider *sliders;
    double *slider_states; /* as they are after what was propagated last; those of stops behind them */
    int cubic_count, stop_count;
    CubicSpring *cubics;
    Stop *stops;
    double *restraint_rows; /* (cubics + stops, n, 2) */
    double *slider_rows;    /* (sliders, n, 2) of given matrices */
    int force_count;
    Force *forces;
    double *force_rows;     /* (count, n, BEARING_NUMBERS) by the motion of the stations */
    int support_stations[2]; /* of a flexible rotor, from 0 */
    double reached;  /* length of the step as far as it came: it ends behind an event of a slider [s] */
} Rotor;

/* -- rotor_kinds.c: the parameters of each kind ----------------------------------------- */

int rotor_kind(const Layout *layout);
/* Start values that depend on index and size. */
void rotor_starts(const Layout *layout, double *real);
/* Value reference of the length from which on steps end at events of sliders; a unit with sliders. */
size_t rotor_shortest_stopped(const Unit *unit);
/* Make unit->own's rotor from the parameters; 0, or 1 with the reason. */
int rotor_of_parameters(Unit *unit);

/* -- rotor_given.c: a rotor whose matrices are the parameters ----------------------------- */

void rotor_given_starts(const Layout *layout, double *real);
int rotor_of_matrices(Unit *unit);

/* -- rotor_memory.c ---------------------------------------------------------------------- */

/* Where the memory holds the speed that the outputs belong to. */
double *rotor_speed_now(const Unit *unit);
/* Directions and forces of the sliders in the unit's memory. */
double *rotor_slider_states(const Unit *unit);
/* States of the stops in the unit's memory. */
double *rotor_stop_states(const Unit *unit);
/* What holds the rotor beside its matrices. */
Holds rotor_holds(const Rotor *own);

/* -- rotor_forces.c ---------------------------------------------------------------------- */

/* A whole number of a parameter, from 0 to `most`; below 0 with the reason. */
int rotor_whole_parameter(Unit *unit, size_t reference, int most);
/* Make the forces from the parameters, after all else; 0, or 1 with the reason. */
int rotor_set_forces(Unit *unit);
/* Forces x and y of supports, then feet, as the motion and the speed in the memory are. */
void rotor_observe_forces(const Unit *unit, double *out);

/* -- rotor_matrices.c ---------------------------------------------------------------------- */

enum { SPIN_UP = 1, SPUN = 5 }; /* behind the speed: its acceleration, and what comes after both */

/* Inputs: added masses, then speed, acceleration and its derivatives, then forces. */
double *rotor_inputs(Unit *unit);
/* Whether what was made is of this speed and the present added masses. */
bool rotor_is_of(const Unit *unit, const MadeFor *of, double speed);
/* The rotor with the present added masses, of which something is to be made; what was is no more. */
LinearRotor rotor_anew(Unit *unit, MadeFor *of);
/* It is made, of this speed and the present added masses. */
void rotor_made(const Unit *unit, MadeFor *of, double speed);

/* -- rotor_step.c ----------------------------------------------------------------------- */

/* Motion of the stations, and acceleration and jerk of the planes, after `step` [s], in own->result; all
   in fixed axes, x and y alternating; the acceleration is less gravity's, which every body on the rotor
   feels: what an accelerometer would read. */
int rotor_propagate(Unit *unit, double step);
/* Bring own->taylor up to date with the masses that the planes carry now; 1 with the reason. */
int rotor_make_taylor(Unit *unit);
/* The same before the rotor turns: its first speed may be told later, so that tables of bearings need not hold it. */
int rotor_make_first_taylor(Unit *unit);
/* Vectors (x, y alternating) turned by the angle with this cosine and sine; `to` may be `pairs`. */
void rotor_rotated(const double *pairs, size_t count, double c, double s, double *to);
/* Computed outputs from acceleration and jerk of the planes in fixed axes. */
void rotor_put(Rotor *own, const double *planes, double angle, double speed, double *out);
/* The computed outputs as they are with the present inputs. */
int rotor_outputs_now(Unit *unit, double *out);
/* Torque on the shaft and its slope at the present time; 1 with the reason. */
int rotor_torque_now(Unit *unit, double *torque);

/* -- rotor_gravity.c --------------------------------------------------------------------- */

/* Take the sag off the displacements in own->operand: about it the rotor moves as it would about
   zero without gravity.  0, or 1 with the reason. */
int rotor_lift(Unit *unit);
/* Put it back on those in own->result, where it was taken off, and take gravity off the planes'
   acceleration. */
void rotor_lower(Rotor *own);

#endif
