/* A ring part filled with liquid: its mass, and the wave of its surface; models/ring.py has the equations.

   In axes that turn with the rotor, with a the acceleration of the ring's centre in them,

       (1 + f) Y'' + (d - 2 i (1 - f) w) Y' + ((1 - f) w^2 + i (1 + f) w') Y = -a

   and beside the added mass m_L/(1 + f) the force -m_L f/(1 + f) ((4 i w - d) Y' - 2 w^2 Y) on the rotor. */
#ifndef AUTOBALANCER_LIQUID_RING_H
#define AUTOBALANCER_LIQUID_RING_H

#include "base/failure.h"
#include "weights/centre.h"

typedef struct {
    double wall_radius, inner_radius, height; /* a, b, h [m] */
    double density;                           /* [kg/m^3] */
    double wave_damping;                      /* d [1/s] */
    double viscosity;                         /* kinematic [m^2/s] */
} LiquidRing;

/* Wave Y of the liquid in the rotor and its rate [m, m/s]. */
typedef struct {
    Complex wave, rate;
} RingState;

int ring_check(const LiquidRing *ring, Failure *failure);
double ring_hollow(const LiquidRing *ring);     /* f = (b/a)^2 */
double ring_mass(const LiquidRing *ring);       /* m_L [kg] */
double ring_added_mass(const LiquidRing *ring); /* m_L/(1 + f) [kg] */
/* What the viscosity adds to d, over the root of the speed. */
double ring_root_damping(const LiquidRing *ring);
/* (1 - f) |Y|/(a - b): 1 where the layer thins to nothing at the wall. */
double ring_thinness(const LiquidRing *ring, Complex wave);
/* Y'' while the centre moves so. */
Complex ring_acceleration(const LiquidRing *ring, const RingState *state, const Instant *now);
/* Force beside that of the added mass, and its slope [N, N/s]. */
void ring_force(const LiquidRing *ring, const RingState *state, const Instant *now, Complex *force);
/* Whether a step of this length [s] is one that `ring_advance` resolves. */
bool ring_resolves(const LiquidRing *ring, const Spin *spin, double length);
/* Go on by a step of this length, by power series. */
void ring_advance(const LiquidRing *ring, const CentreMotion *motion, double length, RingState *state);

#endif
