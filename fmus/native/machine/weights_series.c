#include "machine/weights_series.h"

#include "base/elementary.h"

void series_weight_start(SeriesWeight *weight, double angle)
{
    const Complex unit = rect(1.0, angle);
    weight->unit[0] = pair_of(unit.re, unit.im);
    weight->unit[1] = pair_turned(weight->unit[0]) * weight->rate[0];
}

/* Im(a p*) is the sum of both numbers of (-i a) p. */
void series_weight_advance(SeriesWeight *weight, int k, const Pair *pull, Pair known, double speed, double carried)
{
    const Pair *unit = weight->unit + k, *rate = weight->rate;
    const Pair none = {0.0, 0.0};
    Pair even = none, odd = none, along = pair_turned_back(known) * weight->unit[0], across = none;
    int j;
    for (j = 0; j + 1 < k; j += 2) { /* two sums each: one waits for the last one's end */
        even += unit[1 - j] * rate[j];
        along += pull[j] * unit[-j];
        odd += unit[-j] * rate[j + 1];
        across += pull[j + 1] * unit[-j - 1];
    }
    if (j < k) {
        even += unit[1 - j] * rate[j];
        along += pull[j] * unit[-j];
        j++;
    }
    even += unit[1 - j] * rate[j];
    along += across;
    weight->turned = (even + odd) * pair_both(k + 1);
    weight->free = -weight->lever * ((along[0] + along[1]) - weight->roll * carried) -
                   weight->damping_rate * speed;
}

Pair series_weight_force(const SeriesWeight *weight)
{
    return pair_turned_back(weight->turned + weight->unit[0] * pair_both(weight->free)) *
           pair_both(weight->moment);
}

void series_weight_finish(SeriesWeight *weight, int k, double acceleration, const double *per)
{
    const double second = per[0] * per[1];
    weight->rate[k + 1] = pair_both(acceleration * per[0]);
    weight->unit[k + 2] =
        pair_turned(weight->turned + weight->unit[0] * pair_both(acceleration)) * pair_both(second);
}
