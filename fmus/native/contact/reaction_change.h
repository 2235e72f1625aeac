/* How the force of the weights changes with what drives them: the differential of track_reaction,
   exact, for directional derivatives.  The Python units have none. */
#ifndef AUTOBALANCER_REACTION_CHANGE_H
#define AUTOBALANCER_REACTION_CHANGE_H

#include "base/failure.h"
#include "contact/centre.h"
#include "contact/track.h"

/* Changes of force and slope by those of what drives the weights: `by` holds the changes of
   acceleration, its slope and the rotor's speed, by_angular_acceleration that of w', by_change that of w''.  The other
   arguments are those of track_reaction; weights that stick or slide go on to do so. */
int track_reaction_change(const Track *track, const double *angles, const double *speeds,
                          const double *contacts, Complex acceleration, Complex slope,
                          double rotor_speed, double angular_acceleration, const Instant *by,
                          double by_angular_acceleration, double by_change, Complex *force,
                          Complex *force_slope, double *scratch, Failure *failure);

/* Changes of the sum of theta'' of all weights and of its slope (2,). */
int track_turning_change(const Track *track, const double *angles, const double *speeds,
                         const double *contacts, Complex acceleration, Complex slope,
                         double rotor_speed, double angular_acceleration, const Instant *by,
                         double by_angular_acceleration, double by_change, double *turned,
                         double *scratch, Failure *failure);

#endif
