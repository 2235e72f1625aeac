/* A part's step and what is said about it. */
#include "coupling/composite.h"
#include "units/weights_unit.h"

Rotor *composite_rotor(const Composite *c)
{
    return c->parts->unit->own;
}

Balls *part_balls(const Part *part)
{
    return part->unit->equations == &WEIGHTS_EQUATIONS ? part->unit->own : NULL;
}

void composite_put_gain(Unit *unit)
{
    if (!unit->reason.at) { /* whatever failed gave no reason */
        unit_fail(unit, "the coupling cannot go on at t = %6 s: events follow each other too closely", unit_host_time(unit, unit->time));
    }
    text_format(&unit->reason, "; loop gain %3", ((const Composite *)unit->own)->course->loop.gain);
}

int composite_part_failed(Unit *unit, const Part *part)
{
    return unit_fail(unit, "%s: %s", part->unit->name, part->unit->reason.at);
}

void composite_name_signal(const Composite *c, int k, Text *text)
{
    const Part *part = k < c->force_count ? c->parts + c->members[k] : c->motor;
    if (k < c->unknowns) {
        text_format(text, "%s%s", part->unit->name, k < c->force_count ? ".F" : ".acceleration");
    } else {
        text_format(text, "rotor.plane[%u].a", (unsigned long)c->rotor_planes[k - c->unknowns] + 1);
    }
}

int composite_advance(Unit *unit, Part *part, double step)
{
    Unit *own = part->unit;
    own->time = ((Composite *)unit->own)->course->clock.begin;
    own->start = unit->start;
    return unit_advance(own, step) && unit_fail(unit, "%s at t = %6 s: a step of %6 s failed: %s",
                                                own->name, unit_host_time(unit, own->time), step, own->reason.at);
}

int composite_eventful(Unit *unit)
{
    const Composite *c = unit->own;
    int k;
    for (k = 0; k < c->part_count; k++) {
        const Unit *part = c->parts[k].unit;
        const Balls *balls = part_balls(c->parts + k);
        if (part->layout.sizes.sliders || (balls && balls->track.eventful)) {
            return unit_fail(unit, "%s: model exchange is for machines without dry friction, "
                             "contact of weights and rolling resistance; use co-simulation",
                             part->name);
        }
    }
    return 0;
}
