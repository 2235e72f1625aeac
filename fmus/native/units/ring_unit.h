/* What others read of the ring's unit. */
#ifndef AUTOBALANCER_RING_UNIT_H
#define AUTOBALANCER_RING_UNIT_H

#include "fmi/unit.h"
#include "weights/liquid_ring.h"

/* Of its memory: the wave in the rotor and its rate; time since the inputs. */
enum { RING_WAVE = 0, RING_RATE = 2, RING_SINCE = 4, RING_MEMORY = 5, RING_STATES = 4 };

typedef struct {
    LiquidRing ring;
    double carried, sent; /* parts of the added mass: through the port, in the force [kg] */
} RingUnit;

#endif
