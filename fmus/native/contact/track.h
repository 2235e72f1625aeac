/* A track and the weights on it: the parameters, and what follows from them alone. */
#ifndef AUTOBALANCER_TRACK_H
#define AUTOBALANCER_TRACK_H

#include <stdbool.h>

#include "base/complex_number.h"
#include "base/failure.h"
#include "weights/weights.h"

enum { MOST_LOBES = 1000 }; /* around a race */
#define TOUCHING_ANGLE 1e-11 /* rad: neighbours this close collide together */

/* Weights on a track, with the options that a scene may switch on. */
typedef struct {
    Weights weights;           /* as point weights */
    double weight_radius;      /* r [m]; 0: they pass through each other */
    double restitution;        /* of a collision of two weights, 0 to 1 */
    double mobility;           /* of the plane with all that it carries [1/kg]; 0: it is held */
    double rolling_resistance; /* mu, resistance over load; 0: none */
    Complex offset;            /* of the track's centre from the plane's, rotor frame [m] */
    /* set by track_prepare */
    double alpha;        /* half the angle between weights that touch [rad] */
    double moment;       /* m R [kg m] */
    bool solid;          /* there are weights that can meet */
    bool full;           /* they fill the track: each touches both neighbours for ever */
    bool eventful;       /* weights can collide or stick */
} Track;

/* What acts between weights that touch, and between a weight and the track. */
typedef struct {
    double restitution, resistance; /* e; mu over load */
} Touch;

Touch track_touch(const Track *track);
/* Check the parameters and set what follows from them; 0, or what is not allowed. */
int track_prepare(Track *track, Failure *failure);
/* Static moment about the plane's centre, sum m (e + R e^{i theta}), rotor frame [kg m]; turned: as of
   weights_static_moment. */
Complex track_static_moment(const Track *track, const double *angles, Turned *turned);

#endif
