/* What is watched as the motion in one piece goes on. */
#include "base/elementary.h"
#include "base/matrix.h"
#include "constants.h"
#include "coupling/composite.h"

bool one_piece_is_unwatched(const Unit *unit)
{
    return unit->asked && !((const Composite *)unit->own)->pieces.is_watched && !one_piece_asks_results(unit);
}

int one_piece_place_followers(Unit *unit, const double *place, double time)
{
    const Composite *c = unit->own;
    const Rotor *rotor = composite_rotor(c);
    int k;
    for (k = 1; k < c->parts_without_motor; k++) {
        const Part *part = c->parts + k;
        if (part->place >= 0) {
            combine_vectors(rotor->rotor.planes + part->plane * rotor->stations, 1, rotor->stations, place,
                            part->unit->real + part->place);
            part->unit->time = time;
            part->unit->start = unit->start;
            if (part->unit->equations->outputs(part->unit)) {
                return composite_part_failed(unit, part);
            }
        }
    }
    return 0;
}

/* Look at the motion at a time in the step, in the machine's, where the rotor has turned so far since the last look;
   1 with the reason. */
static int look_at_time(Unit *unit, double now, double turned)
{
    Composite *c = unit->own;
    const Machine *m = &c->pieces.step;
    double *place = c->pieces.looked_at;
    int i;
    for (i = 0; i < m->stations - m->waves; i++) {
        const Pair displacement = machine_place(m, i, one_piece_order(c), now);
        place[2 * i] = pair_x(displacement);
        place[2 * i + 1] = pair_y(displacement);
    }
    verdict_look(c, place, turned);
    return c->pieces.followers && one_piece_place_followers(unit, place, c->course->clock.begin + now * m->per_rate);
}

int one_piece_look_on(Unit *unit, double time)
{
    const Composite *c = unit->own;
    const Clock *clock = &c->course->clock;
    OnePiece *one_piece = &c->course->one_piece;
    const Machine *m = &c->pieces.step;
    const double apart = clock->length / one_piece->looks;
    double turned;
    int order;
    if (one_piece->looked >= one_piece->looks ||
        !(clock->begin + (one_piece->looked + 1.0) * apart <= time)) {
        return 0;
    }
    if (one_piece_expand(unit)) {
        return 1;
    }
    order = one_piece_order(c);
    turned = machine_turned(m, order, one_piece->looked * apart * m->rate);
    while (one_piece->looked < one_piece->looks &&
           clock->begin + (one_piece->looked + 1.0) * apart <= time) {
        const double now = ++one_piece->looked * apart * m->rate,
                     angle = machine_turned(m, order, now);
        if (look_at_time(unit, now, angle - turned)) {
            return 1;
        }
        turned = angle;
    }
    return 0;
}

int one_piece_look_here(Unit *unit)
{
    const Composite *c = unit->own;
    const Clock *clock = &c->course->clock;
    const OnePiece *one_piece = &c->course->one_piece;
    const Machine *m = &c->pieces.step;
    const double now = one_piece_time(c, clock->shown), last = clock->length * m->rate * one_piece->looked / one_piece->looks;
    int order;
    if (one_piece->looked >= one_piece->looks || !(now > last)) {
        return 0;
    }
    if (one_piece_expand(unit)) {
        return 1;
    }
    order = one_piece_order(c);
    return look_at_time(unit, now, machine_turned(m, order, now) - machine_turned(m, order, last));
}

int one_piece_show(Unit *unit, double time)
{
    const Composite *c = unit->own;
    Course *course = c->course;
    if (course->one_piece.stands > 0.0) { /* there, but for a rounding */
        return 0;
    }
    course->clock.within = 1.0;
    course->clock.shown = time;
    course->one_piece.placed = 0.0;
    return one_piece_look_on(unit, time);
}
