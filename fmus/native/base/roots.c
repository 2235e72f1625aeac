#include "base/roots.h"

#include "base/elementary.h"

#define BRACKET_HALVINGS 40 /* down to rounding of the bracket */

/* A time and the function's value there. */
typedef struct {
    double x, f;
} Sample;

/* Where between the newest sample and the opposite one to look next, as a share of the way
   (Chandrupatla 1997): inverse quadratic interpolation where it is safe, else the middle. */
static double next_share(Sample newest, Sample opposite, Sample last, double edge)
{
    double share = 0.5, xi, phi;
    if (newest.f == last.f || opposite.f == last.f) {
        return share;
    }
    xi = (newest.x - opposite.x) / (last.x - opposite.x);
    phi = (newest.f - opposite.f) / (last.f - opposite.f);
    if (phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi) {
        share = newest.f / (opposite.f - newest.f) * last.f / (opposite.f - last.f);
        share += (last.x - newest.x) / (opposite.x - newest.x) * newest.f / (last.f - newest.f) * opposite.f
                 / (last.f - opposite.f);
    }
    return smaller(larger(share, edge), 1.0 - edge);
}

double find_crossing(TimeFunction value, void *context, double value_at_start, double upper,
                     double width)
{
    /* the crossing lies between the newest sample and the opposite one; the last is outside */
    Sample newest = {0.0, 0.0}, opposite = {0.0, 0.0}, last = {0.0, 0.0};
    double share = 0.5;
    int k;
    newest.x = upper;
    newest.f = value(context, upper);
    opposite.f = value_at_start;
    if (value_at_start <= 0.0) { /* it has just started at 0: go back to where it is positive still */
        for (k = 0; k < BRACKET_HALVINGS; k++) {
            opposite.x = 0.5 * newest.x;
            opposite.f = value(context, opposite.x);
            if (opposite.f > 0.0 || opposite.f != opposite.f) {
                break;
            }
            newest = opposite;
        }
        if (k == BRACKET_HALVINGS) {
            return newest.x;
        }
    }
    while (absolute(opposite.x - newest.x) > width) {
        Sample next;
        next.x = newest.x + share * (opposite.x - newest.x);
        next.f = value(context, next.x);
        if (next.f != next.f) {
            return next.x;
        }
        if ((next.f < 0.0) == (newest.f < 0.0)) {
            last = newest;
        } else {
            last = opposite;
            opposite = newest;
        }
        newest = next;
        share = next_share(newest, opposite, last,
                           0.5 * width / larger(absolute(opposite.x - newest.x), width));
    }
    return newest.f < 0.0 ? newest.x : opposite.x;
}
