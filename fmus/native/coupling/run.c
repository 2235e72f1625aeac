#include "coupling/run.h"

#include <stdlib.h>
#include <string.h>

#include "base/elementary.h"
#include "coupling/composite.h"

enum { WARNINGS_SIZE = 8192 };
static const char NAME[] = "run", OF_PART[] = "run: ";
typedef struct {
    Run shown;
    Unit *unit;
    Text warnings;
    char refusal[REASON_SIZE], buffer[WARNINGS_SIZE];
} KeptRun;

/* Keep why there is no unit, and what its parts warn of; what the coupling itself would say is among
   the facts. */
static void keep_message(void *host, const char *name, Status status, const char *message)
{
    KeptRun *run = host;
    if (!run->unit) {
        Text text = text_in(run->refusal, sizeof run->refusal);
        text_put(&text, message);
    } else if (status == STATUS_WARNING && !strncmp(message, OF_PART, sizeof OF_PART - 1)) {
        text_format(&run->warnings, "%s\n", message + sizeof OF_PART - 1);
    }
}

Run *autobalancer_run_new(const char *token)
{
    KeptRun *run = calloc(1, sizeof *run);
    if (!run) {
        return NULL;
    }
    run->warnings = text_in(run->buffer, sizeof run->buffer);
    run->shown.warnings = run->buffer;
    run->shown.reason = run->refusal;
    run->unit = unit_instantiate(NAME, token, keep_message, run);
    return &run->shown;
}

void autobalancer_run_free(Run *shown)
{
    KeptRun *run = (KeptRun *)shown;
    if (run->unit) {
        unit_free(run->unit);
    }
    free(run);
}

static void show_facts(KeptRun *run)
{
    const Composite *c = run->unit->own;
    const Course *course = c->course;
    Run *shown = &run->shown;
    shown->time = course->clock.time;
    shown->steps = course->total.steps;
    shown->passes = course->total.passes;
    shown->unconverged = course->total.unconverged;
    shown->worst_residual = course->total.worst_left;
    shown->estimated_error = course->adaptive.allowed > 0.0 ? 0.0 : course->total.error;
    shown->unresolved = course->resolution.unresolved;
    shown->loop_failed = c->loop_failed;
}

int autobalancer_run_start(Run *shown, const Steps *steps)
{
    KeptRun *run = (KeptRun *)shown;
    Unit *unit = run->unit;
    Composite *c;
    if (!unit) {
        return 1;
    }
    c = unit->own;
    run->warnings = text_in(run->buffer, sizeof run->buffer);
    memset(&c->pacing, 0, sizeof c->pacing);
    c->loop_failed = 0;
    unit_reset(unit);
    if (unit_setup(unit, 0.0, infinity()) ||
        unit_exit_initialisation(unit)) {
        shown->reason = unit->reason.at;
        return 1;
    }
    shown->reason = "";
    c->pacing.share = steps->share;
    c->pacing.points = steps->points;
    c->pacing.count = steps->count;
    if (steps->points) {
        iterated_allow(c, steps->residual);
    } else if (steps->share > 0.0) {
        adaptive_allow(c, steps->share);
    }
    show_facts(run);
    return 0;
}

static void stand(Unit *unit, double time)
{
    unit_go_to(unit, time);
    ((Composite *)unit->own)->course->clock.time = time;
    unit->stale = OBSERVED;
}

/* One communication step; the time at its end, below 0 where it failed. */
static double go_on(Unit *unit, Stretch *stretch)
{
    const Composite *c = unit->own;
    const double given = stretch->step;
    if (composite_run_step(unit, given > 0.0 ? given : stretch->end - c->course->clock.time)) {
        return -1.0;
    }
    stretch->done++;
    /* a product instead of a sum: rounding must not move the communication points */
    return given > 0.0 ? stretch->begin + (double)stretch->done * given : c->course->clock.time;
}

static int is_over(const Unit *unit, const Stretch *stretch)
{
    const double time = ((const Composite *)unit->own)->course->clock.time;
    if (stretch->step > 0.0) {
        return stretch->done >= stretch->count;
    }
    return !(stretch->end - time > TIME_ROUNDING * stretch->end);
}

size_t autobalancer_run_on(Run *shown, Stretch *stretch, const unsigned *outputs, size_t asked,
                           size_t most, double *rows)
{
    KeptRun *run = (KeptRun *)shown;
    Unit *unit = run->unit;
    Composite *c = unit->own;
    size_t k;
    if (!stretch->done) {
        stand(unit, stretch->begin);
    }
    c->pacing.longest = stretch->longest;
    unit->asked = outputs;
    unit->asked_count = asked;
    for (k = 0; k < most && !is_over(unit, stretch); k++, rows += 1 + asked) {
        *rows = go_on(unit, stretch);
        if (*rows < 0.0) {
            shown->reason = unit->reason.at;
            break;
        }
        stand(unit, *rows);
        if (unit_get_reals(unit, outputs, asked, rows + 1)) {
            shown->reason = unit->reason.at;
            break;
        }
    }
    unit->asked = NULL;
    show_facts(run);
    return k;
}

int autobalancer_run_read(Run *shown, const unsigned *references, size_t count, double *values)
{
    Unit *unit = ((KeptRun *)shown)->unit;
    unit->stale = unit->stale < OBSERVED ? OBSERVED : unit->stale;
    return unit_get_reals(unit, references, count, values) != STATUS_OK;
}
