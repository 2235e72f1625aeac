/* One weight on a race that is not round as a power series.

   With theta = phi - beta its angle in the rotor, rho = R + sum of eps cos n (theta - theta_n) and p = e^{i phi},
   the weight is at y = e E + rho p from the plane's centre and moves along T = (rho' + i rho) p for each theta'.
   With l = |T|, eta = l theta' - r w the speed at which it turns, times its radius, and a = A + y'',

       Re(T* a) + (kappa - 1) l eta' + b/m l^2 theta' = 0

   and on the shaft  m Re(S* a) - (kappa - 1) m (l + r) eta' - b l^2 theta',  S = i y - T.
   A circle is the case rho = R, l = R, S = i e E: weights_series.h.  models/reference/lagrange.py has the same
   apart from this. */
#ifndef AUTOBALANCER_RACE_SERIES_H
#define AUTOBALANCER_RACE_SERIES_H

#include "fmi/unit.h"
#include "machine/weights_series.h"
#include "weights/weights.h"

enum { LOBE_NUMBERS = 3, RACE_NUMBERS = 5 }; /* of a lobe: how many, amplitude, angle; that say a weight below */
enum { SERIES_LENGTH = MOST_ORDER + 3 };

/* How a rotor turns: its speed's series, up to the highest coefficient that is known and not 0. */
typedef struct {
    const Number *speed;
    int order;
} Turning;

/* In units of a machine's time. */
struct SeriesRace {
    int lobes;
    const Number *lobe; /* (lobes, LOBE_NUMBERS) */
    Number mass, kappa, radius, body, slowing; /* m, kappa, R, r, b/m */
    /* (K + 3,) series; those of the coefficient to come without what waits for phi'' and w' */
    Pair *waves;     /* (lobes, K + 3) eps e^{i n (theta - theta_n)} */
    Pair *slope;     /* rho', rho */
    Pair *place;     /* rho p */
    Pair *moved;     /* (rho p)' */
    Pair *tangent;   /* T */
    Pair *drawn;     /* rho' p */
    Pair *felt;      /* a */
    Number *turning; /* theta' */
    Number *stretch; /* l */
    Number *run;     /* l theta' */
    Number *rolled;  /* eta' */
    Number carried;  /* w' of the order to come where it is prescribed */
};

/* Memory for the series of a weight on a race with at most so many lobes; NULL where there is none. */
struct SeriesRace *series_race_allocate(Unit *unit, int lobes);
/* The race of one weight with these lobes, in a unit of time of per_rate s. */
void series_race_take(SeriesWeight *weight, const Weights *one, const Number *lobe, double per_rate);
/* Set what is known at the start of a weight whose p and phi' are set, at its angle in the rotor. */
void series_race_start(SeriesWeight *weight, Number angle, Number speed, Number rotor_speed);
/* As series_weight_advance; the pull of lower orders is in the accelerations that were felt. */
void series_race_advance(SeriesWeight *weight, int k, Pair known, Number speed, Number carried, Turning rotor);
/* Acceleration of the weight beside that of the track's centre, (rho p)'' of order k, as far as it is known. */
Pair series_race_known(const SeriesWeight *weight, int k);
/* Complete with phi'' and w' of order k, the part of w' that was not known before, and the pull of order k. */
void series_race_finish(SeriesWeight *weight, int k, Number acceleration, Number spun, Number spun_late, Pair pull);
/* What it adds to the torque on the shaft of order k, as far as it is known, where the shaft's w' is not; spin: the
   series E; known: the part of e E'' of order k. */
Number series_race_torque(const SeriesWeight *weight, int k, const Pair *spin, Pair offset, Pair known);
/* What it adds to the shaft's inertia, beside m e^2; centre: e E. */
Number series_race_inertia(const SeriesWeight *weight, Pair centre);
/* What it adds to the row of the shaft by its plane's acceleration, beside that of m e. */
Pair series_race_swept(const SeriesWeight *weight);

/* Once it is complete of order k: its force on its plane beside that of e E'', and its torque on the rotor about the
   plane's centre. */
Pair series_race_push(const SeriesWeight *weight, int k);
Number series_race_turning(const SeriesWeight *weight, int k, const Pair *spin, Pair offset);
/* Impulse of that torque where theta' jumps: of a weight at `place` from the plane's centre, whose own on the plane is
   `blow`. */
Number series_race_blow(const SeriesWeight *weight, Number jump, Pair place, Pair blow);

#endif
