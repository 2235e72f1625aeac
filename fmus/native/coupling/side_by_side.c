/* Machines in one piece that go on side by side: each with its own time and steps, their series expanded
   together.  A lane whose run is over takes the next one. */
#include <string.h>

#include "coupling/side_by_side.h"

/* -- a run -------------------------------------------------------------------------------------------- */

static int allocate_blocks(Unit *unit, Loaded *loaded)
{
    const Machine *m = &((const Composite *)unit->own)->pieces.step;
    const size_t tracks = (size_t)m->track_count, weights = (size_t)m->weight_count;
    loaded->shape_size = (SHAPE_SIZE + SHAPE_OF_TRACK * tracks) * sizeof(int);
    loaded->shape = unit_allocate(unit, 1, loaded->shape_size);
    loaded->constants = unit_allocate(unit, BLOCKS + BLOCKS_OF_TRACK * tracks + BLOCKS_OF_WEIGHT * weights, sizeof(NumberBlock));
    loaded->state = unit_allocate(unit, BLOCKS, sizeof(NumberBlock));
    loaded->results = unit_allocate(unit, BLOCKS, sizeof(NumberBlock));
    return !loaded->shape || !loaded->constants || !loaded->state || !loaded->results;
}

/* Begin the next step of a run; 1 with the reason. */
static int load_next(Unit *unit, Loaded *loaded)
{
    const Composite *c = unit->own;
    const Machine *m = &c->pieces.step;
    if (one_piece_prepare(unit, &loaded->angle, &loaded->is_wanted)) {
        return 1;
    }
    if (!loaded->results && allocate_blocks(unit, loaded)) {
        return unit_fail(unit, "there is no memory left");
    }
    machine_shape(m, loaded->shape);
    if (loaded->times_made != c->pieces.times_made || loaded->order != one_piece_order(c)) {
        loaded->times_made = c->pieces.times_made;
        loaded->order = one_piece_order(c);
        machine_constants(m, loaded->constants);
        machine_state(m, loaded->state);
        machine_results(m, loaded->order, loaded->results);
    }
    return 0;
}

/* Go on to where a step of this run or of the next one begins, if there is one. */
static void reach_step(BatchRun *run, Loaded *loaded, BatchCall *all)
{
    for (;;) {
        if (!run->is_live) {
            batch_run_next(run, all);
        }
        if (!run->is_live) {
            return;
        }
        if (!batch_run_read(run, all)) {
            continue;
        }
        if (!load_next(run->unit, loaded)) {
            return;
        }
        batch_run_fail(run, all);
    }
}

/* -- all ---------------------------------------------------------------------------------------------- */

int side_by_side_tell(BatchRun *const *runs, Loaded *const *loaded, int count, Held *held, LaneMachine *machines)
{
    int lane;
    if (!held->by) {
        return 1;
    }
    if (!held->lanes) {
        const Machine *m = machine_of(runs[0]);
        int k, lobes = 0;
        for (k = 0; k < m->track_count; k++) {
            lobes = m->tracks[k].lobes > lobes ? m->tracks[k].lobes : lobes;
        }
        held->lanes = held->by->allocate(runs[0]->unit, m->stations, m->weight_count, m->track_count, lobes);
        if (!held->lanes) {
            return 1;
        }
    }
    for (lane = 0; lane < LANES; lane++) {
        const BatchRun *run = lane < count ? runs[lane] : NULL;
        const size_t times_made = run ? ((const Composite *)run->unit->own)->pieces.times_made : 0;
        if (run) {
            LaneMachine *machine = machines + lane;
            machine->shape = loaded[lane]->shape;
            machine->motor = machine_of(run)->drive.motor;
            machine->constants = loaded[lane]->constants;
            machine->state = loaded[lane]->state;
            machine->results = loaded[lane]->results;
            machine->angle = loaded[lane]->angle;
            machine->is_new = held->holds[lane] != run || held->times_made[lane] != times_made;
        }
        held->holds[lane] = run;
        held->times_made[lane] = times_made;
    }
    return 0;
}

/* Expand these together; 1 where there are no lanes, or no memory for it. */
static int expand_together(BatchRun *const *runs, Loaded *const *loaded, int count, Held *held)
{
    LaneMachine machines[LANES];
    if (side_by_side_tell(runs, loaded, count, held, machines)) {
        return 1;
    }
    held->by->expand(held->lanes, machines, count, loaded[0]->order);
    return 0;
}

static bool is_alike(const Loaded *a, const Loaded *b)
{
    return a->order == b->order && !memcmp(a->shape, b->shape, a->shape_size);
}

static bool is_to_expand(const Loaded *loaded)
{
    return loaded->is_wanted && !loaded->waits;
}

/* Expand what is wanted: together those that are computed alike. */
static void expand_all(BatchRun *runs, Loaded *loaded, int count, Held *held)
{
    int first, k;
    for (first = 0; first < count; first++) {
        BatchRun *together[LANES];
        Loaded *steps[LANES];
        int found = 0;
        for (k = first; k < count && is_to_expand(loaded + first); k++) {
            if (is_to_expand(loaded + k) && is_alike(loaded + first, loaded + k)) {
                together[found] = runs + k;
                steps[found++] = loaded + k;
            }
        }
        if (found > 1 && expand_together(together, steps, found, held)) {
            found = 1;
        }
        if (found == 1) {
            machine_expand(machine_of(runs + first), loaded[first].angle, loaded[first].order);
        }
        for (k = 0; k < found; k++) {
            loaded[together[k] - runs].is_wanted = false;
        }
    }
}

/* Whether the step that has been loaded may be followed by others before the machine is looked at. */
static bool is_smooth(const BatchRun *run, const Loaded *loaded)
{
    return loaded->is_wanted && !loaded->is_alone && one_piece_is_smooth(run->unit);
}

/* Let the only run that goes on do so in smooth steps, if it can; whether it has. */
static bool go_on_alone(BatchRun *runs, Loaded *loaded, int count, BatchCall *all)
{
    int only = -1, live = 0, k;
    for (k = 0; k < count; k++) {
        live += runs[k].is_live;
        only = runs[k].is_live ? k : only;
    }
    if (live != 1 || !is_smooth(runs + only, loaded + only)) {
        return false;
    }
    loaded[only].waits = false;
    smooth_steps_alone(runs + only, loaded + only, all);
    return true;
}

/* Let runs stay in their lanes, if all that go on can; whether they have.  Where some cannot, those that can wait. */
static bool stay_in_lanes(BatchRun *runs, Loaded *loaded, int count, Held *held, BatchCall *all)
{
    BatchRun *together[LANES];
    Loaded *steps[LANES];
    LaneMachine machines[LANES];
    int live = 0, found = 0, alike = 0, k;
    for (k = 0; k < count; k++) {
        live += runs[k].is_live;
        loaded[k].waits = held->by && runs[k].is_live && is_smooth(runs + k, loaded + k);
        if (loaded[k].waits) {
            together[found] = runs + k;
            steps[found++] = loaded + k;
            alike += is_alike(steps[0], loaded + k);
        }
    }
    if (found < live && found) {
        return false;
    }
    for (k = 0; k < count; k++) {
        loaded[k].waits = false;
    }
    if (found < 2 || alike < found || side_by_side_tell(together, steps, found, held, machines)) {
        return false;
    }
    smooth_steps(together, steps, found, held, machines, all);
    return true;
}

/* Go on to where steps of the runs begin that do not wait; whether there are any. */
static bool reach_steps(BatchRun *runs, Loaded *loaded, int count, BatchCall *all)
{
    bool goes_on = false;
    int k;
    for (k = 0; k < count; k++) {
        if (!loaded[k].waits) {
            loaded[k].is_wanted = false;
            reach_step(runs + k, loaded + k, all);
        }
        goes_on |= runs[k].is_live;
    }
    return goes_on;
}

int side_by_side_most(void)
{
    const LaneFunctions *by = lanes_of_processor();
    return by && by->expand ? LANES : 1;
}

void side_by_side_run(BatchRun *runs, int count, BatchCall *all)
{
    Loaded loaded[LANES];
    Held held;
    int k;
    memset(loaded, 0, sizeof loaded);
    memset(&held, 0, sizeof held);
    held.by = lanes_of_processor();
    while (reach_steps(runs, loaded, count, all)) {
        if (go_on_alone(runs, loaded, count, all) || stay_in_lanes(runs, loaded, count, &held, all)) {
            continue;
        }
        expand_all(runs, loaded, count, &held);
        for (k = 0; k < count; k++) {
            loaded[k].is_alone &= loaded[k].waits;
            if (runs[k].is_live && !loaded[k].waits && one_piece_step(runs[k].unit)) {
                batch_run_fail(runs + k, all);
            }
        }
    }
}
