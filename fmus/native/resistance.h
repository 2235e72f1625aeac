/* Rolling resistance with true sticking; twin of models/contact/resistance.py, where the theory
   stands. */
#ifndef AUTOBALANCER_RESISTANCE_H
#define AUTOBALANCER_RESISTANCE_H

#include "complex_number.h"
#include "failure.h"

/* A packed group that slides one way. */
typedef struct {
    double radius;       /* R [m] */
    double lever;        /* -1/(kappa R) [1/m] */
    double grip;         /* sign(theta') mu/(kappa R) [1/m] */
    double damping_rate; /* d [1/s] */
    int count;
    double alpha;      /* half the angle between neighbours [rad] */
    double spin_share; /* s of Track */
} SlidingGroup;

/* Which wall of the race carries each weight: sides (count,) 1.0 outer, -1.0 inner.  Returns how
   many are set; 0: all are the outer one. */
int find_sides(const SlidingGroup *group, Complex acceleration, double angle, double angle_rate,
               double rotor_speed, double *sides);

/* Mean of g - grip |n| over the group, and its time derivative along the motion. */
void sliding_drive(const SlidingGroup *group, Complex acceleration, Complex slope, double angle,
                   double angle_rate, double rotor_speed, double angular_acceleration,
                   const double *sides, int side_count, double *drive, double *drive_slope);

/* Angle and rate after `step`, in place; order 4 as weights_substep, of which it is the twin.

   ends: acceleration of the track's centre and its slope at the start, and at the end; response:
   of `quadrature`; sides: (count,) scratch. */
int sliding_substep(const SlidingGroup *group, double *angle, double *angle_rate,
                    const Complex *ends, double rotor_speed, double angular_acceleration,
                    const double *response, double step, double *sides, Failure *failure);

#endif
