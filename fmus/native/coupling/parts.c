/* A part's equations, and what is said about it. */
#include "coupling/composite.h"
#include "units/weights_unit.h"
#include "weights/liquid.h"

Rotor *composite_rotor(const Composite *c)
{
    return c->parts->unit->own;
}

Balls *part_balls(const Part *part)
{
    return part->unit->equations == &WEIGHTS_EQUATIONS ? part->unit->own : NULL;
}

RingUnit *part_ring(const Part *part)
{
    return part->unit->equations == &RING_EQUATIONS ? part->unit->own : NULL;
}

double part_added_mass(const Part *part)
{
    const Balls *balls = part_balls(part);
    const RingUnit *ring = part_ring(part);
    const double *real = part->unit->real;
    const Liquid liquid = {real[0], real[1], real[2], real[3]};
    return balls ? weights_added_mass(&balls->track.weights)
           : ring ? ring_added_mass(&ring->ring)
                  : liquid_added_mass(&liquid);
}

int composite_part_failed(Unit *unit, const Part *part)
{
    return unit_fail(unit, "%s: %s", part->unit->name, part->unit->reason.at);
}

bool part_meets_as_built(const Unit *unit, const Part *part)
{
    return part_balls(part) && weights_meet(part->unit, unit->starts + part->first);
}

bool part_sticks_as_built(const Unit *unit, const Part *part)
{
    return part_balls(part) && weights_stick(unit->starts + part->first);
}

int composite_refuse_events(Unit *unit)
{
    const Composite *c = unit->own;
    const Rotor *rotor = composite_rotor(c);
    int k;
    for (k = 0; k < rotor->slider_count; k++) {
        if (rotor->sliders[k].stiffness > 0.0) {
            return unit_fail(unit, "%s: model exchange has no sliders with a spring; use co-simulation",
                             c->parts->unit->name);
        }
    }
    for (k = 0; k < rotor->cubic_count; k++) {
        if (rotor->cubics[k].limit > 0.0) {
            return unit_fail(unit, "%s: model exchange has no springs that soften; use co-simulation",
                             c->parts->unit->name);
        }
    }
    for (k = 1; k < c->parts_without_motor; k++) {
        const Part *part = c->parts + k;
        const double *real = part->unit->real;
        if (part_balls(part) && ((weights_meet(part->unit, real) && !part_meets_as_built(unit, part)) ||
                                 (weights_stick(real) && !part_sticks_as_built(unit, part)))) {
            return unit_fail(unit, "%s%s: model exchange has event indicators for what is above 0 in the file; build "
                             "it with these values, or use co-simulation",
                             part->unit->name, WEIGHTS_EVENT_KEYS);
        }
    }
    return 0;
}

bool composite_asked(const Unit *unit, const Part *part)
{
    const Layout *layout = &part->unit->layout;
    const size_t count = layout->real_count - layout->computed.first;
    size_t k;
    for (k = 0; k < unit->asked_count && unit->asked; k++) {
        if (unit->asked[k] - part->observed < count ||
            unit->asked[k] - ((const Composite *)unit->own)->results - RESIDUAL < 2) {
            return 1;
        }
    }
    return !unit->asked;
}
