/* The liquid auto-balancer of Dubovik 2006. */
#ifndef AUTOBALANCER_LIQUID_H
#define AUTOBALANCER_LIQUID_H

#include "base/complex_number.h"
#include "base/failure.h"

typedef struct {
    double chamber_radius, float_radius, height; /* [m] */
    double density;                              /* [kg/m^3] */
} Liquid;

int liquid_check(const Liquid *liquid, Failure *failure);
double liquid_gap(const Liquid *liquid);        /* r1 - r2 [m] */
double liquid_mass(const Liquid *liquid);       /* m2 = rho pi (r1^2 - r2^2) h [kg] */
double liquid_added_mass(const Liquid *liquid); /* r m2 = rho pi r1^2 h [kg] */
/* What is left of the gap when the chamber's centre is displaced [m]. */
double liquid_clearance(const Liquid *liquid, Complex displacement);

#endif
