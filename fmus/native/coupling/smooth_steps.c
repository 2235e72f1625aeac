/* Steps of machines that stay in their lanes: what is known of each is its course, and the places that are asked for. */
#include "base/elementary.h"
#include "coupling/side_by_side.h"

/* The step that all lanes are at.  Numbers of lanes that are empty are those of the first. */
typedef struct {
    double angles[LANES], speeds[LANES], largest[LANES], rates[LANES]; /* at its start */
    double times[LANES];            /* in it, in the machines' */
    double places[LANES], fastest[LANES]; /* at its end */
    bool is_taken[LANES];
} SmoothStep;

static void fill(SmoothStep *step, BatchRun *const *runs, int count)
{
    int lane;
    for (lane = 0; lane < LANES; lane++) {
        const Composite *c = runs[lane < count ? lane : 0]->unit->own;
        step->angles[lane] = c->parts->unit->memory[REST];
        step->speeds[lane] = c->pieces.step.speed[0];
        step->largest[lane] = c->course->one_piece.largest;
        step->rates[lane] = c->pieces.step.rate;
        step->times[lane] = 0.0;
    }
}

/* Take the step in every lane where it is one; whether it is in all. */
static bool take_together(SmoothStep *step, BatchRun *const *runs, const Held *held, int count, int order)
{
    Terms terms[2][LANES];
    bool are_taken = true;
    int lane;
    held->by->find_terms(held->lanes, order - 1, step->largest, terms[0]);
    held->by->find_terms(held->lanes, order, step->largest, terms[1]);
    for (lane = 0; lane < count; lane++) {
        const BatchRun *run = runs[lane];
        const Composite *c = run->unit->own;
        const Terms last[2] = {terms[0][lane], terms[1][lane]};
        const double length =
            machine_length_of_terms(machine_of(run), order, last, one_piece_step_tolerance(run->unit), false);
        step->is_taken[lane] = composite_are_few(c, run->passes) &&
                               one_piece_take_smooth(run->unit, length, run->end);
        are_taken &= step->is_taken[lane];
    }
    return are_taken;
}

/* Read one point of every lane that has one in its step; whether any has. */
static bool read_points(SmoothStep *step, BatchRun *const *runs, const Held *held, int count, int order, const BatchCall *all)
{
    double *rows[LANES], places[LANES];
    const Pieces *pieces = &((const Composite *)runs[0]->unit->own)->pieces;
    bool are_read = false;
    size_t k;
    int lane;
    for (lane = 0; lane < count; lane++) {
        BatchRun *run = runs[lane];
        const Composite *c = run->unit->own;
        const double point = batch_run_point(run, all, run->reached);
        rows[lane] = NULL;
        if (step->is_taken[lane] && composite_reaches(c, point)) {
            rows[lane] = batch_run_row(run, all, run->reached++);
            run->passes = c->course->total.passes;
            step->times[lane] = one_piece_time(c, point);
            unit_go_to(run->unit, point);
            are_read = true;
        }
    }
    for (k = 0; k < pieces->planned && are_read; k++) {
        const Output *output = pieces->plan + k;
        held->by->read_place(held->lanes, output->column, output->number, order, step->times, places);
        for (lane = 0; lane < count; lane++) {
            if (rows[lane]) {
                rows[lane][k] = places[lane];
            }
        }
    }
    return are_read;
}

/* Go to the ends of the steps that have been taken, and begin the next ones; whether all go on. */
static bool reach_ends(SmoothStep *step, BatchRun *const *runs, const Held *held, int count, int order)
{
    bool goes_on = true;
    int lane;
    for (lane = 0; lane < count; lane++) {
        const Composite *c = runs[lane]->unit->own;
        step->times[lane] = step->is_taken[lane] ? c->course->clock.length * step->rates[lane] : 0.0;
    }
    held->by->go_to_end(held->lanes, order, step->times, step->rates, step->places, step->fastest);
    for (lane = 0; lane < count; lane++) {
        if (step->is_taken[lane]) {
            goes_on &= one_piece_next_smooth(runs[lane]->unit, step->places[lane], step->fastest[lane]);
        }
    }
    return goes_on;
}

static void take_out(const Held *held, int lane, const BatchRun *run)
{
    Machine *m = machine_of(run);
    held->by->take_out(held->lanes, lane, (double *)m->motion, (double *)m->velocity);
}

void smooth_steps(BatchRun *const *runs, Loaded *const *loaded, int count, Held *held, const LaneMachine *machines,
                  BatchCall *all)
{
    const int order = loaded[0]->order;
    SmoothStep step;
    bool goes_on = true;
    int lane, steps;
    held->by->load(held->lanes, machines, count, order);
    for (steps = 0; goes_on; steps++) {
        fill(&step, runs, count);
        held->by->expand_on(held->lanes, step.angles, step.speeds, order);
        goes_on = take_together(&step, runs, held, count, order);
        for (lane = 0; lane < count; lane++) {
            if (!step.is_taken[lane]) {
                take_out(held, lane, runs[lane]);
            }
        }
        while (read_points(&step, runs, held, count, order, all)) {
        }
        goes_on &= reach_ends(&step, runs, held, count, order);
    }
    for (lane = 0; lane < count; lane++) {
        if (step.is_taken[lane]) {
            take_out(held, lane, runs[lane]);
        }
        loaded[lane]->is_alone = !step.is_taken[lane];
        one_piece_leave_smooth(runs[lane]->unit, steps > 1 || step.is_taken[lane]);
    }
}
