/* Steps of stiff machines: the motion as the polynomial whose accelerations are right at seven points.

   A series needs steps of some radians of the fastest motion, even where that has long died down.  The
   points of Radau's seventh rule bear any stiffness (order 13 at the end of a step, 7 within; Hairer &
   Wanner, Solving Ordinary Differential Equations II, IV.5 and IV.8; J. Comput. Appl. Math. 111, 1999).
   A step is solved by Newton's method with the derivatives at its start.  What comes out stands where the
   series of a machine stand, so that all that reads a series reads it. */
#ifndef AUTOBALANCER_COLLOCATION_H
#define AUTOBALANCER_COLLOCATION_H

#include "machine/machine.h"

enum {
    STAGES = 7,
    MODES = 4,               /* eigenvalues of the rule with an imaginary part of 0 or more */
    COLLOCATED = STAGES + 1, /* order of a series that reads the polynomial */
};

/* One step that is tried; (d,) are x and y of every station, the weights' angles, and the rotor's with a motor. */
typedef struct {
    Machine *at;       /* in which accelerations are computed */
    int unknowns;      /* d */
    double *start;     /* (3, d) places, speeds, accelerations at the start */
    double *by_place, *by_speed; /* (d, d) derivatives of the accelerations */
    double *places, *speeds;     /* (STAGES, d) at the points, less those at the start */
    double *rates;     /* (STAGES, d) accelerations */
    double *moved;     /* (STAGES, d) by the last pass */
    double *scratch;   /* (2, d) */
    Complex *factors;  /* (MODES, d, d) */
    Complex *right;    /* (d,) */
    int *rows;         /* (MODES, d) exchanged */
    double *held;      /* (2, STAGES + 1, N) at the start and the points: what weights would do alone, and their loads */
    Carried carried;   /* where the machine is carried: how, at the start */
    Pair *push;        /* (SIGNAL_ORDERS, n) series of the forces from outside */
    double angle, speed, acceleration; /* of the rotor at the start */
} Collocation;

/* Memory, in `unit`, for machines of these sizes; 1 where there is none. */
int collocation_allocate(Unit *unit, Collocation *made, int stations, int weights);
/* The state of a machine, in its coefficients of order 0, and the derivatives of its accelerations; `at`: the same
   machine, in which they are computed. */
void collocation_start(Collocation *c, const Machine *machine, Machine *at, double angle);
/* Solve a step of this length; its error over the tolerance, displacements over `largest`, angles over 1 rad;
   infinite where no solution is found. */
double collocation_solve(Collocation *c, double length, double tolerance, double largest);
/* Write the solution as the series of a machine, of order COLLOCATED. */
void collocation_write(const Collocation *c, double length, Machine *machine);
/* What a length may be multiplied by after this error over the tolerance. */
double collocation_factor(double error);

/* -- radau.c ------------------------------------------------------------------------------------------ */

extern const double RADAU_NODES[STAGES];
extern const double RADAU_MATRIX[STAGES][STAGES];       /* integrals up to the points from values at them */
extern const double RADAU_COEFFICIENTS[STAGES][STAGES]; /* of t, t^2, ... t^7, of what is 0 at 0 */
/* Eigenvalues of the matrix, and their left and right vectors, whose products are 1. */
extern const Complex RADAU_VALUES[MODES];
extern const Complex RADAU_LEFT[MODES][STAGES], RADAU_RIGHT[MODES][STAGES];

#endif
