/* The impact law: speeds of weights and of their rotor jump together, while nothing moves.

   The rotor's velocity is eliminated.  With the mobility W_pq [1/kg] of the planes (velocity of plane p
   for a unit impulse on plane q, all balancers counted as added mass) the angles of the weights have the
   inertia

       B_kl = kappa m R^2 delta_kl - (m R)_k (m R)_l W_pq cos(theta_k - theta_l).

   G has a row -1, 1 for each pair of neighbours that touch.  The speeds jump by B^-1 G^T L; impulses L
   between neighbours push, and no gap opens more slowly than e times its speed of closing:

       0 <= L,   0 <= G (v+ + e v-),   and one of the two is 0 for each pair.

   Newton's restitution for several pairs at once: Moreau 1988, doi:10.1007/978-3-7091-2624-0_1.  Energy
   does not grow. */
#ifndef AUTOBALANCER_IMPACT_LAW_H
#define AUTOBALANCER_IMPACT_LAW_H

#include <stdbool.h>
#include <stddef.h>

#include "base/complex_number.h"
#include "base/failure.h"

/* A weight. */
typedef struct {
    int plane;         /* from 0 */
    double inertia;    /* kappa m R^2 [kg m^2] */
    double moment;     /* m R [kg m] */
    double before;     /* angular speed before the impact [rad/s] */
    Complex direction; /* e^{i theta} in the rotor */
} ImpactWeight;

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
    const double *mobility; /* (p, p) of the planes [1/kg]; NULL: `jumps` is given */
    int planes;             /* p */
    int count;              /* weights, n, */
    int contacts;           /* and pairs that touch, c */
    ImpactWeight *weights;
    ImpactPair *pairs;
    double *rate;     /* (n,) angular speeds [rad/s] */
    double *impulse;  /* (c,) L [kg m^2/s] */
    double *jumps;    /* (n, c) B^-1 G^T */
    double *openings; /* (n, n) scratch: G B^-1 G^T (c, c), and B before it */
    double *square;   /* (n, n) scratch */
} Impact;

/* Doubles of the arrays for at most `count` weights, each of which touches the next. */
size_t impact_doubles(int count);

/* No weights yet, in an array of that many doubles. */
Impact impact_begin(const double *mobility, int planes, int count, double *memory);

/* Speed at which the gap of a pair opens [rad/s]. */
double impact_opening(const Impact *impact, int contact);

/* Let all pairs that touch collide until none approaches; 0, or 1 with the failure. */
int impact_solve(Impact *impact, Failure *failure);

/* Impulse on a plane of the rotor, in its axes [N s]. */
Complex impact_on_plane(const Impact *impact, int plane);

#endif
