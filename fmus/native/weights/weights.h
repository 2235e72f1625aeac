/* Balls, rollers and pendulums of an auto-balancer in the frame of the rotor. */
#ifndef AUTOBALANCER_WEIGHTS_H
#define AUTOBALANCER_WEIGHTS_H

#include "base/elementary.h"
#include "base/failure.h"
#include "weights/centre.h"

#define TOO_MANY_SUBSTEPS                                                                         \
    "the weights would need %3 substeps in %6 s: acceleration %6 m/s^2, rate %6 rad/s"

/* N weights on one track, rho e^{i theta} from its centre: rho = R + sum of amplitude cos n (theta - angle). */
typedef struct {
    int count;           /* N */
    double mass;         /* of each [kg] */
    double track_radius; /* of the weights' centres R [m] */
    double drag;         /* viscous, of each, b [N s/m] */
    double kappa;        /* 7/5 ball, 3/2 roller, 1 pendulum */
    double radius;       /* of a body that rolls r [m] */
    const double *each;  /* (3, N) mass, drag and radius of each over those above; NULL: all alike */
    int lobes;           /* kinds of lobes of a race that is not round; 0: a circle */
    const double *lobe;  /* (lobes, 3) how many, amplitude [m], angle in the rotor [rad] */
} Weights;

/* What drives one weight at one time: as Instant, with its lag s w', by which it falls behind where it is free, and the lag's
   slope in place of how the rotor turns. */
typedef struct {
    Complex motion[2];
    double lag[2];
} Driven;

/* Exact response of angle and rate over a step, remembered for one damping rate and step: of the
   rate, to itself and to the forcing's derivatives of order 0 to 3, then of the angle. */
typedef struct {
    double damping_rate, step;
    double response[2 * (SIGNAL_ORDERS + 1)];
} Quadrature;

/* Weight k alone, with its own mass, drag and radius. */
Weights weights_single(const Weights *weights, int k);
/* Mass of weight k over `mass`. */
double weights_mass_ratio(const Weights *weights, int k);
/* Torque on the rotor by what resistance takes of a weight's theta'' [N m s^2]: kappa m R^2, less what
   the body's own turning gives back, m R (R - (kappa - 1) r). */
double weights_arm(const Weights *weights);

double weights_added_mass(const Weights *weights);   /* N m [kg] */
double weights_lever(const Weights *weights);        /* -1/(kappa R) [1/m] */
double weights_damping_rate(const Weights *weights); /* d = b/(kappa m) [1/s] */
/* s: part of the track's angular acceleration by which a free weight falls behind. */
double weights_spin_share(const Weights *weights);

/* rho at an angle [m]. */
double weights_track_radius(const Weights *weights, double angle);
/* Sum of m rho e^{i theta} in the rotor frame [kg m]; turned: (N, 2) as `turned_by` keeps them, or NULL. */
Complex weights_static_moment(const Weights *weights, const double *angles, Turned *turned);
/* |sum e^{2 i theta}|/N: 0 for evenly spread weights, 1 for a pair. */
double weights_alignment(int count, const double *angles, Turned *turned);

/* phi_0(z)..phi_5(z) for z <= 0. */
void phi_functions(double z, double *phi);
/* A quadrature that remembers nothing, and the response for a damping rate and step. */
Quadrature quadrature_empty(void);
const double *quadrature(Quadrature *memory, double damping_rate, double step);

/* What drives one weight, which falls behind by this part of the rotor's angular acceleration. */
Driven driven_by(const Instant *now, double spin_share);

/* Drive Im(a e^{-i theta}), with a direction lever e^{-i theta}, less the lag; and its slope along the
   motion. */
void find_forcing(const Driven *by, Complex direction, double angle_rate, double *forcing);

/* Angle and rate of one weight after `step`, in place: drag is integrated exactly, the forcing as a
   cubic with its exact slopes at both ends (order 4).

   lever: -1/(kappa R), times a group's factor; unit: e^{i angle}; response: of `quadrature`. */
int weights_substep(double *angle, double *angle_rate, const Driven *start, const Driven *end,
                    double lever, Complex unit, const double *response, double step,
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

/* Move every weight over one communication step.

   angles, speeds: (N,), and new_angles, new_speeds (N,) for the result, which may be the same
   arrays; without meaning after a failure.  turned (N, 2) as `turned_by` keeps them, or NULL. */
int weights_advance(const Weights *weights, const double *angles, const double *speeds,
                    const CentreMotion *motion, double step, double *new_angles,
                    double *new_speeds, Quadrature *memory, Turned *turned, Failure *failure);

/* Add a weight's e^{i theta} (`unit`, times its mass) and its time derivatives of order 1 to 3 to their
   sums; rates (3,): the derivatives of theta. */
void add_derivatives(Complex unit, const double *rates, Complex *sums);
/* Force -(m R u e^{i beta})'' e^{-i beta} and its slope, from u and its derivatives of order 1 to 3. */
void find_force(double moment, const Complex *u, const Spin *spin, Complex *force);

/* Residual force on the rotor in the rotor frame and its exact slope; N m is not in it. */
void weights_reaction(const Weights *weights, const double *angles, const double *speeds,
                      const Instant *now, Complex *force, Turned *turned);

/* Sum of theta'' and its slope, of weights that nothing but drag hinders; of unequal ones each times
   its arm over `weights_arm`. */
void weights_unhindered(const Weights *weights, const double *angles, const double *speeds,
                        const Instant *now, double *turned);

/* Torque on the rotor about the track's centre and its slope: drag, and what a body that rolls takes
   to turn; contacts between weights take no part. */
void weights_torque(const Weights *weights, const double *angles, const double *speeds,
                    const Instant *now, double *torque);

#endif
