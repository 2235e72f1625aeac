/* Rings part filled with liquid in a machine's series: weights/liquid_ring.h has the equations.

   The wave y of a ring, in fixed axes, is one more station behind those of the rotor, with

       m_L f ((1 + f) y'' + A) = m_L f (4 i w y' + 2 w^2 y - d (y' - i w y)),   d = d_0 + d_1 w^(1/2)

   and m_L f y'' in the row of its plane, which carries m_L. */
#ifndef AUTOBALANCER_RINGS_H
#define AUTOBALANCER_RINGS_H

#include "machine/machine.h"
#include "weights/liquid_ring.h"

/* In the machine's time. */
struct MachineRing {
    int station;          /* of its wave */
    double inertia;       /* m_L f [kg] */
    double damping, root; /* d_0, d_1 */
    Pair *swept, *slid;   /* (K + 1,) series of w y and y' - i w y */
};

/* Memory for so many rings beside so many tracks; 1 where there is none. */
int machine_allocate_rings(Unit *unit, Machine *machine, int count, int tracks);
/* The next ring, on a plane with this row of the rotor's stations. */
void machine_take_ring(Machine *machine, const double *row, const LiquidRing *ring);
/* The series of the root of the speed, up to an order, where the speed's is known. */
void rings_expand_root(Machine *machine, int order);
/* A step's length, shortened to what the root of the speed allows: its series ends where the rotor stands. */
double rings_length(const Machine *machine, double length);
/* Force of order k on the station, a wave or not. */
Pair rings_push(Machine *machine, int station, int k);
/* Whether a station is a wave. */
bool machine_is_wave(const Machine *machine, int station);

#endif
