/* Steps of a machine by itself that follow each other while its motion is smooth: what smooth_steps.c does in lanes. */
#include "base/elementary.h"
#include "coupling/side_by_side.h"

/* Take the step that has been expanded, where it is one. */
static bool take_alone(const BatchRun *run)
{
    Unit *unit = run->unit;
    const Composite *c = unit->own;
    const double length = machine_length(&c->pieces.step, one_piece_order(c), one_piece_step_tolerance(unit),
                                         c->course->one_piece.largest, false);
    return composite_are_few(c, run->passes) && one_piece_take_smooth(unit, length, run->end);
}

static void read_reached(BatchRun *run, const BatchCall *all)
{
    const Composite *c = run->unit->own;
    double points[MOST_READ];
    int count;
    while ((count = batch_run_points(run, all, infinity(), points)) > 0) {
        one_piece_read_places(c, points, count, batch_run_row(run, all, run->reached));
        unit_go_to(run->unit, points[count - 1]);
        run->passes = c->course->total.passes;
        run->reached += (size_t)count;
    }
}

/* The state becomes that at the end of the step; whether it goes on. */
static bool reach_end_alone(BatchRun *run)
{
    const Composite *c = run->unit->own;
    Machine *m = machine_of(run);
    const int order = one_piece_order(c);
    const double time = c->course->clock.length * m->rate;
    double place = 0.0, speed = 0.0;
    int i;
    machine_reach_end(m, order, time);
    for (i = 0; i < m->stations; i++) {
        const Pair q = m->motion[i];
        const double x = pair_x(m->velocity[i]) * m->rate, y = pair_y(m->velocity[i]) * m->rate;
        place = larger(place, larger(absolute(pair_x(q)), absolute(pair_y(q))));
        speed = larger(speed, larger(absolute(x), absolute(y))) + (0.0 * x + 0.0 * y); /* NaN where one is */
    }
    return one_piece_next_smooth(run->unit, place, speed);
}

void smooth_steps_alone(BatchRun *run, Loaded *loaded, BatchCall *all)
{
    const Composite *c = run->unit->own;
    bool is_taken = true, goes_on = true;
    int steps;
    for (steps = 0; goes_on; steps++) {
        machine_expand(machine_of(run), c->parts->unit->memory[REST], loaded->order);
        is_taken = take_alone(run);
        if (is_taken) {
            read_reached(run, all);
        }
        goes_on = is_taken && reach_end_alone(run);
    }
    loaded->is_alone = !is_taken;
    one_piece_leave_smooth(run->unit, steps > 1 || is_taken);
}
