/* Weights on a race that is not round, by themselves: as a machine's series, under a given motion of their plane. */
#ifndef AUTOBALANCER_WEIGHTS_RACE_H
#define AUTOBALANCER_WEIGHTS_RACE_H

#include "contact/track.h"
#include "machine/race_series.h"
#include "weights/centre.h"

typedef struct {
    int count;
    double per_rate;      /* unit of time [s] */
    SeriesWeight *weights;
    Pair *pull, *spin;    /* series of -i times the acceleration of the track's centre, and of E */
    Pair offset;          /* of that from the plane's [m] */
    Number *speed;        /* series of w */
} RaceSeries;

/* Memory for so many weights on a race with so many lobes; NULL where there is none. */
RaceSeries *race_allocate(Unit *unit, int count, int lobes);
/* The weights of a track whose parameters are checked. */
void race_take(RaceSeries *race, const Track *track);
/* Move weights (N,) over a step under a motion of the centre of their track, in place; 0, or with the reason. */
int race_advance(RaceSeries *race, double *angles, double *speeds, const CentreMotion *motion, double step,
                 Failure *failure);
/* Force on the plane beside that of the track's offset, and torque about the plane's centre, each with its slope, in
   the rotor's axes; accelerations (N,) of the angles in the rotor; NULL: not wanted. */
void race_answer(RaceSeries *race, const double *angles, const double *speeds, const Instant *centre, Complex *force,
                 double *torque, double *accelerations);
/* The same of weights whose series are complete up to the second order of their places, in a unit of time. */
void race_sum(const SeriesWeight *weights, int count, const Pair *spin, Pair offset, double speed, double rate,
              Complex *force, double *torque);

#endif
