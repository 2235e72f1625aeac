/* The impact law: speeds of weights jump, and their rotor's with them, while nothing moves.

   The rotor's velocity is eliminated: B is the inertia that the angles of the weights have on it.  G has a row
   -1, 1 for each pair of neighbours that touch.  The speeds jump by B^-1 G^T L; impulses L between neighbours
   push, and no gap opens more slowly than e times its speed of closing:

       0 <= L,   0 <= G (v+ + e v-),   and one of the two is 0 for each pair.

   Newton's restitution for several pairs at once: Moreau 1988, doi:10.1007/978-3-7091-2624-0_1.  Energy
   does not grow. */
#ifndef AUTOBALANCER_IMPACT_LAW_H
#define AUTOBALANCER_IMPACT_LAW_H

#include <stdbool.h>
#include <stddef.h>

#include "base/failure.h"

/* Two weights that touch, along increasing angle. */
typedef struct {
    int behind, ahead;
    bool lasting;       /* whether they cannot part */
    bool pushing;       /* whether L > 0 */
    double restitution; /* e */
    double right;       /* (1 + e) G v- */
} ImpactPair;

/* The weights of all tracks on one rotor, and the pairs of them that touch. */
typedef struct {
    int count;    /* weights, n, */
    int contacts; /* and pairs that touch, c */
    ImpactPair *pairs;
    double *rate;     /* (n,) angular speeds [rad/s] */
    double *impulse;  /* (c,) L [kg m^2/s] */
    double *jumps;    /* (n, c) B^-1 G^T */
    double *openings; /* (c, c) G B^-1 G^T */
    double *square;   /* (c, c) scratch */
} Impact;

/* Doubles of the arrays for at most `count` weights, each of which touches the next. */
size_t impact_doubles(int count);

/* So many weights and no pairs yet, in an array of that many doubles; rates and jumps are whoever adds them to set. */
Impact impact_begin(int count, double *memory);

/* Speed at which the gap of a pair opens [rad/s]. */
double impact_opening(const Impact *impact, int contact);

/* Let all pairs that touch collide until none approaches; 0, or 1 with the failure. */
int impact_solve(Impact *impact, Failure *failure);

#endif
