/* Weights of finite size on one track: packed groups and forces between them. */
#ifndef AUTOBALANCER_CONTACT_H
#define AUTOBALANCER_CONTACT_H

#include "base/complex_number.h"

/* Runs of neighbours of a chain of at most N weights that share one value. */
typedef struct {
    int count;              /* of pools; the entries beyond it mean nothing */
    int *first, *size;      /* (N,) first weight of the chain in a pool, and how many it has */
    double *forcing, *limit; /* (N,) sums over its weights */
    double *mass;           /* (N,) */
    double *value;          /* (N,) what its weights share */
} Pools;

/* sin(n alpha)/(n sin alpha): mean forcing of a packed group in units of one weight's. */
double group_factor(int count, double alpha);

/* Set `pools` to the accelerations of a chain of touching weights: Gauss's principle.

   forcings: (length,) free accelerations along increasing angle; limits: (length,) resistance of
   weights at rest, or NULL; both times the masses (length,), NULL: 1; slack: tension that is taken
   for rounding. */
void pool_violators(Pools *pools, const double *forcings, const double *limits,
                    const double *masses, int length, double slack);

/* Give every weight of a chain the value of its pool. */
void expand_pools(const Pools *pools, double *values);

#endif
