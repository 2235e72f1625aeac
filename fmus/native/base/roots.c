#include "base/roots.h"

#include "base/cubic.h"
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

double find_lowest(double f0, double s0, double f1, double s1, double step)
{
    double second, third, root, time, least;
    const double doubt = 0.1 * step * (absolute(s0) + absolute(s1)); /* it is no better than this */
    hermite(f0, s0, f1, s1, step, &second, &third);
    root = square_root(larger(0.0, second * second - 2.0 * s0 * third));
    time = second + root > 0.0 ? -2.0 * s0 / (second + root) : 0.0;
    least = f0 + time * (s0 + time * (second / 2.0 + time * third / 6.0));
    return 0.0 < time && time < step && least < doubt ? time : 0.0;
}
