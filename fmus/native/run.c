#include "run.h"

#include <stdlib.h>
#include <string.h>

#include "composite.h"
#include "elementary.h"

enum { WARNINGS_SIZE = 8192 };
static const char NAME[] = "run", OF_PART[] = "run: ";
static const double SLIVER = 1e-12; /* of a time: rounding, not a step */

struct Run {
    Unit *unit;
    const char *reason;
    Text warnings;
    char refusal[REASON_SIZE], buffer[WARNINGS_SIZE];
};

/* Keep why there is no unit, and what its parts warn of; what the coupling itself would say is among
   the facts. */
static void keep(void *host, const char *name, Status status, const char *message)
{
    Run *run = host;
    (void)name;
    if (!run->unit) {
        Text text = text_in(run->refusal, sizeof run->refusal);
        text_put(&text, message);
    } else if (status == STATUS_WARNING && !strncmp(message, OF_PART, sizeof OF_PART - 1)) {
        text_put(&run->warnings, message + sizeof OF_PART - 1);
        text_put(&run->warnings, "\n");
    }
}

Run *autobalancer_run_new(const char *token)
{
    Run *run = calloc(1, sizeof *run);
    if (run) {
        run->warnings = text_in(run->buffer, sizeof run->buffer);
        run->reason = run->refusal;
        run->unit = unit_instantiate(NAME, token, keep, run);
    }
    return run;
}

void autobalancer_run_free(Run *run)
{
    if (run->unit) {
        unit_free(run->unit);
    }
    free(run);
}

int autobalancer_run_start(Run *run, const Steps *steps)
{
    Unit *unit = run->unit;
    Composite *c;
    if (!unit) {
        return 1;
    }
    c = unit->own;
    run->warnings = text_in(run->buffer, sizeof run->buffer);
    run->reason = "";
    memset(&c->pacing, 0, sizeof c->pacing);
    c->loop_failed = 0;
    unit_reset(unit);
    if (unit_setup(unit, 0.0, infinity()) || unit_enter_initialisation(unit) ||
        unit_exit_initialisation(unit)) {
        run->reason = unit->reason.at;
        return 1;
    }
    c->pacing.share = steps->share;
    c->pacing.points = steps->points;
    c->pacing.count = steps->count;
    if (steps->points) {
        iterated_allow(c, steps->residual);
    }
    return 0;
}

static void stand(Unit *unit, double time)
{
    unit->time = ((Composite *)unit->own)->course->time = time;
    unit->stale = OBSERVED;
}

/* One communication step; the time at its end, below 0 where it failed. */
static double go_on(Unit *unit, Stretch *stretch)
{
    const Composite *c = unit->own;
    const double given = stretch->step;
    if (composite_run_step(unit, given > 0.0 ? given : stretch->end - c->course->time)) {
        return -1.0;
    }
    stretch->done++;
    /* a product instead of a sum: rounding must not move the communication points */
    return given > 0.0 ? stretch->begin + (double)stretch->done * given : c->course->time;
}

static int is_over(const Unit *unit, const Stretch *stretch)
{
    const double time = ((const Composite *)unit->own)->course->time;
    if (stretch->step > 0.0) {
        return stretch->done >= stretch->count;
    }
    return !(stretch->end - time > SLIVER * stretch->end);
}

size_t autobalancer_run_on(Run *run, Stretch *stretch, const unsigned *outputs, size_t asked,
                           size_t most, double *rows)
{
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
            run->reason = unit->reason.at;
            break;
        }
        stand(unit, *rows);
        unit_get_reals(unit, outputs, asked, rows + 1);
    }
    unit->asked = NULL;
    return k;
}

int autobalancer_run_read(Run *run, const unsigned *references, size_t count, double *values)
{
    run->unit->stale = run->unit->stale < OBSERVED ? OBSERVED : run->unit->stale;
    return unit_get_reals(run->unit, references, count, values) != STATUS_OK;
}

void autobalancer_run_facts(const Run *run, Facts *facts)
{
    const Composite *c = run->unit->own;
    const Course *course = c->course;
    facts->time = course->time;
    facts->loop_gain = course->gain;
    facts->steps = course->steps;
    facts->passes = course->passes;
    facts->unconverged = course->unconverged;
    facts->worst_residual = course->worst_left;
    facts->estimated_error = course->allowed > 0.0 ? 0.0 : course->error;
    facts->unresolved = course->unresolved;
    facts->loop_failed = c->loop_failed;
}

const char *autobalancer_run_reason(const Run *run)
{
    return run->reason;
}

const char *autobalancer_run_warnings(const Run *run)
{
    return run->buffer;
}
