/* What the files of the balls' unit share. */
#ifndef AUTOBALANCER_UNIT_WEIGHTS_H
#define AUTOBALANCER_UNIT_WEIGHTS_H

#include "motion.h"
#include "signals.h"
#include "unit.h"

enum { SIGNALS = 2 };

/* Parameters, and inputs from the first of them on. */
enum { MASS, TRACK_RADIUS, KAPPA, DRAG, WEIGHT_RADIUS, RESTITUTION, ROLLING };
enum { OFFSET_XI = 7, OFFSET_ETA = 8 };
enum { SHORTEST_STOPPED = 9, FIRST_ANGLE = 10 };
enum { ANGLE = 8, SPEED = 9, ACCELERATION = 10 };
enum { FORCE = 0, FORCE_SLOPE = 2, ADDED_MASS = 4 };

typedef struct {
    int count;
    Track track;
    int plain;            /* point weights on a centred track keep their shorter way */
    int stop_at_contact;  /* whether a step ends behind the first collision */
    double carried, sent; /* parts of the added mass: through the port, in the force [kg] */
    Quadrature quadrature;
    double *scratch;
} Balls;

/* A vector and its slope seen in axes that turn with the rotor. */
void weights_rotating(double angle, double speed, Complex *value, Complex *slope);
/* Acceleration and its slope now, in the rotor frame. */
void weights_motion_now(const Unit *unit, Complex *acceleration, Complex *slope);

/* -- unit_weights_derivatives.c: as in `Equations` -------------------------------------------- */

int weights_directional(Unit *unit, const double *seed, double *change);
int weights_slope(Unit *unit, size_t reference, double *value);

#endif
