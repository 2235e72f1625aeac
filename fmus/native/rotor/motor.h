/* A motor of limited power: its torque depends on the speed, and what is left over turns the rotor,
   I w' = L(w) + tau.  L runs in straight lines between points; between two the equation is linear and
   is solved exactly for a cubic tau. */
#ifndef AUTOBALANCER_MOTOR_H
#define AUTOBALANCER_MOTOR_H

#include "base/failure.h"
#include "rotor/response.h"

typedef struct {
    double inertia; /* of all that turns [kg m^2] */
    int count;      /* points of the characteristic, two or more */
    const double *points; /* speed and torque of each, speeds ascending [rad/s, N m] */
    Quadrature quadrature;
} Motor;

/* 0, or what is not allowed. */
int motor_check(const Motor *motor, Failure *failure);
/* The line of the characteristic that a speed lies on, or whose continuation, from 0. */
int motor_line(const Motor *motor, double speed);
/* L(w) [N m]. */
double motor_torque(const Motor *motor, double speed);
/* dL/dw [N m s/rad]. */
double motor_slope(const Motor *motor, double speed);
/* w' and w'' under a torque on the shaft and its slope. */
void motor_acceleration(const Motor *motor, double speed, const double *torque, double *rates);
/* Speed after a step, in place, and the angle turned in it; torque (4,): on the shaft at the start and
   its derivatives of order 1 to 3. */
int motor_advance(Motor *motor, double *speed, double *angle, const double *torque, double step,
                  Failure *failure);

#endif
