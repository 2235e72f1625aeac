/* The rotor with the unbalance that changes leave. */
#include <string.h>

#include "base/elementary.h"
#include "coupling/composite.h"

/* Among the rotor's parameters, where the amount of the unbalance that a change is of stands, and behind it
   its angle. */
static size_t changed_amount(const Composite *c, const double *change)
{
    const Layout *layout = &c->parts->unit->layout;
    const size_t alone = layout_index(layout, "unbalance", 1);
    const size_t first = alone < layout->real_count ? alone : layout_index(layout, "unbalance[#].amount", 1);
    /* amount and angle of each, behind its position where it has one */
    const size_t stride = rotor_kind(layout) == MATRICES ? 2 : 3;
    return first + stride * ((size_t)change[CHANGE_NUMBER] - 1);
}

void composite_give_parameters(Unit *unit, const Part *part)
{
    Unit *own = part->unit;
    memcpy(own->real, unit->real + part->first, own->layout.parameters.count * sizeof(double));
}

int composite_refuse_number(Unit *unit, double number)
{
    const int most = composite_rotor(unit->own)->unbalances;
    return !(number >= 1.0 && number <= most && number == nearest(number)) &&
           unit_fail(unit, "unbalance_change[k].number: must be that of an unbalance of the "
                     "rotor, from 1");
}

int composite_follow_changes(Unit *unit)
{
    Composite *c = unit->own;
    Unit *rotor = c->parts->unit;
    const size_t behind = (size_t)c->course->drive.changes_behind;
    const double *change = unit->real + c->changes;
    size_t k;
    if (c->made_with == behind) {
        return 0;
    }
    composite_give_parameters(unit, c->parts);
    for (k = 0; k < behind; k++, change += CHANGE_VALUES) {
        if (composite_refuse_number(unit, change[CHANGE_NUMBER])) {
            return 1;
        }
        memcpy(rotor->real + changed_amount(c, change), change + CHANGE_AMOUNT, 2 * sizeof(double));
    }
    if (rotor->equations->parameters(rotor)) {
        return composite_part_failed(unit, c->parts);
    }
    c->made_with = behind;
    c->pieces.is_made = false;
    return 0;
}

int composite_untunable(Unit *unit, size_t reference)
{
    const Composite *c = unit->own;
    const double *change = unit->real + c->changes;
    size_t k;
    for (k = 0; k < (size_t)c->course->drive.changes_behind; k++, change += CHANGE_VALUES) {
        if (reference - c->parts->first - changed_amount(c, change) < 2) {
            layout_name(&unit->layout, reference, unit_reason(unit));
            text_format(&unit->reason, ": unbalance_change[%u] has set it at t = %6 s; set it before, or leave "
                        "out the change", (unsigned long)k + 1, unit_host_time(unit, *change));
            return 1;
        }
    }
    return 0;
}
