/* A rotor and its weights in one piece, and their motion as a power series in time.

   With q the stations' displacements, A = q'' - g what an accelerometer would read, E = e^{i beta} of the
   rotor's angle and p = e^{i phi} of each weight's, both in fixed axes,

       M A = -K q - (C + C_i) v + i w (C_i q + G v) - U E'' + F - sum of s m R p''
       kappa R phi'' = -Im((s A + e E'') p*) - d kappa R (phi' - w) + (kappa - 1) (R + r) w'

   where M carries all added masses, U is the unbalance with that of the tracks' offsets e, s the row of a
   weight's plane and F what pushes from outside.  Speed and angle of the rotor are prescribed, or the row
   of the shaft is one more:

       I w' + Im((U E)* A) + sum of m R (Im((e E)* p'') - (kappa - 1) (R + r) phi'')
           = L(w) + Im(q* C_i (v - i w q)) + sum of b R^2 (phi' - w)

   Races that are not round: race_series.h.  Filimonikhina 2017 (4), Dubovik 2006 (3), (5); models/reference/lagrange.py has the same apart from this.
   All are polynomials in q, v, p, E, phi', w, so that the coefficients of their series follow one from the
   other, each by one solution with the same matrix: M and I less what the weights take with them.

   Time is counted in 2^-k s: no rounding, and no coefficient leaves the range of numbers. */
#ifndef AUTOBALANCER_MACHINE_H
#define AUTOBALANCER_MACHINE_H

#include "base/number.h"
#include "base/pair.h"
#include "contact/track.h"
#include "fmi/unit.h"
#include "lanes/lanes.h"
#include "machine/blocks.h"
#include "machine/race_series.h"
#include "machine/weights_series.h"
#include "rotor/motor.h"
#include "units/rotor_unit.h"
#include "weights/centre.h"

/* Whether small machines have copies of loops: not in the page of a scene, which is to be small. */
#ifndef __wasm__
#define HAS_COPIES
#endif

enum { FEW_UNKNOWNS = 8 };    /* up to here their matrix is inverted */
#define LONGEST_STEP 12.0     /* rad of the rotor at about its fastest speed: of a step */
#define MOST_TURN 800.0       /* rad of the rotor in a step, at any speed */
#define SMALLEST_TERM 1e-40   /* of the tolerance: a term that is nothing */

/* The weights of one balancer. */
typedef struct {
    int first, end;    /* of the machine's weights */
    const Number *row; /* (n,) of its plane */
    Pair offset;       /* of the track's centre from the plane's, in the rotor [m] */
    int is_off;        /* whether that is not 0 */
    int lobes;         /* of a race that is not round; */
    Number *lobe;      /* (lobes, LOBE_NUMBERS) in races as they are */
    Number mass;       /* of all its weights [kg] */
    Pair *pull;        /* (K + 1,) series of -i (s A + e E'') */
    Pair known;        /* of the coefficient to come, what does not wait for w': e E'' */
} MachineTrack;

/* The motor's torque on one line, in the machine's time. */
typedef struct {
    const Motor *motor;   /* NULL: the speed is prescribed */
    Number inertia;       /* of all that turns [kg m^2] */
    Number torque, slope; /* at speed 0, and by the speed */
} MachineDrive;

/* How the one station moves and the rotor turns where that is told and follows from no forces: weights by themselves.
   Series in the machine's time. */
typedef struct {
    Pair signal[SIGNAL_ORDERS];       /* of A, in the rotor's axes */
    Number speed[SIGNAL_ORDERS + 1]; /* of w */
    int speed_order;                 /* the highest that is not 0 */
} Carried;

typedef struct Machine {
    int stations, weight_count, track_count; /* n, N */
    int waves, ring_count; /* the last of the stations, of rings of liquid, and how many rings it has so far */
    int width;    /* columns of a series of the motion: n, and N/2 rounded up */
    int unknowns; /* 2 n, one more for a motor */
    int turns;    /* whether forces turn the rotor's velocity: internal damping or gyroscopic */
    const double *per; /* (K + 4,) 1/k */
    double rate, per_rate; /* 2^k, 2^-k: one over the unit of time [1/s] */
    /* of the rotor, in the machine's time; pairs are of x and y.  blocks.c lists all that is read here */
    Number *mass;                          /* (n, n) [kg] */
    Pair *stiffness, *damping;             /* (n, n) */
    Pair *cross_stiffness, *cross_damping; /* (n, n) force along x by motion along y, along y by that along x */
    bool crossed;                          /* whether there is any */
    bool varies;                           /* whether bearings change with the speed: what of both is by w */
    int bearing_line;                      /* of their table that is in these */
    Pair *stiffness_slope, *damping_slope, *cross_stiffness_slope, *cross_damping_slope; /* (n, n) */
    Number *internal_damping, *gyroscopic; /* (n, n) */
    Pair *unbalance;                       /* (n,) */
    Pair *push;                            /* (4, n) series of F, of order 0 to 3 */
    Pair gravity;
    MachineTrack *tracks;
    SeriesWeight *weights;
    const LaneFunctions *lanes; /* of this processor; NULL: there are none */
    WeightsBeside *beside; /* of a plain machine with many weights, whose `unit` and `rate` are then here; NULL: of none */
    struct SeriesRace **races; /* (N,) their memory where a race may have lobes */
    MachineDrive drive;
    /* coefficients of order 0 to K, later ones behind */
    Pair *motion;       /* (K + 1, width) displacements; angles of two weights in the rotor */
    Pair *velocity;     /* the same of their derivatives */
    Pair *acceleration; /* (K + 1, n) A */
    Pair *turning;      /* (K + 1, n) C_i q + G v */
    Pair *sloped;       /* (K + 1, n) forces of bearings by w */
    Pair *swept, *sheared; /* (K + 1, n) w q, C_i (v - i w q); with a motor */
    Pair *spin;         /* (K + 3,) E */
    Number *speed;      /* (K + 2,) w */
    int speed_order;    /* the highest that is not 0 */
    /* of a step by collocation.h motion, velocity and shaft are coefficients of T_k(2 t/length - 1), k = 0 to: */
    int collocated_order;     /* 0: the step is by series */
    double collocated_length;
    Pair *shaft;        /* speed, and angle turned; with a motor */
    Number *matrix;     /* (unknowns, unknowns) the inverse, or Cholesky's factor with one over its diagonal */
    Number *right;      /* (unknowns,) */
    Number *rows;        /* (tracks, n) where waves make stations more than the rotor has */
    struct MachineRing *rings; /* of rings.h */
    double *root;        /* (K + 1,) series of the root of the speed, where a wave is damped by viscosity */
    Carried *carried;    /* NULL: the stations move as forces make them */
    bool from_rotor;     /* whether series are in axes that turn with the rotor, so that E = 1: of weights that are
                            carried on a round race; their `unit` and `rate` are then relative to the rotor */
    struct Restraints *restraints; /* of restraints.h: cubic springs and stops; NULL: there are none */
    struct Phase *phase; /* of phase.h, where weights can touch or stick, or supports stick or have stops; NULL: they cannot */
} Machine;

/* -- allocate.c --------------------------------------------------------------------------------- */

/* Memory for a machine of these sizes, on races with at most so many lobes, in `unit`; 1 where there is none. */
int machine_allocate(Unit *unit, Machine *machine, int stations, int weights, int tracks, int lobes);
/* The same for a machine whose weights are expanded side by side, where there are enough of them and vectors. */
int machine_allocate_beside(Unit *unit, Machine *machine, int weights, int tracks);

/* -- build.c ----------------------------------------------------------------------------------- */

/* Begin anew, in this unit of time, with this rotor; then its balancers, and a motor. */
void machine_take_rotor(Machine *machine, const LinearRotor *rotor, double rate);
/* Bearings that change with the speed: those on a line of their table. */
void machine_take_bearings(Machine *machine, const LinearRotor *rotor, int line);
void machine_take_liquid(Machine *machine, const double *row, double mass);
/* Begin anew with a station that is carried along; then its weights, and what an impact finds it moved by [1/kg]. */
void machine_take_carried(Machine *machine, Carried *carried, double rate);
void machine_take_mobility(Machine *machine, double mobility);
void machine_take_weights(Machine *machine, const double *row, const Track *track);
void machine_take_motor(Machine *machine, const Motor *motor);

/* -- blocks.c ------------------------------------------------------------------------------------ */

/* What decides how a machine is computed: (SHAPE_SIZE + SHAPE_OF_TRACK tracks,); and give it to another, with as
   much memory. */
void machine_shape(const Machine *machine, int *shape);
void machine_reshape(Machine *machine, const int *shape);
/* Its blocks, and how many they are: what stays, the state that is expanded, and the coefficients up to an
   order. */
int machine_constants(const Machine *machine, NumberBlock *blocks);
int machine_state(const Machine *machine, NumberBlock *blocks);
int machine_results(const Machine *machine, int order, NumberBlock *blocks);

/* -- series.c ----------------------------------------------------------------------------------- */

/* Coefficients of all series up to that of order K of the motion, 2 or more, from those of order 0 of
   motion, velocity and speed, and the angle.  The speed's of order 1 is given where it is prescribed. */
void machine_expand(Machine *machine, Number angle, int order);
/* The part of it before the first coefficients: directions, and the factors of the matrix. */
void machine_start(Machine *machine, Number angle);
/* Coefficient k of E'' in axes that turn with the rotor, i w' - w^2, where w is known. */
Pair machine_turn_twice(const Machine *machine, int k);
/* Coefficient k of w times a series whose elements stand `stride` apart, up to that order. */
Pair machine_times_speed(const Machine *machine, const Pair *series, int stride, int k);

/* -- factors.c ------------------------------------------------------------------------------------ */

/* Take off M and I what the weights take with them; then of few unknowns the inverse, of more the factors. */
void machine_factorise(Machine *machine);
/* The same of a planar machine without a motor. */
void machine_factorise_planar(Machine *machine);
/* The unknowns of an order in place of their right-hand sides; the same where nothing touches or sticks. */
void machine_solve(const Machine *machine, Number *right);
void machine_solve_factors(const Machine *machine, Number *right);

/* -- unknowns.c -------------------------------------------------------------------------------------- */

/* The number that multiplies each unknown in a weight's equation, by 1/(kappa R); unknowns: A as x and y of
   every station, then w'. */
Number machine_coupled(const Machine *machine, const MachineTrack *track, const SeriesWeight *weight, int unknown);
/* Those of x and y of a station, and of the shaft. */
Pair machine_coupled_station(const MachineTrack *track, const SeriesWeight *weight, int station);
Number machine_coupled_shaft(const Machine *machine, const MachineTrack *track, const SeriesWeight *weight);
/* The matrix without what the weights take with them: its lower half. */
void machine_set_carrier(Machine *machine);
/* w' of order k where it is prescribed. */
Number machine_carried_along(const Machine *machine, int k);
/* Push the plane of a track, on the right-hand side of the order to come. */
void machine_push_track(Machine *machine, const MachineTrack *track, Pair force);
/* Complete the pull of a track from the solution of order k; its acceleration less what was known. */
Pair machine_take_pull(Machine *machine, MachineTrack *track, int k);
/* Complete a weight with its phi'' of order k, and the pull of its track. */
void machine_take_weight(Machine *machine, int weight, int k, Number acceleration, Number speed_gained, Pair pull,
                         bool is_plain);
/* What is known of a weight before the solution of order k: 'turned' and 'free'; its force on the track by that. */
void machine_advance_weight(Machine *machine, const MachineTrack *track, int weight, int k, Number carried,
                            bool is_plain);
Pair machine_weight_force(const SeriesWeight *weight, int k, bool is_plain);

/* -- carriage.c ---------------------------------------------------------------------------------- */

/* Let a machine be carried as it is so long after a start; the angle that the rotor has turned by then. */
double machine_carry(Machine *machine, const Carried *start, double time);

/* -- reaction.c --------------------------------------------------------------------------------- */

/* Once they are expanded up to the third order of their places: force of the weights of a track on their plane beside
   that of their added mass, and torque about the plane's centre (NULL: not wanted), each with its slope, in the rotor's
   axes. */
void machine_reaction(const Machine *machine, int track, const Track *of, Complex *force, double *torque);

/* -- shaft_series.c ----------------------------------------------------------------------------- */

/* The right-hand side of the shaft of order k; the speed's coefficient of k + 1 from the solution. */
void shaft_push(Machine *machine, int k);
Number shaft_take(Machine *machine, int k);

/* -- pace.c ------------------------------------------------------------------------------------- */

/* Order that keeps a tolerance of a step with least work. */
int machine_order(double tolerance);
/* Length of a step, in the machine's time, over which the last two terms of displacements are at most so much of
   `largest`, those of angles of 1 rad; NaN where they are not finite.  Of a stiff machine's rotor they are at most the
   length times that where it is below 1: a bound on places alone leaves a speed wrong by the bound over the length, and
   a rotor keeps the speed that weights in heavy drag give it within very short steps. */
double machine_length(const Machine *machine, int order, double tolerance, double largest, bool is_stiff);
/* The same from the terms of the last two orders. */
double machine_length_of_terms(const Machine *machine, int order, const Terms *terms, double tolerance, bool is_stiff);
/* (tolerance/term)^(1/k), within 6 %. */
double machine_root(double term, double tolerance, int k);
/* Of a column of the motion at a time of the step: the place and the velocity. */
Pair machine_place(const Machine *machine, int column, int order, double time);
Pair machine_velocity(const Machine *machine, int column, int order, double time);
/* Places at some times, as x and y; all are (count,), rounded up to a multiple of LANES. */
void machine_places(const Machine *machine, int column, int order, const double *times, int count, double *x, double *y);
/* Places and velocities of a time of the step in place of those of its begin: the first coefficients. */
void machine_reach_end(Machine *machine, int order, double time);
/* Speed of the rotor, and the angle turned. */
double machine_speed_at(const Machine *machine, int order, double time);
double machine_turned(const Machine *machine, int order, double time);
/* Whether the speed leaves a line (its least and its highest speed) in a step: 1 upwards, -1 downwards, with the
   length up to there. */
int machine_leaves_line(const Machine *machine, int order, const double *ends, double *length);

#endif
