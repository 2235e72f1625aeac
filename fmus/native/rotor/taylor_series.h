/* Between the files of taylor_step.h. */
#ifndef AUTOBALANCER_TAYLOR_SERIES_H
#define AUTOBALANCER_TAYLOR_SERIES_H

#include "rotor/first_fall.h"
#include "rotor/taylor_step.h"

enum { TERMS = MOST_COEFFICIENTS - 1 }; /* 0.5^18/18! is far below rounding */
enum { RESTRAINT_TERMS = TERMS + 3, DERIVATIVES = 3 };

/* -- taylor_series.c -------------------------------------------------------------------------------- */

/* The series of a cubic spring, or of a stop behind them; the states of stops behind those of sliders. */
RestraintSeries taylor_restraint(const TaylorStep *method, int number);
double *taylor_stop_states(const TaylorStep *method, double *slider_states);
/* Length of a stretch from time t into the step on [s]; of that the part over which the terms left out are below
   rounding. */
double taylor_stretch(const TaylorStep *method, const Excitation *excitation, double t);
double taylor_part_in_reach(const TaylorStep *method);
/* Taylor coefficients of motion and friction over a stretch h from t on. */
int taylor_set_series(TaylorStep *method, const double *state, const double *slider_states,
                      const Excitation *excitation, double t, double h, int terms, Failure *failure);

/* -- taylor_events.c -------------------------------------------------------------------------------- */

/* When, as a fraction of a stretch [s], which slider or stop changes first: -1 for none. */
double taylor_first_event(const TaylorStep *method, const double *slider_states, double stretch, double until,
                          int *which);
/* Let each stop be in the state that follows from the motion. */
void taylor_settle_stops(const TaylorStep *method, const double *state, double *slider_states);
/* A stop after its event. */
void taylor_change_stop(const TaylorStep *method, const double *state, double *slider_states, int j);

#endif
