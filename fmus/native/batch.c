#include "batch.h"

#include <string.h>

#include "elementary.h"
#include "unit.h"

/* Keep the reason of an error; `host` is where. */
static void keep(void *host, const char *name, Status status, const char *message)
{
    char **reason = host;
    (void)name;
    if (status >= STATUS_DISCARD) {
        Text text = text_in(*reason, BATCH_REASON);
        text_put(&text, message);
    }
}

/* The run of one set of values; how many of its points were reached. */
static size_t run(Unit *unit, const Batch *batch, const double *values, double end, double *signals)
{
    int level;
    size_t k;
    unit_reset(unit);
    if (unit_set_reals(unit, batch->references, batch->changed, values) ||
        unit_setup(unit, 0.0, infinity()) || unit_enter_initialisation(unit) ||
        unit_exit_initialisation(unit) ||
        unit_get_reals(unit, batch->outputs, batch->asked, signals)) {
        return 0;
    }
    level = unit_level(unit, batch->outputs, batch->asked);
    for (k = 1; k <= batch->points; k++) {
        const double time = end * ((double)k / (double)batch->points);
        signals += batch->asked;
        if (unit_step(unit, unit->time, time - unit->time) ||
            unit_read(unit, level, batch->outputs, batch->asked, signals)) {
            return k;
        }
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
    unit = runs ? unit_instantiate("run", token, keep, &reason) : NULL;
    if (unit) {
        unit->asked = batch->outputs;
        unit->asked_count = batch->asked;
    }
    for (k = 0; k < runs; k++) {
        double *found = signals + k * rows * batch->asked;
        size_t reached;
        reason = reasons + k * BATCH_REASON;
        if (!unit && k) {
            memcpy(reason, reasons, BATCH_REASON); /* the token was refused */
        }
        reached = unit ? run(unit, batch, values + k * batch->changed, ends[k], found) : 0;
        for (i = reached * batch->asked; i < rows * batch->asked; i++) {
            found[i] = not_a_number();
        }
        failed += reached < rows;
    }
    if (unit) {
        unit_free(unit);
    }
    return failed;
}
