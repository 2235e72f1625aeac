#include "base/roots.h"

#include "base/cubic.h"
#include "base/elementary.h"

#define BRACKET_HALVINGS 40 /* down to rounding of the bracket */

/* Where in the bracket x1..x2 to look next: inverse quadratic if that is safe, else half. */
static double next_share(const double *x, const double *f, double edge)
{
    double share = 0.5, xi, phi;
    if (f[0] == f[2] || f[1] == f[2]) {
        return share;
    }
    xi = (x[0] - x[1]) / (x[2] - x[1]);
    phi = (f[0] - f[1]) / (f[2] - f[1]);
    if (phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi) {
        share = f[0] / (f[1] - f[0]) * f[2] / (f[1] - f[2]);
        share += (x[2] - x[0]) / (x[1] - x[0]) * f[0] / (f[2] - f[0]) * f[1] / (f[2] - f[1]);
    }
    return smaller(larger(share, edge), 1.0 - edge);
}

double find_crossing(TimeFunction value, void *context, double begin, double upper, double width)
{
    double x[3] = {upper, 0.0, 0.0}, f[3] = {0.0, begin, 0.0}; /* the last two, one before */
    double share = 0.5;
    int k;
    f[0] = value(context, upper);
    if (begin <= 0.0) { /* it has just started at 0: go back to where it is positive still */
        for (k = 0; k < BRACKET_HALVINGS; k++) {
            x[1] = 0.5 * x[0];
            f[1] = value(context, x[1]);
            if (f[1] > 0.0 || f[1] != f[1]) {
                break;
            }
            x[0] = x[1];
            f[0] = f[1];
        }
        if (k == BRACKET_HALVINGS) {
            return x[0];
        }
    }
    while (absolute(x[1] - x[0]) > width) {
        const double at = x[0] + share * (x[1] - x[0]);
        const double there = value(context, at);
        if (there != there) {
            return at;
        }
        if ((there < 0.0) == (f[0] < 0.0)) {
            x[2] = x[0];
            f[2] = f[0];
        } else {
            x[2] = x[1];
            f[2] = f[1];
            x[1] = x[0];
            f[1] = f[0];
        }
        x[0] = at;
        f[0] = there;
        share = next_share(x, f, 0.5 * width / larger(absolute(x[1] - x[0]), width));
    }
    return f[0] < 0.0 ? x[0] : x[1];
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
