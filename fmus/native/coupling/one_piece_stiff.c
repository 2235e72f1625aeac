/* Steps of stiff machines: by collocation, where such a step is worth many by series. */
#include "base/elementary.h"
#include "coupling/composite.h"

enum { FIRST_PATIENCE = 2, MOST_TRIES = 4 };
#define WORTH 11.0 /* steps by series that take as long as one by collocation, about */
#define SHORTENED 0.85 /* of a step whose error is too large, at most */

/* Take the longest step that keeps the tolerance, from this length on. */
static int take(const Unit *unit, double tried, double by_series)
{
    Composite *c = unit->own;
    OnePiece *one_piece = &c->course->one_piece;
    int k;
    one_piece_load_collocation(c, c->parts->unit->memory[REST]);
    for (k = 0; k < MOST_TRIES && tried >= WORTH * by_series; k++) {
        const double error = one_piece_solve(unit, smaller(tried, LONGEST_STEP));
        const double factor = collocation_factor(&c->pieces.collocation, error);
        if (error <= 1.0) {
            one_piece->collocated = smaller(tried, LONGEST_STEP);
            one_piece->next_length = smaller(tried * factor, LONGEST_STEP);
            return 1;
        }
        tried *= smaller(factor, SHORTENED);
    }
    return 0;
}

int one_piece_try_collocation(Unit *unit, double *length)
{
    Composite *c = unit->own;
    OnePiece *one_piece = &c->course->one_piece;
    const double least = WORTH * *length;
    double angle;
    bool is_wanted;
    if (one_piece->wait > 0.0) {
        one_piece->wait -= 1.0;
        return 0;
    }
    if (!is_finite(*length) || !(least < LONGEST_STEP)) {
        return 0;
    }
    if (!take(unit, larger(one_piece->next_length, least), *length)) {
        one_piece->next_length = 0.0;
        one_piece->patience = smaller(larger(FIRST_PATIENCE, 2.0 * one_piece->patience), MOST_PATIENCE);
        one_piece->wait = one_piece->patience;
        return 0;
    }
    one_piece->patience = 0.0;
    *length = one_piece->collocated;
    one_piece->order = c->pieces.is_eventful ? OF_POWERS : one_piece->order;
    /* from here on the key is that of the polynomial */
    if (one_piece_load_step(unit, &angle, &is_wanted)) {
        return 1;
    }
    one_piece_write_collocation(c);
    return 0;
}
