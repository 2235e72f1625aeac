/* What the files of the balls' unit share. */
#ifndef AUTOBALANCER_UNIT_WEIGHTS_H
#define AUTOBALANCER_UNIT_WEIGHTS_H

#include "base/signals.h"
#include "contact/motion.h"
#include "fmi/unit.h"
#include "weights/quintic_weights.h"

enum { SIGNALS = 2 };

/* Parameters, and inputs from the first of them on. */
enum { MASS, TRACK_RADIUS, KAPPA, DRAG, WEIGHT_RADIUS, RESTITUTION, MOBILITY, ROLLING };
enum { OFFSET_XI = 8, OFFSET_ETA = 9 };
enum { SHORTEST_STOPPED = 10, FIRST_ANGLE = 11 };
/* with quintic signals two derivatives more stand before these */
enum { ANGLE = 8, SPEED = 9, ACCELERATION = 10 };
enum { INPUTS = 14 }; /* the last of them derivatives of the acceleration */
enum { FORCE = 0, FORCE_SLOPE = 2, ADDED_MASS = 4 };

typedef struct {
    int count;
    int orders; /* numbers that tell a signal: value and derivatives */
    Track track;
    int plain;            /* point weights on a centred track keep their shorter way */
    int stop_at_contact;  /* whether a step ends behind the first event */
    double carried, sent; /* parts of the added mass: through the port, in the force [kg] */
    Quadrature quadrature;
    QuinticQuadrature quintic;
    Turned *turned; /* (N, 2) by the weights' angles */
    double *scratch;
} Balls;

/* The inputs, from where angle, speed and acceleration have their names. */
static inline const double *weights_drive(const Unit *unit)
{
    return unit->real + unit->layout.inputs.first + 2 * (unit->layout.sizes.order - 3);
}

/* The rotor's motion at the present time. */
typedef struct {
    Complex acceleration, slope; /* of the plane's centre, rotor frame, without */
    Complex pulse_acceleration;            /* what the plane answers a pulse with */
    Complex second;              /* its second derivative, with quintic signals */
    double angle, speed, spin_up, change, curvature; /* each the next one's integral; the last three
                                                        side by side, derivatives of the speed */
} RotorMotion;

/* -- weights_motion.c ---------------------------------------------------------------------- */

/* What collisions have left owed, and the pulse at the end of the last step, in the unit's memory. */
double *weights_impulses(const Unit *unit);
Complex weights_pulse(const Unit *unit);
/* A vector and its slope seen in axes that turn with the rotor. */
void weights_rotating(double angle, double speed, Complex *value, Complex *slope);
/* And its second derivative, from the vector in fixed axes. */
Complex weights_rotating_second(double angle, double speed, double spin_up, Complex value,
                                Complex slope, Complex second);
/* At the end of the last step, or where inputs are set since.  The weights' jump at a collision has the
   rotor's part in it: they do not feel how the plane answers the pulse. */
RotorMotion weights_motion_now(const Unit *unit);

#endif
