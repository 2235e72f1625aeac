/* What the outputs follow from that a host asks for of a composite in one piece; places out of a step. */
#include <string.h>

#include "coupling/composite.h"

/* The part of an output; NULL for one of the composite's own. */
static const Part *part_of(const Composite *c, size_t reference)
{
    int k;
    for (k = c->part_count - 1; k >= 0; k--) {
        if (reference >= c->parts[k].observed) {
            return reference < c->results ? c->parts + k : NULL;
        }
    }
    return NULL;
}

/* Number of an output among those that a part observes, below 0 for one that it computes. */
static long observed_number(const Part *part, size_t reference)
{
    const Layout *layout = &part->unit->layout;
    return (long)(reference - part->observed) - (long)(layout->observed.first - layout->computed.first);
}

/* Column and number in the pair of a place, from what a part observes; 1 where it is none. */
static int find_place(const Composite *c, size_t reference, int *column, int *number)
{
    const int n = c->pieces.step.stations;
    const Part *part = part_of(c, reference);
    const Balls *balls = part ? part_balls(part) : NULL;
    const long at = part ? observed_number(part, reference) : -1;
    int k, before = 0;
    if (part == c->parts && at >= 1 && at <= 2 * (n - c->pieces.rings)) {
        *column = (int)(at - 1) / 2;
        *number = (int)(at - 1) % 2;
        return 0;
    }
    if (!balls || at < 0 || at >= balls->count) {
        return 1;
    }
    for (k = 1; c->parts + k < part; k++) {
        const Balls *others = part_balls(c->parts + k);
        before += others ? others->count : 0;
    }
    before += (int)at;
    *column = n + before / 2;
    *number = before % 2;
    return 0;
}

/* Whether a part computes an output, of its `layout`, from its plane's place alone: behind its signals. */
static bool is_of_place(const Part *part, size_t output)
{
    const Layout *layout = &part->unit->layout;
    size_t first = 0;
    const size_t signals = part->place >= 0 ? part->unit->equations->signals(layout, &first) : 0;
    return part->place >= 0 && output >= layout->computed.first + 2 * signals;
}

/* Whether an output follows from the state in its part's memory, or from its plane's place, alone: also what the composite
   finds of the run. */
static bool is_of_state(const Composite *c, size_t reference)
{
    const Part *part = part_of(c, reference);
    const Unit *inner = part ? part->unit : NULL;
    if (reference >= c->results) {
        return true;
    }
    const size_t output = part ? reference - part->observed + inner->layout.computed.first : 0;
    if (part && part == c->motor) {
        return reference - part->observed >= SPEED_OF_MOTOR;
    }
    return part && (observed_number(part, reference) >= 0 || is_of_place(part, output)) &&
           !(inner->equations->is_torque && inner->equations->is_torque(inner, output));
}

/* What the outputs that are asked for follow from. */
static OutputKind kind_of(const Unit *unit, Output *plan)
{
    const Composite *c = unit->own;
    OutputKind kind = OUTPUTS_ARE_PLACES;
    size_t k;
    for (k = 0; k < unit->asked_count; k++) {
        if (kind == OUTPUTS_ARE_PLACES && find_place(c, unit->asked[k], &plan[k].column, &plan[k].number)) {
            kind = OUTPUTS_OF_STATE;
        }
        if (!is_of_state(c, unit->asked[k])) {
            return OUTPUTS_OF_SIGNALS;
        }
    }
    return kind;
}

bool one_piece_asks_results(const Unit *unit)
{
    const Composite *c = unit->own;
    size_t k;
    for (k = 0; k < unit->asked_count; k++) {
        if (unit->asked[k] >= c->results) {
            return true;
        }
    }
    return false;
}

OutputKind one_piece_outputs(Unit *unit)
{
    Pieces *pieces = &((Composite *)unit->own)->pieces;
    const size_t size = unit->asked_count * sizeof *unit->asked;
    if (!unit->asked || unit->for_model_exchange || unit->asked_count > pieces->most_planned) {
        return OUTPUTS_OF_SIGNALS;
    }
    if (pieces->planned != unit->asked_count || memcmp(pieces->planned_outputs, unit->asked, size)) {
        pieces->kind = kind_of(unit, pieces->plan);
        pieces->planned = unit->asked_count;
        memcpy(pieces->planned_outputs, unit->asked, size);
    }
    if (pieces->kind == OUTPUTS_ARE_PLACES && ((const Composite *)unit->own)->course->one_piece.stands > 0.0) {
        return OUTPUTS_OF_STATE; /* there is no step yet to take places from */
    }
    return pieces->kind;
}

int one_piece_observe_places(Unit *unit)
{
    const Pieces *pieces = &((const Composite *)unit->own)->pieces;
    const Output *plan = pieces->plan;
    size_t k;
    if (one_piece_places(unit, pieces->places)) {
        return 1;
    }
    for (k = 0; k < unit->asked_count; k++) {
        unit->real[unit->asked[k]] = pair_at(pieces->places[plan[k].column], plan[k].number);
    }
    return 0;
}

void one_piece_read_places(const Composite *c, const double *times, int count, double *values)
{
    const Pieces *pieces = &c->pieces;
    const Machine *m = &pieces->step;
    const int order = one_piece_order(c);
    double within[MOST_READ] = {0.0}, x[MOST_READ], y[MOST_READ];
    int column = -1, j;
    size_t k;
    for (j = 0; j < count; j++) {
        within[j] = one_piece_time(c, times[j]);
    }
    for (k = 0; k < pieces->planned; k++) {
        const Output *output = pieces->plan + k;
        const double *found = output->number ? y : x;
        double *value = values + k;
        if (output->column != column) {
            column = output->column;
            machine_places(m, column, order, within, count, x, y);
        }
        for (j = 0; j < count; j++, value += pieces->planned) {
            *value = found[j];
        }
    }
}
