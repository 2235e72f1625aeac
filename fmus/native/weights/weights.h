/* Balls, rollers and pendulums of an auto-balancer in the frame of the rotor. */
#ifndef AUTOBALANCER_WEIGHTS_H
#define AUTOBALANCER_WEIGHTS_H

#include "base/complex_number.h"
#include "base/elementary.h"
#include "base/failure.h"

/* N weights on one circular track. */
typedef struct {
    int count;           /* N */
    double mass;         /* of each [kg] */
    double track_radius; /* of the weights' centres R [m] */
    double drag;         /* viscous, of each, b [N s/m] */
    double kappa;        /* 7/5 ball, 3/2 roller, 1 pendulum */
    double radius;       /* of a body that rolls r [m] */
    const double *each;  /* (3, N) mass, drag and radius of each over those above; NULL: all alike */
} Weights;

/* Exact response of angle and rate over a step, remembered for one damping rate and step. */
typedef struct {
    double damping_rate, step;
    double response[10];
} Quadrature;

/* Weight k alone, with its own mass, drag and radius. */
Weights weights_single(const Weights *weights, int k);
/* Mass of weight k over `mass`. */
double weights_mass_ratio(const Weights *weights, int k);
/* Torque on the rotor by what resistance takes of a weight's theta'' [N m s^2]: kappa m R^2, less what
   the body's own turning gives back, m R (R - (kappa - 1) r). */
double weights_arm(const Weights *weights);

/* 0, or what is not allowed. */
int weights_check(const Weights *weights, Failure *failure);
double weights_added_mass(const Weights *weights);   /* N m [kg] */
double weights_damping_rate(const Weights *weights); /* d = b/(kappa m) [1/s] */
/* s: part of the track's angular acceleration by which a free weight falls behind. */
double weights_spin_share(const Weights *weights);

/* Sum of m R e^{i theta} in the rotor frame [kg m]; turned: (N, 2) as `turned_by` keeps them, or NULL. */
Complex weights_static_moment(const Weights *weights, const double *angles, Turned *turned);
/* |sum e^{2 i theta}|/N: 0 for evenly spread weights, 1 for a pair. */
double weights_alignment(int count, const double *angles, Turned *turned);

/* phi_0(z)..phi_count(z) for z <= 0; count at most 8. */
void phi_functions(double z, int count, double *phi);
/* A quadrature that remembers nothing, and the response for a damping rate and step. */
Quadrature quadrature_empty(void);
const double *quadrature(Quadrature *memory, double damping_rate, double step);

/* Im(a e^{-i theta}) times `lever` and its time derivative. */
void along_track(Complex a, Complex da, double angle, double angle_rate, double lever,
                 double *value, double *slope);

/* Angle and rate of one weight after `step`, in place; order 4.

   ends: acceleration of the track's centre and its slope at the start, and at the end; lever:
   -1/(kappa R), times a group's factor; unit: e^{i angle}; lag (4,): s w', by which a free weight falls behind, at
   the start and its derivatives of order 1 to 3; response: of `quadrature`. */
int weights_substep(double *angle, double *angle_rate, const Complex *ends, double lever,
                    Complex unit, const double *lag, const double *response, double step,
                    Failure *failure);

/* Whether the next iteration of a substep would change no more than rounding: a linear one changes
   next by change^2/last_change.

   change, last_change: of angle and rate * step by this iteration and the one before [rad]; at
   the first one 0 when nothing is known, 1 when it gains so fast that a first change of 1e-7 is
   enough. */
int converged(double change, double last_change, double angle);

/* Largest absolute value of `count` >= 1. */
double largest_of(int count, const double *values);

/* Rate [rad/s] that no weight exceeds by much within a step, and the strongest acceleration. */
double fastest_rate(int count, const double *speeds, const Complex *signal, double lever,
                    double lag, double damping_rate, double step, double *strongest);

/* Substeps that a step of so many weights is taken in, whose angles must be finite. */
int weights_substeps(int number, const double *angles, const double *speeds, const Complex *signal,
                     double lever, double lag, double damping_rate, double step, int *count,
                     Failure *failure);

/* Whole turns that are taken off a far angle while a step is computed [rad]. */
double weights_turns_behind(double angle);
/* rect(lever, -angle) from `direction`, the same `moved` radians before: a small turn is cheap. */
Complex direction_at(Complex direction, double moved, double lever, double angle);

/* Move every weight over one communication step.

   angles, speeds: (N,), and new_angles, new_speeds (N,) for the result, which may be the same
   arrays; without meaning after a failure.  signal: acceleration of the track's centre in the rotor
   frame at the start of the step and its derivatives of order 1 to 3; spin_up (4,) likewise; turned
   (N, 2) as `turned_by` keeps them, or NULL. */
int weights_advance(const Weights *weights, const double *angles, const double *speeds,
                    const Complex *signal, const double *spin_up, double step,
                    double *new_angles, double *new_speeds, Quadrature *memory, Turned *turned,
                    Failure *failure);

/* Residual force on the rotor in the rotor frame and its exact slope; N m is not in it.

   acceleration, slope: of the track's centre in the rotor frame; speed, angular_acceleration: of
   the rotor; turned: as above. */
void weights_reaction(const Weights *weights, const double *angles, const double *speeds,
                      Complex acceleration, Complex slope, double speed,
                      double angular_acceleration, double change, Complex *force,
                      Complex *force_slope, Turned *turned);

/* Sum of theta'' and its slope, of weights that nothing but drag hinders; of unequal ones each times
   its arm over `weights_arm`. */
void weights_unhindered(const Weights *weights, const double *angles, const double *speeds,
                        const Complex *motion, double angular_acceleration, double change,
                        double *turned);

/* Torque on the rotor about the track's centre and its slope: drag, and what a body that rolls takes
   to turn; contacts between weights take no part.  motion: acceleration of that centre, its slope. */
void weights_torque(const Weights *weights, const double *angles, const double *speeds,
                    const Complex *motion, double angular_acceleration, double change,
                    double *torque);

#endif
