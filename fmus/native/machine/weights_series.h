/* One weight as a power series, under a series of its track's acceleration. */
#ifndef AUTOBALANCER_WEIGHTS_SERIES_H
#define AUTOBALANCER_WEIGHTS_SERIES_H

#include "base/number.h"
#include "base/pair.h"
#include "weights/weights.h"

enum { LEAST_ORDER = 8, MOST_ORDER = 36 };
enum { WEIGHT_NUMBERS = 7 }; /* which say a weight, in SeriesWeight */

/* A weight of mass m at radius R, in units of a machine's time.

   On a race that is not round (race_series.h) its motion by phi' has the length l and not R: moment is then
   m R (l/R)^2, share m/kappa (l/R)^2 and roll (kappa - 1) (R/l) (l + r) plus what the race carries along, as at
   the start of the series; `along` is p, turned and times R/l. */
typedef struct {
    Number moment;       /* m R [kg m] */
    Number share;        /* m/kappa [kg] */
    Number lever;        /* 1/(kappa R) [1/m] */
    Number damping_rate; /* d = b/(kappa m) */
    Number roll;         /* (kappa - 1) (R + r): how far w' carries it along [m] */
    Number inertia;      /* (kappa - 1) m (R + r)^2, on the shaft [kg m^2] */
    Number torque;       /* b R^2, on the shaft by its speed on the track */
    Pair along;          /* the way it moves by phi', a quarter turn back */
    struct SeriesRace *race; /* NULL: the race is round */
    Pair *unit;  /* (K + 3,) series of p = e^{i phi}, fixed axes */
    Pair *rate;  /* (K + 2,) of phi', twice */
    /* of the coefficient to come: */
    Pair turned; /* what p' leads to without phi'', by i (k + 1) */
    Number free; /* phi'' on a track that is held from here on */
} SeriesWeight;

/* A weight in a unit of time of per_rate s. */
void series_weight_take(SeriesWeight *weight, const Weights *one, double per_rate);
/* Set p and p' at the start from p and phi', which is in `rate`. */
void series_weight_start(SeriesWeight *weight, Pair direction);
/* The parts of order k that are known before the acceleration of that order: 'turned' and 'free'.

   pull: series of -i a, a the track's acceleration, up to order k - 1; known: a part of that of order k;
   speed: phi' - w of order k; carried: w' of order k, where it is known. */
void series_weight_advance(SeriesWeight *weight, int k, const Pair *pull, Pair known, Number speed, Number carried);
/* Force on the track by that, a moment times p'' with the sign of a reaction. */
Pair series_weight_force(const SeriesWeight *weight);
/* Im(a p*) of the acceleration of order k, by which `free` is more than phi'' over the lever. */
Number series_weight_pulled(const SeriesWeight *weight, Pair acceleration);
/* Complete with phi'' of order k: p of order k + 2, phi' of k + 1; per: 1/(k + 1), 1/(k + 2). */
void series_weight_finish(SeriesWeight *weight, int k, Number acceleration, const double *per);

#endif
