/* What the files of the balls' unit share. */
#ifndef AUTOBALANCER_WEIGHTS_UNIT_H
#define AUTOBALANCER_WEIGHTS_UNIT_H

#include <stdbool.h>

#include "contact/track.h"
#include "fmi/unit.h"
#include "machine/carried.h"

enum { SIGNALS = 2 };

/* Inputs from the first of them on, and outputs; parameters are in weights_parameters.h, written by layout.py. */
enum { ANGLE = 8, SPEED = 9, ACCELERATION = 10 };
enum { ADDED_MASS = 4 }; /* behind the force and its slope */

typedef struct {
    int count;
    Track track;
    bool stop_at_contact; /* whether a step ends behind the first event */
    double through_port, sent; /* parts of the added mass: that, and in the force [kg] */
    Turned *turned; /* (N, 2) by the weights' angles */
    double *scratch;
    CarriedWeights *carried;
    bool is_given;    /* whether the whole machine has told what they push with: */
    Complex given[2]; /* as machine_reaction, */
    double given_torque[2];
} Balls;

/* -- weights_unit.c ------------------------------------------------------------------------ */

/* Whether weights with these parameters can touch one another, or stick; and the keys that decide it. */
bool weights_meet(const Unit *unit, const double *parameters);
bool weights_stick(const double *parameters);
extern const char WEIGHTS_EVENT_KEYS[];

/* -- weights_motion.c ---------------------------------------------------------------------- */

/* What collisions have left owed, and the pulse at the end of the last step, in the unit's memory. */
double *weights_impulses(const Unit *unit);
Complex weights_pulse(const Unit *unit);
/* How the plane's centre moves over the step, in the axes of the signals. */
CentreMotion find_plane_signal(const Unit *unit);
/* How the plane's centre and the rotor move at the end of the last step, or where inputs are set since.
   The weights' jump at a collision has the rotor's part in it: they do not feel how the plane answers the
   pulse, which is left out and given apart. */
Instant find_plane_motion(const Unit *unit, Complex *pulse_acceleration);

#endif
