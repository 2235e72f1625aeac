/* What a unit calls: motion of a track's weights over a step, and their force on the rotor. */
#ifndef AUTOBALANCER_MOTION_H
#define AUTOBALANCER_MOTION_H

#include <stddef.h>

#include "contact/track.h"

/* State at the end of a communication step. */
typedef struct {
    double *angles, *speeds; /* (N,) in the rotor [rad, rad/s] */
    double *contacts; /* (N,) 1 where a weight lastingly touches the next along the track */
    Complex impulse; /* of the collisions in this step on the rotor, rotor frame at its end
                        [N s]; what is not in the force of track_reaction */
    int events; /* collisions, contacts opened, weights stuck or broken away */
    double reached; /* time since the start of the step [s]: `step`, or the first event */
} Moved;

/* Doubles of scratch for the functions below. */
size_t track_scratch(int count);

/* Static moment about the plane's centre, sum m (e + R e^{i theta}), rotor frame [kg m]. */
Complex track_static_moment(const Track *track, const double *angles, Turned *turned);

/* `contacts` (N,) of a fresh start: weights that touch and move alike, whatever drives them. */
int track_first_contacts(const Track *track, const double *angles, const double *speeds,
                         double *contacts, double *scratch, Failure *failure);

/* Move the weights of an eventful track over one communication step.

   angles, speeds, contacts: state, contacts all 0 for a fresh start; the arrays of `moved` may be
   the same, and have no meaning after a failure.  motion: of the track's centre, whose rotor is
   accelerated uniformly, from the angle 0 on.  stops: whether the
   step ends behind its first event. */
int track_advance(const Track *track, const double *angles, const double *speeds,
                  const double *contacts, const CentreMotion *motion, double step, bool stops,
                  Moved *moved, double *scratch, Failure *failure);

/* Residual force on the rotor in the rotor frame and its slope, without impulses; plane: how the plane's
   centre moves; turned: as of weights_reaction. */
int track_reaction(const Track *track, const double *angles, const double *speeds,
                   const double *contacts, const Instant *plane, Complex *force, Turned *turned,
                   double *scratch, Failure *failure);

/* Torque of the weights on the rotor about the plane's centre and its slope, without impulses.

   force: of track_reaction, and its slope. */
int track_torque(const Track *track, const double *angles, const double *speeds,
                 const double *contacts, const Instant *plane, const Complex *force, double *torque,
                 double *scratch, Failure *failure);

#endif
