/* A part's step and what is said about it. */
#include "coupling/composite.h"
#include "units/weights.h"

void composite_put_time(Text *reason, double time)
{
    text_put_rounded(reason, " at t = ", time, 6);
    text_put(reason, " s");
}

void composite_put_gain(const Unit *unit, Text *reason)
{
    text_put_rounded(reason, "; loop gain ", ((const Composite *)unit->own)->course->loop.gain, 3);
}

static int part_failed(Unit *unit, const Part *part, double step)
{
    Text *reason = unit_reason(unit);
    text_put(reason, part->unit->name);
    if (step > 0.0) {
        composite_put_time(reason, part->unit->time);
        text_put_rounded(reason, ": a step of ", step, 6);
        text_put(reason, " s failed");
    }
    text_put(reason, ": ");
    text_put(reason, part->unit->reason.at);
    return 1;
}

int composite_part_failed(Unit *unit, const Part *part)
{
    return part_failed(unit, part, 0.0);
}

void composite_name_force(const Composite *c, int k, Text *text)
{
    const Part *part = k < c->exchanges ? c->parts + c->members[k] : c->motor;
    text_put(text, part->unit->name);
    text_put(text, k < c->exchanges ? ".F" : ".acceleration");
}

void composite_name_forces(const Composite *c, Text *text)
{
    int k;
    for (k = 0; k < c->unknowns; k++) {
        text_put(text, k ? ", " : "");
        composite_name_force(c, k, text);
    }
}

int composite_advance(Unit *unit, Part *part, double step)
{
    part->unit->time = ((Composite *)unit->own)->course->clock.begin;
    return unit_advance(part->unit, step) ? part_failed(unit, part, step) : 0;
}

int composite_eventful(Unit *unit)
{
    const Composite *c = unit->own;
    int k;
    for (k = 0; k < c->part_count; k++) {
        const Unit *part = c->parts[k].unit;
        if (part->layout.sizes.sliders ||
            (part->equations == &WEIGHTS_EQUATIONS && ((const Balls *)part->own)->track.eventful)) {
            Text *reason = unit_reason(unit);
            text_put(reason, part->name);
            text_put(reason, ": model exchange is for machines without dry friction, contact of weights and "
                             "rolling resistance; use co-simulation");
            return 1;
        }
    }
    return 0;
}
