/* How a composite goes to a time: steps of its machine, over corners of the drive and changes of the unbalance. */
#include "base/elementary.h"
#include "coupling/composite.h"

static const double MOST_MOVES = 1e7; /* within a step of the host: of parts */
static const double ENOUGH_OF_MOVES = 0.03; /* of that: a pace is known from then on, */
static const double HOPELESS = 100.0;       /* and one that would take so many times that does not get there */

static double most_steps(const Composite *c)
{
    return MOST_MOVES / c->part_count;
}

bool composite_are_few(const Composite *c, double passes)
{
    return !(c->course->total.passes - passes > ENOUGH_OF_MOVES * most_steps(c));
}

int composite_refuse_many(Unit *unit, double passes, double begin, double length)
{
    const Composite *c = unit->own;
    const double made = c->course->total.passes - passes, most = most_steps(c);
    const double reached = c->course->clock.time - begin;
    if (!composite_are_few(c, passes) && made * length > HOPELESS * most * reached) {
        return unit_fail(unit, "a step of %6 s cannot be completed: %6 s of it took %u steps of the machine; the motion is "
                         "too fast", length, reached, (unsigned long)made);
    }
    if (made <= most) {
        return 0;
    }
    return unit_fail(unit, "a step of %6 s takes too many steps of the machine: one call may take 1e7 over "
                     "its number of parts; use shorter communication steps", length);
}

/* Step and move the units to a time. */
static int reach_time(Unit *unit, double end)
{
    const Composite *c = unit->own;
    const Course *course = c->course;
    const double begin = unit->time, passes = course->total.passes;
    for (;;) {
        if (composite_reaches(c, end)) {
            return one_piece_show(unit, end);
        }
        if (unit->one_step_per_call && course->clock.time > begin) {
            unit->made = course->clock.time - begin;
            return one_piece_show(unit, course->clock.time);
        }
        if (composite_refuse_many(unit, passes, begin, end - begin)) {
            return 1;
        }
        if (one_piece_step(unit)) {
            return 1;
        }
    }
}

int composite_go_to(Unit *unit, double end)
{
    const Composite *c = unit->own;
    while (composite_next_jump(c) <= end) {
        const double jump = composite_next_jump(c);
        const unsigned *asked = unit->asked;
        int wrong;
        unit->asked = NULL; /* steps begin there: all units must be */
        wrong = reach_time(unit, jump);
        unit->asked = asked;
        if (wrong) {
            return 1;
        }
        if (unit->one_step_per_call) {
            if (unit->made < jump - unit->time) { /* of the way there one step, and not its last */
                return 0;
            }
            unit->made = jump - unit->time;
        }
        if (composite_pass_jump(unit)) {
            return 1;
        }
        if (jump == end || unit->one_step_per_call) {
            return 0;
        }
    }
    return reach_time(unit, end);
}
