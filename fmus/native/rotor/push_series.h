/* Taylor series of what moves the rotor over a stretch of a step. */
#ifndef AUTOBALANCER_PUSH_SERIES_H
#define AUTOBALANCER_PUSH_SERIES_H

#include <stdbool.h>

#include "base/spin.h"

/* What moves the rotor over a step, as it is at the start. */
typedef struct {
    const double *forces; /* (4, p) complex forces on the planes and their derivatives */
    int planes;           /* p */
    bool turning_force;   /* whether they are in the rotor frame, or in fixed axes */
    Spin spin;
} Excitation;

/* Coefficients of the speed and of the angular acceleration; and the angle at the start. */
enum { SPEED_TERMS = 5, SPIN_TERMS = 4 };
typedef struct {
    double angle, speed[SPEED_TERMS], spin_up[SPIN_TERMS];
} SpinSeries;

/* Over a stretch h from time t on: coefficients of powers of the fraction of the stretch. */
SpinSeries spin_series(const Spin *start, double t, double h);

/* Coefficients of the planes' forces in fixed axes and of (w^2 - i w') e^{i beta}, p + 1 pairs, for
   the powers 0 to `terms`: rows that stand `stride` doubles apart.  turn: (terms + 1, 2) scratch. */
void fill_pushes(const Excitation *excitation, const SpinSeries *spin, double t, double h,
                 int terms, double *pushes, int stride, double *turn);

#endif
