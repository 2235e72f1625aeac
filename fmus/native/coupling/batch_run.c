#include "coupling/batch_run.h"

#include <string.h>

#include "base/elementary.h"
#include "coupling/composite.h"

/* Keep the reason of an error; `host` is where. */
static void keep_reason(void *host, const char *name, Status status, const char *message)
{
    const BatchRun *run = host;
    if (status >= STATUS_DISCARD) {
        Text text = text_in(run->reason, BATCH_REASON);
        text_put(&text, message);
    }
}

int batch_run_open(BatchRun *run, const char *token, BatchCall *all)
{
    run->reason = all->reasons;
    run->unit = unit_instantiate("run", token, keep_reason, run);
    if (!run->unit) {
        return 1;
    }
    run->unit->asked = all->batch->outputs;
    run->unit->asked_count = all->batch->asked;
    return 0;
}

/* -- rows ------------------------------------------------------------------------------------------ */

/* Numbers that a point leaves. */
static size_t width(const Batch *batch)
{
    return batch->asked + (batch->own_steps != 0);
}

double *batch_run_row(const BatchRun *run, const BatchCall *all, size_t point)
{
    return all->signals + (run->number * (all->batch->points + 1) + point) * width(all->batch);
}

/* The run is over, or has failed: nothing is known behind what has been written. */
static void close_rows(const BatchRun *run, BatchCall *all)
{
    double *row = batch_run_row(run, all, run->reached);
    const double *end = batch_run_row(run, all, all->batch->points + 1);
    while (row < end) {
        *row++ = not_a_number();
    }
}

/* Outputs that are read at the end. */
static int read_last(BatchRun *run, const BatchCall *all)
{
    const Batch *batch = all->batch;
    Unit *unit = run->unit;
    int wrong;
    unit->asked = batch->last_outputs;
    unit->asked_count = batch->asked_last;
    unit->stale = unit->stale < OBSERVED ? OBSERVED : unit->stale;
    wrong = unit_get_reals(unit, batch->last_outputs, batch->asked_last, all->last + run->number * batch->asked_last);
    unit->asked = batch->outputs;
    unit->asked_count = batch->asked;
    return wrong != STATUS_OK;
}

static void leave_last(const BatchRun *run, const BatchCall *all)
{
    const size_t count = all->batch->asked_last;
    fill_doubles(count, not_a_number(), all->last + run->number * count);
}

static void close_run(BatchRun *run, BatchCall *all)
{
    run->is_live = false;
    close_rows(run, all);
    if (run->reason[0] || (all->batch->asked_last && read_last(run, all))) {
        leave_last(run, all);
    }
    all->failed += run->reason[0] != '\0';
}

void batch_refuse_all(BatchCall *all)
{
    BatchRun run = {0};
    for (; run.number < all->runs; run.number++) {
        run.reason = all->reasons + run.number * BATCH_REASON;
        memmove(run.reason, all->reasons, BATCH_REASON);
        close_run(&run, all);
    }
}

/* -- a run by itself --------------------------------------------------------------------------------- */

static int begin_run(BatchRun *run, const BatchCall *all)
{
    const Batch *batch = all->batch;
    const int own = batch->own_steps != 0;
    double *row = batch_run_row(run, all, 0);
    Unit *unit = run->unit;
    unit_reset(unit);
    unit->one_step_per_call = own;
    if (unit_set_reals(unit, batch->references, batch->changed, all->values + run->number * batch->changed) ||
        unit_setup(unit, 0.0, infinity()) || unit_exit_initialisation(unit) ||
        unit_get_reals(unit, batch->outputs, batch->asked, row + own)) {
        return 1;
    }
    if (own) {
        row[0] = unit->time;
    }
    run->reached = 1;
    return 0;
}

/* Run to the end, from point to point. */
static void run_alone(BatchRun *run, const BatchCall *all)
{
    const Batch *batch = all->batch;
    const int own = batch->own_steps != 0;
    const double end = run->end, sliver = TIME_ROUNDING * end;
    Unit *unit = run->unit;
    const int level = unit_level(unit, batch->outputs, batch->asked);
    for (; run->reached <= batch->points && !(own && unit->time > end - sliver); run->reached++) {
        const double time = own ? end : end * ((double)run->reached / (double)batch->points);
        double *row = batch_run_row(run, all, run->reached);
        if (unit_step(unit, unit->point, time - unit->time) ||
            unit_read(unit, level, batch->outputs, batch->asked, row + own)) {
            return;
        }
        if (own) {
            row[0] = unit->time;
        }
    }
}

/* Let the motion be looked at up to the end where outputs there need that. */
static void watch_for_last(Unit *unit, const Batch *batch)
{
    Composite *c = unit->own;
    size_t k;
    c->pieces.is_watched = false;
    for (k = 0; k < batch->asked_last; k++) {
        c->pieces.is_watched |= batch->last_outputs[k] >= c->results + VIBRATION;
    }
}

void batch_run_next(BatchRun *run, BatchCall *all)
{
    const Batch *batch = all->batch;
    while (!run->is_live && all->next < all->runs) {
        const bool is_composite = run->unit->equations == &COMPOSITE_EQUATIONS;
        run->number = all->next++;
        run->reason = all->reasons + run->number * BATCH_REASON;
        run->end = all->ends[run->number];
        run->reached = 0;
        run->passes = 0.0;
        if (is_composite) {
            watch_for_last(run->unit, batch);
        }
        if (begin_run(run, all)) {
            close_run(run, all);
        } else if (is_composite && !batch->own_steps) { /* which goes on side by side with others */
            run->is_live = true;
        } else {
            run_alone(run, all);
            close_run(run, all);
        }
    }
}

/* -- side by side with others ------------------------------------------------------------------------ */

void batch_run_fail(BatchRun *run, BatchCall *all)
{
    char words[64];
    Text what = text_in(words, sizeof words);
    text_format(&what, "step of %6 s failed", run->end / (double)all->batch->points);
    unit_report(run->unit, STATUS_ERROR, words);
    close_run(run, all);
}

double batch_run_point(const BatchRun *run, const BatchCall *all, size_t number)
{
    return run->end * ((double)number / (double)all->batch->points);
}

int batch_run_points(const BatchRun *run, const BatchCall *all, double jump, double *points)
{
    const Composite *c = run->unit->own;
    const size_t left = all->batch->points + 1 - run->reached;
    const int most = left < MOST_READ ? (int)left : MOST_READ;
    int count = 0;
    while (count < most) {
        const double point = batch_run_point(run, all, run->reached + (size_t)count);
        if (!(point < jump) || !composite_reaches(c, point)) {
            break;
        }
        points[count++] = point;
    }
    return count;
}

/* The points that are read together from this one on, which the step reaches before the next jump; how many: more than
   one where nothing is to be found out on the way. */
static int find_points(BatchRun *run, const BatchCall *all, double point, double jump, double *points)
{
    const Composite *c = run->unit->own;
    const OnePiece *one_piece = &c->course->one_piece;
    if (one_piece->looked < one_piece->looks || one_piece_outputs(run->unit) != OUTPUTS_ARE_PLACES) {
        points[0] = point;
        return 1;
    }
    return batch_run_points(run, all, jump, points);
}

/* Outputs at times in the step, of which the last is shown. */
static int read_rows(Unit *unit, const Batch *batch, const double *times, int count, double *rows)
{
    unit_go_to(unit, times[count - 1]);
    if (one_piece_outputs(unit) == OUTPUTS_ARE_PLACES) {
        one_piece_read_places(unit->own, times, count, rows);
        return 0;
    }
    unit->stale = OBSERVED;
    return unit_get_reals(unit, batch->outputs, batch->asked, rows) != STATUS_OK;
}

/* Pass a jump; 1 with the reason. */
static int pass_jump(Unit *unit, double time)
{
    if (one_piece_show(unit, time)) {
        return 1;
    }
    unit_go_to(unit, time);
    return composite_pass_jump(unit);
}

bool batch_run_read(BatchRun *run, BatchCall *all)
{
    const Batch *batch = all->batch;
    const double length = run->end / (double)batch->points;
    Unit *unit = run->unit;
    const Composite *c = unit->own;
    while (run->reached <= batch->points) {
        double points[MOST_READ];
        const double point = batch_run_point(run, all, run->reached), jump = composite_next_jump(c);
        int count;
        if (!composite_reaches(c, smaller(point, jump))) {
            if (!composite_refuse_many(unit, run->passes, point - length, length)) {
                return true;
            }
            batch_run_fail(run, all);
            return false;
        }
        if (jump <= point) {
            if (pass_jump(unit, jump)) {
                batch_run_fail(run, all);
                return false;
            }
            continue;
        }
        count = find_points(run, all, point, jump, points);
        if (one_piece_show(unit, points[count - 1])) {
            batch_run_fail(run, all);
            return false;
        }
        if (read_rows(unit, batch, points, count, batch_run_row(run, all, run->reached))) {
            close_run(run, all); /* the reason has been kept */
            return false;
        }
        run->passes = c->course->total.passes;
        run->reached += (size_t)count;
    }
    close_run(run, all);
    return false;
}
