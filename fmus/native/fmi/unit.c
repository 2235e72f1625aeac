#include "fmi/unit.h"

#include <stdlib.h>
#include <string.h>

#include "base/elementary.h"
#include "base/pair.h"

/* A host's own sums of times are off by their rounding; more is another point in time. */
static const double POINT_OF_STEP = 1e-6, POINT_OF_TIME = 1e-10;

/* -- memory ---------------------------------------------------------------------------------- */

void *unit_allocate(Unit *unit, size_t count, size_t size)
{
    /* a block begins with the link to the block before; pairs behind it lie at multiples of their size */
    const size_t most = ((size_t)-1 - sizeof(Pair)) / (size ? size : 1);
    void **block = count <= most ? calloc(1, sizeof(Pair) + count * size) : NULL;
    if (!block) {
        return NULL;
    }
    *block = unit->allocated;
    unit->allocated = block;
    return (char *)block + sizeof(Pair);
}

void unit_free(Unit *unit)
{
    void **block = unit->allocated;
    while (block) {
        void **before = *block;
        free(block);
        block = before;
    }
    free(unit);
}

/* -- life cycle ------------------------------------------------------------------------------ */

void unit_reset(Unit *unit)
{
    memcpy(unit->real, unit->starts, unit->layout.real_count * sizeof(double));
    memcpy(unit->boolean, unit->flags, unit->layout.boolean_count);
    memset(unit->memory, 0, unit->memory_count * sizeof(double));
    unit->time = unit->time_left = unit->start = unit->point = 0.0;
    unit->stop = infinity();
    unit->asks_tolerance = false;
    unit->taken_tolerance = 0.0;
    unit->phase = INSTANTIATED;
    unit->stale = BEGINNING;
    unit->warned = 0;
}

Status unit_setup(Unit *unit, double start, double stop)
{
    if (!is_finite(start) || !(stop >= start)) {
        return unit_refuse(unit, "set-up failed", "start time = %v s, stop time = %v s: must be "
                           "finite numbers, the stop time not before the start time", start, stop);
    }
    unit->start = unit->point = start;
    unit->time = unit->time_left = 0.0;
    unit->stop = stop;
    return STATUS_OK;
}

Status unit_set_tolerance(Unit *unit, const char *function, int defined, double tolerance)
{
    if (defined && !(tolerance > 0.0 && is_finite(tolerance))) {
        return unit_refuse(unit, function, "tolerance = %v: must be a finite number above 0", tolerance);
    }
    unit->asks_tolerance = defined != 0;
    unit->tolerance = tolerance;
    unit->stale = BEGINNING; /* outputs that were read before do not have it */
    return STATUS_OK;
}

void unit_go_to(Unit *unit, double point)
{
    unit->point = point;
    unit->time = point - unit->start;
    unit->time_left = 0.0;
}

/* Add a step to the time since the start, by compensated summation: no more is lost than a rounding of the
   sum, however many steps, and nothing of it depends on where the host's time begins. */
static void pass_time(Unit *unit, double step)
{
    const double added = step + unit->time_left, sum = unit->time + added;
    unit->time_left = added - (sum - unit->time);
    unit->time = sum;
}

Status unit_exit_initialisation(Unit *unit)
{
    if (unit_refresh(unit, WITHOUT_TORQUES)) {
        return unit_report(unit, STATUS_ERROR, "initialisation failed");
    }
    unit->phase = RUNNING;
    return STATUS_OK;
}

/* 0, or 1 and why a step may not be made from here or as far as that. */
static int out_of_place(Unit *unit, double time, double step)
{
    const double rounding = POINT_OF_STEP * step + POINT_OF_TIME * absolute(unit->point);
    if (!(absolute(time - unit->point) <= rounding)) {
        return unit_fail(unit, "communication point = %v s: must be where the unit is, %v s", time,
                         unit->point);
    }
    if (time + step > unit->stop + rounding) {
        return unit_fail(unit, "end of the step = %v s: must not be beyond the stop time, %v s",
                         time + step, unit->stop);
    }
    return 0;
}

/* 0, or 1 with the reason when one of these is not finite. */
static int demand_finite_values(Unit *unit, Range range)
{
    const double *values = unit->real + range.first;
    double even = 0.0, odd = 0.0; /* sums, not finite where one of them is not, or where they are huge */
    size_t k;
    for (k = 0; k + 1 < range.count; k += 2) {
        even += values[k];
        odd += values[k + 1];
    }
    if (is_finite(even + odd + (k < range.count ? values[k] : 0.0))) {
        return 0;
    }
    for (k = range.first; k < range.first + range.count; k++) {
        if (!is_finite(unit->real[k])) {
            layout_shown(&unit->layout, k, unit->real[k], unit_reason(unit));
            text_put(&unit->reason, ": must be a finite number");
            return 1;
        }
    }
    return 0;
}

/* Move the equations by a step [s]; 1 with the reason, and as it was, where they fail. */
static int advance(Unit *unit, double step)
{
    const size_t size = unit->memory_count * sizeof(double);
    memcpy(unit->before, unit->memory, size);
    unit->made = step;
    if (demand_finite_values(unit, unit->layout.inputs) || unit->equations->step(unit, step) ||
        demand_finite_values(unit, unit->layout.computed)) {
        memcpy(unit->memory, unit->before, size);
        unit->stale = unit->stale > COMPUTED ? unit->stale : COMPUTED;
        return 1;
    }
    return 0;
}

Status unit_step(Unit *unit, double time, double step)
{
    int failed;
    if (unit->for_model_exchange) {
        return unit_refuse(unit, "step", "the instance is for model exchange");
    }
    if (!(step > 0.0 && is_finite(step))) {
        failed = unit_fail(unit, "communication step size = %v s: must be above 0 s", step);
    } else {
        failed = out_of_place(unit, time, step) || unit_refresh(unit, COMPUTED) ||
                 advance(unit, step);
    }
    if (failed) {
        char words[64];
        Text what = text_in(words, sizeof words);
        text_format(&what, "step of %6 s failed", step);
        return unit_report(unit, STATUS_ERROR, words);
    }
    pass_time(unit, unit->made);
    unit->point = time + unit->made;
    unit->stale = OBSERVED;
    return STATUS_OK;
}

/* -- inside ---------------------------------------------------------------------------------- */

int unit_check(Unit *unit, const unsigned *references, size_t count, const double *values)
{
    int wrong = 0;
    size_t k;
    for (k = 0; k < count; k++) {
        const size_t reference = references ? references[k] : k;
        if (!layout_allows(&unit->layout, reference, values[k])) {
            text_put(wrong ? &unit->reason : unit_reason(unit), wrong ? "; " : "");
            layout_refuse(&unit->layout, reference, values[k], &unit->reason);
            wrong = 1;
        }
    }
    return wrong;
}

int unit_refresh(Unit *unit, int level)
{
    const Equations *equations = unit->equations;
    if (unit->stale == BEGINNING && level < BEGINNING) {
        const Range inputs = unit->layout.inputs;
        if (unit_check(unit, NULL, inputs.first + inputs.count, unit->real) || equations->parameters(unit) || equations->begin(unit)) {
            return 1;
        }
        unit->stale = COMPUTED;
    }
    if (unit->stale == COMPUTED && level < COMPUTED) {
        if (demand_finite_values(unit, unit->layout.inputs) || equations->outputs(unit) ||
            demand_finite_values(unit, unit->layout.computed)) {
            return 1;
        }
        unit->stale = OBSERVED;
    }
    if (unit->stale == OBSERVED && level < OBSERVED) {
        if (equations->observe(unit)) {
            return 1;
        }
        unit->stale = WITHOUT_TORQUES;
    }
    if (unit->stale == WITHOUT_TORQUES && level < WITHOUT_TORQUES) {
        if (equations->observe_torques && equations->observe_torques(unit)) {
            return 1;
        }
        unit->stale = FRESH;
    }
    return 0;
}

bool unit_ends_with(const Unit *unit, size_t reference)
{
    return reference + 2 >= unit->layout.real_count;
}
