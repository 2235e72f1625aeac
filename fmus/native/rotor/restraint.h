/* What holds a rotor beside its linear supports: cubic springs and stops, and their series in time.

   Both act on a displacement d, x and y of rows over the stations: across a support, or along one axis of
   it where the other's row is 0.  A cubic spring pulls back by k3 |d|^2 d, or by k3 x^3 and k3 y^3.  A stop
   pushes back by f = ks (r - g) + cs r' along d, where r = |d| is more than the gap g and f is above 0: it
   never pulls, and lets go where f has fallen to 0, with a damper before r = g. */
#ifndef AUTOBALANCER_RESTRAINT_H
#define AUTOBALANCER_RESTRAINT_H

#include <stdbool.h>
#include <stddef.h>

typedef struct {
    const double *rows;  /* (n, 2) x and y by those of every station */
    double stiffness[2]; /* k3 of both axes [N/m^3] */
    bool is_radial;      /* the first of them, whatever the direction */
    double limit;        /* displacement up to which it is known [m]; 0: any */
    int support;         /* number of the support, or foot behind them, that has it; 0: none */
} CubicSpring;

typedef struct {
    const double *rows; /* (n, 2) */
    double gap, stiffness, damping; /* g [m], ks [N/m], cs [N s/m] */
    int support; /* as of a cubic spring */
} Stop;

/* What is remembered of a stop: how the rotor stands to it, how often it has come to touch it, and the largest
   force so far [N]. */
enum { STOP_STATE, STOP_TOUCHES, STOP_LARGEST, STOP_DOUBLES };
/* Inside the gap; beyond it and pressing; beyond it on the way back, without force. */
enum { STOP_APART, STOP_PRESSES, STOP_BEYOND, STOP_STATES };

/* x and y of a displacement from x, y of n stations. */
void restraint_displacement(const double *rows, int n, const double *stations, double *displacement);
/* Force on the rotor (2,) of a cubic spring. */
void cubic_force(const CubicSpring *spring, const double *displacement, double *force);
/* Force of a stop along the displacement, by displacement and velocity, whatever its state. */
double stop_pressure(const Stop *stop, const double *displacement, const double *velocity);
/* Its derivative in time, with the acceleration. */
double stop_pressure_rate(const Stop *stop, const double *displacement, const double *velocity,
                          const double *acceleration);
/* Forces below that do not change its state. */
double stop_rounding(const Stop *stop, const double *displacement, const double *velocity);
/* State of a stop with this displacement and velocity; a known one stays but for more than rounding. */
int stop_state_of(const Stop *stop, const double *displacement, const double *velocity, int state);
/* Force on the rotor (2,) of a stop in a state. */
void stop_force(const Stop *stop, int state, const double *displacement, const double *velocity, double *force);

/* Coefficients of powers of time, in any unit of it. */
typedef struct {
    double *displacement;        /* (c, 2) */
    double *square;              /* (c, 2) of x and of y */
    double *distance;            /* (c,) r */
    double *direction, *pressure; /* (c, 2) d/r, (c,) f */
} RestraintSeries;

size_t restraint_series_size(int coefficients);
RestraintSeries restraint_series_in(double *memory, int coefficients);
/* Coefficient k of the displacement, and of what follows from it alone. */
void restraint_displace(RestraintSeries *series, int k, const double *displacement);
/* Coefficient k of r^2, where `square` is known so far. */
double restraint_square(const RestraintSeries *series, int k);
/* Coefficient k of the force on the rotor (2,) of a cubic spring; of a stop that presses, for which the
   displacement is known up to k + 1; its stiffness and damping in the unit of time. */
void cubic_series_force(const CubicSpring *spring, const RestraintSeries *series, int k, double *force);
void stop_series_force(const Stop *stop, RestraintSeries *series, int k, double *force);
/* Coefficient k of f alone, where the displacement is known up to k + 1. */
void stop_series_pressure(const Stop *stop, RestraintSeries *series, int k);
/* The largest value of a series of this order up to a time. */
double largest_of_series(const double *coefficients, int order, double until);

#endif
