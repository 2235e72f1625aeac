#include "weights/centre.h"

Instant find_instant(const CentreMotion *motion, double time)
{
    Instant now;
    cubic_at(motion->signal, time, now.motion);
    now.spin = spin_after(&motion->spin, time);
    return now;
}

void shift_signal(Complex *signal, int count, Complex offset, double speed, const double *spin_up)
{
    const double w = speed, w1 = spin_up[0], w2 = spin_up[1], w3 = spin_up[2], w4 = spin_up[3];
    const Complex whirls[SIGNAL_ORDERS] = { /* i w' - w^2 and its derivatives */
        {-w * w, w1},
        {-2.0 * w * w1, w2},
        {-2.0 * (w1 * w1 + w * w2), w3},
        {-6.0 * w1 * w2 - 2.0 * w * w3, w4}};
    int k;
    for (k = 0; k < count && (offset.re != 0.0 || offset.im != 0.0); k++) {
        signal[k] = complex_sum(signal[k], complex_product(whirls[k], offset));
    }
}
