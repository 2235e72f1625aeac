/* Balls, rollers and pendulums of an auto-balancer in the frame of the rotor. */
#ifndef AUTOBALANCER_WEIGHTS_H
#define AUTOBALANCER_WEIGHTS_H

#include "base/elementary.h"
#include "base/failure.h"

#define TOO_MANY_SUBSTEPS                                                                         \
    "the weights would need %3 substeps in %6 s: acceleration %6 m/s^2, rate %6 rad/s: use "      \
    "smaller communication steps"

/* N weights on one track, rho e^{i theta} from its centre: rho = R + sum of amplitude cos n (theta - angle). */
typedef struct {
    int count;           /* N */
    double mass;         /* of each [kg] */
    double track_radius; /* of the weights' centres R [m] */
    double drag;         /* viscous, of each, b [N s/m] */
    double kappa;        /* 7/5 ball, 3/2 roller, 1 pendulum */
    double radius;       /* of a body that rolls r [m] */
    const double *each;  /* (3, N) mass, drag and radius of each over those above; NULL: all alike */
    int lobes;           /* kinds of lobes of a race that is not round; 0: a circle */
    const double *lobe;  /* (lobes, 3) how many, amplitude [m], angle in the rotor [rad] */
} Weights;

/* Weight k alone, with its own mass, drag and radius. */
Weights weights_single(const Weights *weights, int k);
/* Mass of weight k over `mass`. */
double weights_mass_ratio(const Weights *weights, int k);

double weights_added_mass(const Weights *weights);   /* N m [kg] */
double weights_lever(const Weights *weights);        /* 1/(kappa R) [1/m] */
double weights_damping_rate(const Weights *weights); /* d = b/(kappa m) [1/s] */
/* Sum of m rho e^{i theta} in the rotor frame [kg m]; turned: (N, 2) as `turned_by` keeps them, or NULL. */
Complex weights_static_moment(const Weights *weights, const double *angles, Turned *turned);
/* |sum e^{2 i theta}|/N: 0 for evenly spread weights, 1 for a pair. */
double weights_alignment(int count, const double *angles, Turned *turned);

#endif
