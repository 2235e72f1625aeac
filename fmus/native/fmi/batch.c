#include "fmi/batch.h"

#include <string.h>

#include "base/elementary.h"
#include "fmi/unit.h"

/* Keep the reason of an error; `host` is where. */
static void keep_reason(void *host, const char *name, Status status, const char *message)
{
    char **reason = host;
    if (status >= STATUS_DISCARD) {
        Text text = text_in(*reason, BATCH_REASON);
        text_put(&text, message);
    }
}

/* Numbers that a point leaves. */
static size_t width(const Batch *batch)
{
    return batch->asked + (batch->at_own_steps != 0);
}

/* The run of one set of values; how many of its points were reached. */
static size_t run_one(Unit *unit, const Batch *batch, const double *values, double end, double *signals)
{
    const int at_own_steps = batch->at_own_steps != 0;
    const double sliver = TIME_ROUNDING * end;
    int level;
    size_t k;
    unit_reset(unit);
    unit->one_step_per_call = at_own_steps;
    if (unit_set_reals(unit, batch->references, batch->set_count, values) ||
        unit_setup(unit, 0.0, infinity()) || unit_exit_initialisation(unit) ||
        unit_get_reals(unit, batch->outputs, batch->asked, signals + at_own_steps)) {
        return 0;
    }
    signals[0] = at_own_steps ? unit->time : signals[0];
    level = unit_level(unit, batch->outputs, batch->asked);
    for (k = 1; k <= batch->points && !(at_own_steps && unit->time > end - sliver); k++) {
        const double time = at_own_steps ? end : end * ((double)k / (double)batch->points);
        signals += width(batch);
        if (unit_step(unit, unit->point, time - unit->time) ||
            unit_read(unit, level, batch->outputs, batch->asked, signals + at_own_steps)) {
            return k;
        }
        signals[0] = at_own_steps ? unit->time : signals[0];
    }
    return k;
}

size_t autobalancer_runs(const char *token, const Batch *batch, size_t runs, const double *values,
                         const double *ends, double *signals, char *reasons)
{
    const size_t rows = batch->points + 1;
    char *reason = reasons;
    Unit *unit;
    size_t k, i, failed = 0;
    memset(reasons, 0, runs * BATCH_REASON);
    unit = runs ? unit_instantiate("run", token, keep_reason, &reason) : NULL;
    if (unit) {
        unit->asked = batch->outputs;
        unit->asked_count = batch->asked;
    }
    for (k = 0; k < runs; k++) {
        double *found = signals + k * rows * width(batch);
        size_t reached;
        reason = reasons + k * BATCH_REASON;
        if (!unit && k) {
            memcpy(reason, reasons, BATCH_REASON); /* the token was refused */
        }
        reached = unit ? run_one(unit, batch, values + k * batch->set_count, ends[k], found) : 0;
        for (i = reached * width(batch); i < rows * width(batch); i++) {
            found[i] = not_a_number();
        }
        failed += reason[0] != '\0';
    }
    if (unit) {
        unit_free(unit);
    }
    return failed;
}
