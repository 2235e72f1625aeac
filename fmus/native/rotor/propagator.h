/* Exact step of the linear rotor at constant speed. */
#ifndef AUTOBALANCER_PROPAGATOR_H
#define AUTOBALANCER_PROPAGATOR_H

#include <stdbool.h>
#include <stddef.h>

#include "base/failure.h"
#include "base/cubic.h"
#include "rotor/linear_rotor.h"

/* The first `upper` rows of e^matrix (size, size), in place, by a Taylor series and doubling of e^A - 1;
   rows from `upper` on have zeros in the columns before it.  scratch: 2 parts size^2 doubles. */
int exponential(int parts, int size, int upper, double *matrix, double *scratch, Failure *failure);

/* Elements in a row and rows of a step matrix; in doubles it has rows * columns * parts. */
int step_matrix_rows(int stations, int planes, int axes);
int step_matrix_columns(int stations, int planes, int axes);
/* Doubles of scratch for step_matrix. */
size_t step_matrix_scratch(int stations, int planes, int axes);

/* Matrix (rows, columns) that takes (q, v, f_0..f_3, e) to (q, v, a, j) one `step` [s] later.

   a and j are acceleration and jerk of the p planes in fixed axes; axes and parts are those of
   linear_rotor.h.  With `turning_force` 0 the f_k are derivatives in fixed axes.  With step = 0 it evaluates a and j at the start. */
int step_matrix(const LinearRotor *rotor, double speed, double step, bool turning_force,
                double *matrix, double *scratch, Failure *failure);

#endif
