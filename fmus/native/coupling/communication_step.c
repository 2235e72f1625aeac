/* A communication step as a run takes it. */
#include "base/elementary.h"
#include "coupling/composite.h"

/* Whether the communication step that ends so is still to be gone on with. */
static bool unfinished(const Composite *c, double ends, double step)
{
    const Course *course = c->course;
    if (course->division.crossing > 0.0 || course->event.steps_left > 0.0) {
        return 1;
    }
    if (course->adaptive.allowed == 0.0) {
        return course->division.length > 0.0;
    }
    return course->division.no_past > 0.0 && ends - course->clock.time > TIME_ROUNDING * step;
}

int composite_run_step(Unit *unit, double step)
{
    Composite *c = unit->own;
    Course *course = c->course;
    const double begin = course->clock.time;
    double ends = begin + step;
    c->loop_failed = false;
    if (course->clock.time >= composite_next_jump(c) && composite_pass_jump(unit)) {
        return 1;
    }
    do {
        c->pacing.step = course->adaptive.allowed > 0.0 ? ends - course->clock.time : step;
        if (composite_go_on(unit)) {
            if (c->unknowns) {
                composite_put_gain(unit);
            }
            return 1;
        }
        /* an event is no communication point, but only at rest are these further apart */
        if (course->adaptive.allowed > 0.0) {
            ends = smaller(ends, begin + c->pacing.longest);
        }
    } while (unfinished(c, ends, ends - begin));
    return 0;
}
