/* Steps of stiff machines: the motion as the polynomial whose accelerations are right at the points of a rule.

   A series needs steps of some radians of the fastest motion, even where that has long died down.  The
   points of Radau's rules bear any stiffness (with s points of order 2 s - 1 at the end of a step, s within; Hairer &
   Wanner, Solving Ordinary Differential Equations II, IV.5 and IV.8; J. Comput. Appl. Math. 111, 1999).
   A step is solved by Newton's method with the derivatives at its start, then with those in its middle.  What
   comes out stands where the series of a machine stand.  Of eleven points it is a sum of Chebyshev's polynomials:
   in powers of the time it would lose 8 digits.  Of seven points it is in powers, whose roots are events. */
#ifndef AUTOBALANCER_COLLOCATION_H
#define AUTOBALANCER_COLLOCATION_H

#include "machine/machine.h"

enum {
    MOST_STAGES = 11,
    MOST_MODES = 6,
    OF_POWERS = 9, /* order of a series from seven points: events ask of forces for orders behind those of the polynomial,
                      which are 0 */
};

/* Radau's rule with s points: radau.c. */
typedef struct {
    int stages, modes;     /* s, and eigenvalues of its matrix with an imaginary part of 0 or more */
    const double *nodes;   /* (s,) */
    const double *matrix;  /* (s, s) integrals up to the points from values at them */
    /* of polynomials that are 0 at 0, from values at the points: */
    const double *slopes;  /* (s,) at 0 */
    const double *powers;  /* (s, s) what t, t^2, ... t^s have in them; NULL where that is not read */
    const double *sums;    /* (s + 1, s) what T_k(2 t - 1) has in them; NULL where that is not read */
    /* eigenvalues of the matrix (modes,), and their left and right vectors (modes, s), whose products are 1 */
    const Complex *values, *left, *right;
} Radau;

extern const Radau RADAU_THREE, RADAU_SEVEN, RADAU_ELEVEN;

/* One step that is tried; (d,) are x and y of every station, the weights' angles, and the rotor's with a motor. */
typedef struct {
    const Radau *rule;
    Machine *at;       /* in which accelerations are computed */
    int unknowns;      /* d, */
    int displacements; /* of which the first are of stations */
    bool are_apart;    /* whether no number changes the acceleration of another: weights that are carried and cannot touch */
    double *start;     /* (3, d) places, speeds, accelerations at the start */
    double *middle;    /* (3, d) the same in the middle of a step */
    double *by_place, *by_speed; /* (d, d) derivatives of the accelerations */
    double *places, *speeds;     /* (s, d) at the points, less those at the start */
    double *rates;     /* (s, d) accelerations */
    double *moved;     /* (s, d) by the last pass */
    double *scratch;   /* (2, d) */
    Complex *factors;  /* (modes, d, d) */
    Complex *right;    /* (d,) */
    int *rows;         /* (modes, d) exchanged */
    double *held;      /* (2, s + 1, N) at the start and the points: what weights would do alone, and their loads */
    Carried carried;   /* where the machine is carried: how, at the start */
    Pair *push;        /* (SIGNAL_ORDERS, n) series of the forces from outside */
    double angle, speed, acceleration; /* of the rotor at the start */
    int passes;        /* that the last step took */
} Collocation;

/* -- collocation.c ------------------------------------------------------------------------------ */

/* Memory, in `unit`, for machines of these sizes; 1 where there is none. */
int collocation_allocate(Unit *unit, Collocation *made, int stations, int weights);
/* Solve a step of this length; its error over the tolerance, displacements over `largest`, angles over 1 rad;
   infinite where no solution is found. */
double collocation_solve(Collocation *c, double length, double tolerance, double largest);
/* What the length may be multiplied by after this error over the tolerance. */
double collocation_factor(const Collocation *c, double error);

/* -- collocation_modes.c --------------------------------------------------------------------------- */

/* Factors of all systems for a step of this length; 1 where one is singular. */
int collocation_factorise(const Collocation *c, double length);
/* c->right becomes the solution with an eigenvalue. */
void collocation_solve_mode(const Collocation *c, int mode);

/* -- collocation_machine.c ------------------------------------------------------------------------- */

/* The state of a machine, in its coefficients of order 0, and its accelerations; `at`: the same machine, in which they
   are computed. */
void collocation_start(Collocation *c, const Machine *machine, Machine *at, double angle);
/* Accelerations so long after the start. */
void collocation_accelerate(const Collocation *c, double time, const double *places, const double *speeds, double *rates);
/* Keep what weights that touch or stick would do alone, and their loads, at the start or a point from 1 on. */
void collocation_keep_holds(const Collocation *c, int point);
/* Derivatives at a state so long after the start: places, speeds, accelerations (3, d). */
void collocation_differentiate(const Collocation *c, double time, double *state);
/* Write the solution as the motion of a machine in its step. */
void collocation_write(const Collocation *c, double length, Machine *machine);

#endif
