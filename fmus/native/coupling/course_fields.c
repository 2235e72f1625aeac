/* The table of fields of a composite's state: in the order of composite_memory, structs as in composite.h. */
#include <float.h>

#include "base/elementary.h"
#include "constants.h"
#include "coupling/composite.h"

static void declare_clock(Fields *fields)
{
    const Clock *clock = fields_here(fields);
    fields_flag(fields, "clock.started", &clock->started);
    fields_number(fields, "clock.begin, .time", &clock->begin, 2);
    fields_within(fields, "clock.length", &clock->length, 1, 0.0, DBL_MAX);
    fields_flag(fields, "clock.within", &clock->within);
    fields_number(fields, "clock.shown", &clock->shown, 1);
}

static void declare_drive(Fields *fields, const Composite *c)
{
    const DriveSignal *drive = fields_here(fields);
    fields_number(fields, "drive.set_at, .speed, .acceleration", &drive->set_at, 3);
    fields_within(fields, "drive.fastest", &drive->fastest, 1, DBL_MIN, DBL_MAX);
    fields_number(fields, "drive.first_speed, .first_acceleration", &drive->first_speed, 2);
    fields_number(fields, "drive.pushed_at, .next_corner", &drive->pushed_at, 2);
    fields_whole(fields, "drive.passed", &drive->passed, 1, 0.0, (double)c->corner_count + 1.0);
    fields_number(fields, "drive.next_change", &drive->next_change, 1);
    fields_whole(fields, "drive.changes_behind", &drive->changes_behind, 1, 0.0,
                 (double)c->change_count);
}

static void declare_one_piece(Fields *fields, const Composite *c)
{
    const OnePiece *one_piece = fields_here(fields);
    const double last_line = c->motor ? c->motor->unit->layout.sizes.points - 2.0 : 0.0;
    const Sizes *rotor = &c->parts->unit->layout.sizes;
    const double last_of_table = rotor->tables ? rotor->speeds - 2.0 : 0.0;
    const double weights = (double)one_piece_phase_doubles(c) / PHASE_OF_WEIGHT;
    fields_whole(fields, "one_piece.order", &one_piece->order, 1, 0.0, MOST_ORDER);
    fields_within(fields, "one_piece.fastest", &one_piece->fastest, 1, DBL_MIN, DBL_MAX);
    fields_flag(fields, "one_piece.stands", &one_piece->stands);
    fields_within(fields, "one_piece.largest", &one_piece->largest, 1, 0.0, DBL_MAX);
    fields_number(fields, "one_piece.speed, .acceleration, .pushed", &one_piece->speed, 3);
    fields_whole(fields, "one_piece.changes_behind", &one_piece->changes_behind, 1, 0.0,
                 (double)c->change_count);
    fields_whole(fields, "one_piece.line", &one_piece->line, 1, -1.0, last_line);
    fields_whole(fields, "one_piece.bearing_line", &one_piece->bearing_line, 1, 0.0, last_of_table);
    fields_flag(fields, "one_piece.placed", &one_piece->placed);
    fields_whole(fields, "one_piece.looks, .looked", &one_piece->looks, 2, 0.0, MOST_LOOKS);
    fields_whole(fields, "one_piece.event", &one_piece->event, 1, 0.0, EVENT_KINDS - 1.0);
    fields_whole(fields, "one_piece.which", &one_piece->which, 1, 0.0, weights + 2.0 * rotor->sliders + rotor->cubics + rotor->stops);
    fields_flag(fields, "one_piece.decided", &one_piece->decided);
    fields_flag(fields, "one_piece.undecided", &one_piece->undecided);
    fields_whole(fields, "one_piece.leaves", &one_piece->leaves, 1, -1.0, 1.0);
    fields_within(fields, "one_piece.collocated, .next_length", &one_piece->collocated, 2, 0.0, LONGEST_STEP);
    fields_whole(fields, "one_piece.collocated_steps", &one_piece->collocated_steps, 1, 0.0, MOST_COUNTED);
    fields_whole(fields, "one_piece.crowded", &one_piece->crowded, 1, 0.0, MOST_CROWDED);
    fields_whole(fields, "one_piece.wait, .patience", &one_piece->wait, 2, 0.0, MOST_PATIENCE);
}

static void declare_course(Fields *fields, const Composite *c)
{
    const Course *course = fields_here(fields);
    declare_clock(fields);
    declare_drive(fields, c);
    fields_whole(fields, "total.steps, .passes", &course->total.steps, 2, 0.0, MOST_COUNTED);
    fields_within(fields, "total.error", &course->total.error, 1, 0.0, DBL_MAX);
    fields_within(fields, "vibration", &course->vibration.last, 2, 0.0, DBL_MAX);
    fields_flag(fields, "vibration.drifts", &course->vibration.drifts);
    declare_one_piece(fields, c);
}

/* States of all parts, as they lie behind each other. */
static void declare_states(Fields *fields, const Composite *c)
{
    int k;
    for (k = 0; k < c->part_count; k++) {
        const Unit *part = c->parts[k].unit;
        fields->owner = part->name;
        if (part->equations->fields) {
            part->equations->fields(part, fields);
        }
    }
    fields->owner = NULL;
}

/* Variables of a part: its parameters are those of the composite, but for the unbalance, which changes set. */
static void declare_values(Fields *fields, const Part *part)
{
    const Layout *layout = &part->unit->layout;
    const double *real = fields_here(fields);
    fields->owner = part->unit->name;
    if (part->unit->equations == &ROTOR_EQUATIONS) {
        fields_number(fields, "parameter", real, layout->parameters.count);
    } else {
        fields_same(fields, "parameter", real, layout->parameters.count, fields->real + part->first);
    }
    fields_number(fields, "input", real + layout->inputs.first, layout->inputs.count);
    fields_any(fields, fields_here(fields), layout->real_count - layout->computed.first);
    fields->owner = NULL;
}

void composite_fields(const Unit *unit, Fields *fields)
{
    const Composite *c = unit->own;
    int k;
    declare_course(fields, c);
    fields_number(fields, "force from outside", fields_here(fields), outside_count(c));
    declare_states(fields, c);
    fields_number(fields, "extent", fields_here(fields), verdict_doubles(c));
    fields_number(fields, "force at the start of a step", fields_here(fields), outside_count(c));
    fields_whole(fields, "way and wall of a weight", fields_here(fields), one_piece_phase_doubles(c), -1.0, 1.0);
    declare_states(fields, c);
    for (k = 0; k < c->part_count; k++) {
        declare_values(fields, c->parts + k);
    }
}
