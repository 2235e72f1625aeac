/* Point weights under a quintic signal: drag is integrated exactly, the drive as a quintic with the
   exact values, slopes and second derivatives of both ends (a three-derivative exponential collocation
   of order 6). */
#ifndef AUTOBALANCER_QUINTIC_WEIGHTS_H
#define AUTOBALANCER_QUINTIC_WEIGHTS_H

#include "weights/weights.h"

/* As `Quadrature`, of g's derivatives of order 0 to 5. */
typedef struct {
    double damping_rate, step;
    double response[14];
} QuinticQuadrature;

QuinticQuadrature quintic_quadrature_empty(void);

/* Move every weight over one communication step; as weights_advance, with the derivatives of the
   signal up to order 5. turned: (N, 2) as `turned_by` keeps them. */
int quintic_weights_advance(const Weights *weights, const double *angles, const double *speeds,
                            const Complex *signal, const double *spin_up, double step,
                            double *new_angles, double *new_speeds, QuinticQuadrature *memory, Turned *turned,
                            Failure *failure);

/* Second derivative of the force of weights_reaction.  motion: acceleration of the track's centre in
   the rotor frame and its derivatives of order 1 and 2; spin_up (3,): derivatives of the rotor's speed
   of order 1 to 3. */
Complex quintic_weights_reaction_second(const Weights *weights, const double *angles,
                                        const double *speeds, const Complex *motion,
                                        double rotor_speed, const double *spin_up,
                                        Turned *turned);

#endif
