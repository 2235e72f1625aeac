#include "coupling/run.h"

#include <stdlib.h>
#include <string.h>

#include "base/elementary.h"
#include "coupling/composite.h"
#include "coupling/one_piece.h"

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
    shown->time = run->unit->time;
    shown->order = course->one_piece.order;
    shown->collocated = course->one_piece.collocated_steps;
    shown->stiff = one_piece_may_collocate(c);
    shown->steps = course->total.steps;
    shown->passes = course->total.passes;
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
    c->pieces.share = steps->share;
    c->pieces.events = 0.0;
    if (c->pieces.grain != steps->grain) {
        c->pieces.grain = steps->grain;
        c->pieces.is_made = false;
    }
    unit_reset(unit);
    if (unit_set_reals(unit, steps->references, steps->changed, steps->values) || unit_setup(unit, 0.0, infinity()) ||
        unit_exit_initialisation(unit)) {
        shown->reason = unit->reason.at;
        return 1;
    }
    shown->reason = "";
    c->pacing.points = steps->points;
    c->pacing.count = steps->count;
    show_facts(run);
    return 0;
}

static void stand(Unit *unit, double time)
{
    unit_go_to(unit, time);
    unit->stale = OBSERVED;
}

/* The next output point that is chosen in one piece, where none is given: equal parts of its own steps, of
   which those that events have made very short have none. */
static int choose_point(Unit *unit, const Stretch *stretch, double *point)
{
    const double SAME_POINT = 1e-6; /* of a part: time is rounded */
    const double NEAREST_POINT = 1e-3; /* of the longest distance of points */
    const Clock *clock = &((const Composite *)unit->own)->course->clock;
    const double begin = unit->time;
    double time = begin, parts, part;
    do {
        if (!(time < clock->time - TIME_ROUNDING * (clock->time + clock->length)) && one_piece_step(unit)) {
            return 1;
        }
        parts = larger(1.0, nearest(clock->length / stretch->longest + 0.5));
        part = clock->length / parts;
        parts = nearest((larger(time, clock->begin) - clock->begin) / part - 0.5 + SAME_POINT) + 1.0;
        *point = time = clock->begin + parts * part;
    } while (time - begin < NEAREST_POINT * stretch->longest && time < stretch->end);
    return 0;
}

/* The next output point in one piece; 1 with the reason. */
static int next_point(Unit *unit, const Stretch *stretch, double *point)
{
    Pacing *pacing = &((Composite *)unit->own)->pacing;
    const double given = stretch->step;
    if (given > 0.0) {
        *point = stretch->begin + (double)(stretch->done + 1) * given;
        return 0;
    }
    while (pacing->next < pacing->count && pacing->points[pacing->next] <= unit->time * (1.0 + TIME_ROUNDING)) {
        pacing->next++;
    }
    if (pacing->next < pacing->count) {
        *point = smaller(stretch->end, pacing->points[pacing->next]);
        return 0;
    }
    if (choose_point(unit, stretch, point)) {
        return 1;
    }
    if (*point > stretch->end * (1.0 - TIME_ROUNDING)) {
        *point = stretch->end;
    }
    return 0;
}

/* Go to the next output point; its time, below 0 where that failed. */
static double go_on(Unit *unit, Stretch *stretch)
{
    double point;
    if (composite_meet_host(unit) || next_point(unit, stretch, &point) || composite_go_to(unit, point)) {
        return -1.0;
    }
    stretch->done++;
    return point;
}

static bool is_over(const Unit *unit, const Stretch *stretch)
{
    if (stretch->step > 0.0) {
        return stretch->done >= stretch->count;
    }
    return !(stretch->end - unit->time > TIME_ROUNDING * stretch->end);
}

size_t autobalancer_run_on(Run *shown, Stretch *stretch, const unsigned *outputs, size_t asked,
                           size_t most, double *rows)
{
    KeptRun *run = (KeptRun *)shown;
    Unit *unit = run->unit;
    size_t k;
    if (!stretch->done) {
        stand(unit, stretch->begin);
    }
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
        if (stretch->events) {
            stretch->events[k] = ((const Composite *)unit->own)->pieces.events;
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
    if (unit_get_reals(unit, references, count, values)) {
        shown->reason = unit->reason.at;
        return 1;
    }
    return 0;
}
