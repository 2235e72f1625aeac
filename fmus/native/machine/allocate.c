/* Memory of a machine. */
#include "machine/machine.h"

enum { FEWEST_BESIDE = 3 }; /* weights: of fewer most of a vector would be empty */

#ifdef SIDE_BY_SIDE
#include <stdint.h>

/* From a multiple of the size of a number on: a vector that lies across two lines of the cache takes twice as long. */
static void *counted(Unit *unit, size_t count, size_t size, int *missing)
{
    const char *made = unit_allocate(unit, count * size + sizeof(Number), 1);
    *missing |= !made;
    return made ? (void *)(((uintptr_t)made + sizeof(Number) - 1) / sizeof(Number) * sizeof(Number)) : NULL;
}
#else
static void *counted(Unit *unit, size_t count, size_t size, int *missing)
{
    void *made = unit_allocate(unit, count, size);
    *missing |= !made;
    return made;
}
#endif

static Pair *counted_pairs(Unit *unit, size_t count, int *missing)
{
    return counted(unit, count, sizeof(Pair), missing);
}

static Number *counted_numbers(Unit *unit, size_t count, int *missing)
{
    return counted(unit, count, sizeof(Number), missing);
}

int machine_allocate(Unit *unit, Machine *machine, int stations, int weights, int tracks, int lobes)
{
    enum { COEFFICIENTS = MOST_ORDER + 3 };
    const size_t n = (size_t)stations, width = n + ((size_t)weights + 1) / 2, square = n * n;
    const size_t unknowns = 2 * n + 1;
    int k, missing = 0;
    double *per = unit_allocate(unit, COEFFICIENTS + 1, sizeof *per);
    for (k = 1; k <= COEFFICIENTS && per; k++) {
        per[k] = 1.0 / k;
    }
    machine->per = per;
#ifndef SIDE_BY_SIDE
    machine->lanes = lanes_of_processor();
#endif
    machine->stations = stations;
    machine->width = (int)width;
    machine->mass = counted_numbers(unit, square, &missing);
    machine->stiffness = counted_pairs(unit, square, &missing);
    machine->damping = counted_pairs(unit, square, &missing);
    machine->cross_stiffness = counted_pairs(unit, square, &missing);
    machine->cross_damping = counted_pairs(unit, square, &missing);
    machine->stiffness_slope = counted_pairs(unit, square, &missing);
    machine->damping_slope = counted_pairs(unit, square, &missing);
    machine->cross_stiffness_slope = counted_pairs(unit, square, &missing);
    machine->cross_damping_slope = counted_pairs(unit, square, &missing);
    machine->internal_damping = counted_numbers(unit, square, &missing);
    machine->gyroscopic = counted_numbers(unit, square, &missing);
    machine->unbalance = counted_pairs(unit, n, &missing);
    machine->push = counted_pairs(unit, SIGNAL_ORDERS * n, &missing);
    machine->motion = counted_pairs(unit, COEFFICIENTS * width, &missing);
    machine->velocity = counted_pairs(unit, COEFFICIENTS * width, &missing);
    machine->acceleration = counted_pairs(unit, COEFFICIENTS * n, &missing);
    machine->turning = counted_pairs(unit, COEFFICIENTS * n, &missing);
    machine->sloped = counted_pairs(unit, COEFFICIENTS * n, &missing);
    machine->swept = counted_pairs(unit, COEFFICIENTS * n, &missing);
    machine->sheared = counted_pairs(unit, COEFFICIENTS * n, &missing);
    machine->spin = counted_pairs(unit, COEFFICIENTS, &missing);
    machine->shaft = counted_pairs(unit, COEFFICIENTS, &missing);
    machine->speed = counted_numbers(unit, COEFFICIENTS, &missing);
    machine->matrix = counted_numbers(unit, unknowns * unknowns, &missing);
    machine->right = counted_numbers(unit, unknowns, &missing);
    machine->tracks = unit_allocate(unit, (size_t)tracks, sizeof(MachineTrack));
    machine->weights = unit_allocate(unit, (size_t)weights, sizeof(SeriesWeight));
    machine->races = unit_allocate(unit, (size_t)weights, sizeof *machine->races);
    if (missing || !per || !machine->tracks || !machine->weights || !machine->races) {
        return 1;
    }
    for (k = 0; k < tracks; k++) {
        machine->tracks[k].pull = counted_pairs(unit, COEFFICIENTS, &missing);
        machine->tracks[k].lobe = counted_numbers(unit, LOBE_NUMBERS * (size_t)lobes, &missing);
    }
    for (k = 0; k < weights; k++) {
        machine->weights[k].unit = counted_pairs(unit, COEFFICIENTS, &missing);
        machine->weights[k].rate = counted_pairs(unit, COEFFICIENTS, &missing);
        machine->races[k] = lobes ? series_race_allocate(unit, lobes) : NULL;
        missing |= lobes && !machine->races[k];
    }
    return missing;
}

#ifndef SIDE_BY_SIDE
int machine_allocate_beside(Unit *unit, Machine *machine, int weights, int tracks)
{
    const LaneFunctions *by = weights >= FEWEST_BESIDE ? machine->lanes : NULL;
    if (!by) {
        return 0;
    }
    machine->beside = by->allocate_beside(unit, weights, tracks);
    if (machine->beside) {
        machine->beside->by = by;
    }
    return !machine->beside;
}
#endif
