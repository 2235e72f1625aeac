/* A rotor on viscous-elastic supports as one linear system.

       M q'' + (C + C_i - w G J) q' + (K - w C_i J) q = u (w^2 - i w') e^{i beta} + S^T F

   Vectors are pairs x, y.  An isotropic rotor has one axis of complex elements (axes 1, parts 2), any
   other two axes of real ones (axes 2, parts 1), x and y alternating: the same doubles.  dof = axes n.

   Bearings with cross terms push along one axis by motion along the other one, and may change with the
   speed, on lines between the rows of a table. */
#ifndef AUTOBALANCER_LINEAR_ROTOR_H
#define AUTOBALANCER_LINEAR_ROTOR_H

#include <stdbool.h>
#include <stddef.h>

#include "base/failure.h"
#include "base/spin.h"

#define SINGULAR_MATRIX "Singular matrix"

/* Of a bearing, in this order: k xx, xy, yx, yy [N/m], c xx, xy, yx, yy [N s/m]. */
enum { BEARING_NUMBERS = 8 };

/* Bearings whose force follows from the speed. */
typedef struct {
    int count, speed_count; /* 0: none */
    int line;               /* on which the speed is, from 0; below 0: the one that holds it */
    const double *speeds;   /* (speed_count,) ascending [rad/s] */
    const double *rows;     /* (count, n) displacement across each */
    const double *values;   /* (count, speed_count, BEARING_NUMBERS) */
} Bearings;

/* Matrices and planes of a rotor with n stations and p correction planes; see models/rotor.py. */
typedef struct {
    int stations;    /* n */
    int plane_count; /* p */
    int deflections; /* d: n - 2, at least 1 */
    double *mass;    /* (n, n) [kg] */
    double *damping_x, *damping_y;     /* (n, n) [N s/m] */
    double *stiffness_x, *stiffness_y; /* (n, n) [N/m] */
    double *damping_xy, *damping_yx;     /* (n, n) force along x by velocity along y, and the other way */
    double *stiffness_xy, *stiffness_yx; /* (n, n) */
    double *internal_damping;          /* (n, n) [N s/m] */
    double *gyroscopic;                /* (n, n) [kg] */
    double *planes;                    /* (p, n) */
    double *unbalance;                 /* (n,) complex [kg m] */
    double *deflection;                /* (d, n) */
    Bearings bearings;                 /* beside those in the matrices */
    double gravity[2]; /* acceleration of what falls, x and y [m/s^2] */
    bool sliders;      /* whether its supports have dry friction, stops or cubic springs, which set axes apart */
    bool crossed;      /* whether any of the cross terms is not 0 */
} LinearRotor;

/* Doubles that the matrices of a rotor take, and a rotor of zeros in such an array. */
size_t linear_rotor_size(int stations, int planes);
LinearRotor linear_rotor_in(double *memory, int stations, int planes);

/* Discs on a massless shaft. */
typedef struct {
    const double *stations, *masses; /* (n,) */
    int supports[2];                 /* numbers of stations, from 1 */
    const double *carriers;          /* (2, 4) stiffness x, y and damping x, y of the supports */
    double bending_stiffness;        /* E I, where compliance is NULL */
    const double *compliance;        /* (n - 2, n - 2) [m/N], or NULL */
    double internal_damping;
    int unbalance_count;
    const double *unbalances; /* (u, 3) position, amount, angle */
    const int *ports;         /* (p,) stations of the planes, from 0 */
} Flexible;

/* Set a rotor (from linear_rotor_in, of the right sizes); 0, or 1 with the failure.

   A disc in one plane with p ports at it: mass, stiffness x, y, damping x, y, internal damping, amount
   and angle of the unbalance.  A rigid rotor on two supports: mass, inertia, polar inertia, span, centre
   of mass, stiffness x, y and damping x, y of each support, places of the planes, and u times position,
   amount and angle of an unbalance. */
void linear_rotor_planar(const double *values, LinearRotor *rotor);
int linear_rotor_two_support(const double *values, int unbalances, LinearRotor *rotor,
                             Failure *failure);
/* `scratch` has linear_rotor_flexible_scratch doubles. */
size_t linear_rotor_flexible_scratch(int stations);
int linear_rotor_flexible(const Flexible *values, LinearRotor *rotor, double *scratch,
                          Failure *failure);

/* The line of the table that holds a speed: `line` itself where it does, of those outside the nearest one. */
int linear_rotor_line(const LinearRotor *rotor, double speed, int line);
/* Whether a table holds a speed, but for rounding. */
bool linear_rotor_holds(const LinearRotor *rotor, double speed);
/* A bearing on a line: its numbers at speed 0, and by the speed. */
void linear_rotor_bearing(const LinearRotor *rotor, int bearing, int line, double *still, double *slope);

/* True when both axes are alike and apart, so that z = x + i y needs no conjugate. */
int linear_rotor_isotropic(const LinearRotor *rotor);

/* The same rotor carrying added_mass (p,) [kg] rigidly at its planes; its mass matrix is `mass`
   (n, n), the others are shared. */
LinearRotor linear_rotor_with_added_mass(const LinearRotor *rotor, const double *added_mass,
                                         double *mass);

int linear_rotor_heavy(const LinearRotor *rotor);
/* Displacements at rest under gravity (n pairs); 1 where the supports have no stiffness.  `scratch` is that of a step matrix. */
int linear_rotor_sag(const LinearRotor *rotor, double speed, double *sag, double *scratch,
                     Failure *failure);

/* Rows (dof, 2 dof + axes (p + 1)) of the acceleration by displacements, velocities, forces on the
   planes and the unbalance's pull w^2 e^{i beta}, at a constant speed w [rad/s].  scratch: 3 parts
   dof^2 doubles; 1 where the mass matrix is singular. */
int linear_rotor_rows(const LinearRotor *rotor, double speed, double *rows, double *scratch,
                      Failure *failure);

/* Rows (count, n) of real numbers times n vectors. */
void combine_vectors(const double *rows, int count, int n, const double *vectors, double *result);

/* Torque of unbalance and internal damping on the shaft and its slope [N m, N m/s];
   models/steps/variable_speed.py has the equation.

   state: displacements of the stations; rates: their derivatives of order 1 to 3; spin: of the rotor,
   all of the same time. */
void linear_rotor_torque(const LinearRotor *rotor, const double *state, const double *rates,
                         const Spin *spin, double *torque);

#endif
