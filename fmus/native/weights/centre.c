#include "weights/centre.h"

#include "base/elementary.h"

Instant find_instant(const CentreMotion *motion, double time)
{
    Instant now;
    cubic_at(motion->signal, time, now.motion);
    now.spin = spin_after(&motion->spin, time);
    return now;
}

void rotate_derivatives(Complex *derivatives, const Spin *spin, int against)
{
    const double sign = against ? -1.0 : 1.0;
    const double w = sign * spin->speed;
    const Complex turn = rect(1.0, -sign * spin->angle);
    const Complex value = derivatives[0], slope = derivatives[1];
    /* slope - i w value */
    derivatives[0] = complex_product(value, turn);
    derivatives[1] = complex_product(complex_of(slope.re + w * value.im, slope.im - w * value.re), turn);
}

void rotate_signal(CentreMotion *motion, double length)
{
    Instant ends[2];
    int k;
    for (k = 0; k < 2; k++) {
        ends[k] = find_instant(motion, k * length);
        rotate_derivatives(ends[k].motion, &ends[k].spin, 0);
    }
    cubic_between(ends[0].motion, ends[1].motion, length, motion->signal);
}
