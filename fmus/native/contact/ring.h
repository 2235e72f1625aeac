/* The weights of a track in the order in which they stand on it, and who touches whom.

   Weights that are linked are a run of neighbours, given by its first weight and its size; it may
   pass the last weight and go on with the first. */
#ifndef AUTOBALANCER_RING_H
#define AUTOBALANCER_RING_H

#include <stddef.h>

#include "base/failure.h"
#include "contact/track.h"

/* Runs of neighbours among N weights. */
typedef struct {
    int count;         /* of runs; the entries beyond it mean nothing */
    int *first, *size; /* (N,) first weight of each, and how many it has */
} Runs;

/* State of the weights, and the arrays that are needed to move them. */
typedef struct {
    const Track *track;
    int count;                   /* N */
    int *order;                  /* (N,) which of the weights, as given, stands here */
    double *given;               /* (N,) angles as they were given [rad] */
    double *begin;               /* (N,) the same in order and within a turn */
    double *angle, *angle_rate;  /* (N,) in order, ascending and within a turn [rad, rad/s] */
    int *joined;                 /* (N,) true where a weight lastingly touches the next */
    double *mass;                /* (2 N,) in order, twice over, of each over `track->weights.mass` */
    double *spacing;             /* (N,) angle to the next where they touch [rad] */
    double *offset;              /* (2 N,) angle from the middle of the run it is in; beyond N: of runs
                                    that pass the last weight [rad] */
    Runs chains;                 /* found last */
    Failure *failure; /* first thing that went wrong; its code is FINE while nothing has */
} WeightsInOrder;

/* Doubles of the arrays of N weights. */
size_t ring_scratch(int count);

/* Weights as they stand on the track; `contacts` not 0 where a weight lastingly touches the next
   along increasing angle. */
int order_weights(const Track *track, const double *angles, const double *speeds,
                 const double *contacts, double *scratch, WeightsInOrder *weights,
                 Failure *failure);

/* Angles, rates and contacts in the order in which they were given. */
void write_weights(const WeightsInOrder *weights, double *angles, double *speeds, double *contacts);

/* Free angle between weight k and the next [rad]. */
double gap(const WeightsInOrder *weights, int k);

/* Set the `offset` of a run of weights that touch; how many times the static moment of its mass at the
   middle it has.  The middle is where that points to; of weights that are alike, half way. */
double find_offsets(WeightsInOrder *weights, int first, int size);

/* `contacts` (N,) of a fresh start: weights that touch and move alike, whatever drives them. */
int track_first_contacts(const Track *track, const double *angles, const double *speeds,
                         double *contacts, double *scratch, Failure *failure);

#endif
