/* Steps of smooth motion that follow each other while the machine stays in its lane: nothing comes out of it but the
   places that are asked for.

   The course goes on as with steps that are taken alone; the memories of the parts, apart from the rotor's angle, are
   written where the machine leaves. */
#include "base/elementary.h"
#include "coupling/composite.h"

bool one_piece_is_smooth(Unit *unit)
{
    const Composite *c = unit->own;
    const Pieces *pieces = &c->pieces;
    const size_t forces = outside_count(c);
    size_t k;
    for (k = 0; k < forces; k++) {
        if (pieces->begun_forces[k] != 0.0) {
            return false;
        }
    }
    return !c->motor && !pieces->is_stiff && one_piece_is_unwatched(unit) &&
           one_piece_outputs(unit) == OUTPUTS_ARE_PLACES;
}

bool one_piece_take_smooth(Unit *unit, double length, double until)
{
    const Composite *c = unit->own;
    OnePiece *one_piece = &c->course->one_piece;
    Clock *clock = &c->course->clock;
    const Clock before = *clock;
    const double looks = one_piece_choose_looks(c, length);
    clock->time = before.begin + length * c->pieces.step.per_rate;
    clock->length = clock->time - before.begin; /* rounded as the time is */
    if (!(clock->time > before.begin) || one_piece_is_crowded(c) || !(looks <= MOST_LOOKS) ||
        composite_reaches(c, smaller(until, composite_next_jump(c)))) {
        *clock = before;
        return false;
    }
    one_piece->looks = one_piece->looked = looks;
    one_piece->crowded = 0.0;
    one_piece_count_step(unit);
    return true;
}

bool one_piece_next_smooth(Unit *unit, double largest, double fastest)
{
    const Composite *c = unit->own;
    OnePiece *one_piece = &c->course->one_piece;
    Clock *clock = &c->course->clock;
    one_piece_stand_smooth(c, clock->length * c->pieces.step.rate);
    c->course->total.passes += 1.0;
    if (one_piece_is_too_fast(c, fastest)) {
        return false;
    }
    clock->begin = clock->time;
    one_piece->largest = larger(one_piece->largest, largest);
    one_piece->speed = composite_speed(c, clock->time);
    c->pieces.step.speed[0] = one_piece->speed * c->pieces.step.per_rate;
    return true;
}

void one_piece_leave_smooth(Unit *unit, bool has_moved)
{
    Composite *c = unit->own;
    OnePiece *one_piece = &c->course->one_piece;
    if (has_moved) {
        one_piece_stand_as_loaded(c);
    }
    c->pieces.key[0] = not_a_number(); /* there is no series of it: */
    c->course->total.passes -= 1.0;    /* that is counted when it is made */
    one_piece->stands = one_piece->placed = 1.0;
}
