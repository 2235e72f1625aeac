#include "machine/weights_series.h"

#include "base/elementary.h"

void series_weight_take(SeriesWeight *made, const Weights *one, double per_rate)
{
    const double radius = one->track_radius;
    made->moment = number_of(one->mass * radius);
    made->share = number_of(one->mass / one->kappa);
    made->lever = number_of(weights_lever(one));
    made->damping_rate = number_of(weights_damping_rate(one) * per_rate);
    made->roll = number_of((one->kappa - 1.0) * (radius + one->radius));
    made->inertia = made->roll * one->mass * (radius + one->radius);
    made->torque = number_of(one->drag * radius * radius * per_rate);
}

void series_weight_start(SeriesWeight *weight, Number angle)
{
    weight->unit[0] = pair_direction(angle);
    weight->unit[1] = pair_times(pair_turned(weight->unit[0]), weight->rate[0]);
    weight->along = weight->unit[0];
}

/* Sums up to order k: of what turns p, and of what pulls along it.  Two each: one waits for the last one's end. */
typedef struct {
    Pair even, odd, along, across;
} Sums;

/* Of some weights at once. */
static IN_LINE void add_products(Sums *all, const SeriesWeight *weights, int count, const Pair *pull, int k, bool turns, bool pulls)
{
    int j, w;
    for (j = 0; j + 1 < k; j += 2) {
        for (w = 0; w < count; w++) {
            const Pair *unit = weights[w].unit + k, *rate = weights[w].rate;
            Sums *sums = all + w;
            if (turns) {
                sums->even = pair_add_by_both(sums->even, unit[1 - j], rate[j]);
                sums->odd = pair_add_by_both(sums->odd, unit[-j], rate[j + 1]);
            }
            if (pulls) {
                sums->along = pair_add_times(sums->along, pull[j], unit[-j]);
                sums->across = pair_add_times(sums->across, pull[j + 1], unit[-j - 1]);
            }
        }
    }
    for (w = 0; w < count && j < k; w++) {
        const Pair *unit = weights[w].unit + k;
        if (turns) {
            all[w].even = pair_add_by_both(all[w].even, unit[1 - j], weights[w].rate[j]);
        }
        if (pulls) {
            all[w].along = pair_add_times(all[w].along, pull[j], unit[-j]);
        }
    }
}

/* Im(a p*) is the sum of both numbers of (-i a) p. */
IN_LINE void series_weights_advance(SeriesWeight *weights, int count, int k, const Pair *pull, Pair known, const Number *speeds,
                                    Number carried)
{
    Sums all[MOST_TOGETHER];
    int w;
    for (w = 0; w < count; w++) {
        const Pair none = pair_zero();
        all[w].even = all[w].odd = all[w].across = none;
        all[w].along = pair_times(pair_turned_back(known), weights[w].unit[0]);
    }
#ifdef SIDE_BY_SIDE /* there are not registers for all */
    add_products(all, weights, count, pull, k, true, false);
    add_products(all, weights, count, pull, k, false, true);
#else
    add_products(all, weights, count, pull, k, true, true);
#endif
    for (w = 0; w < count; w++) {
        SeriesWeight *weight = weights + w;
        const Pair even = pair_add_by_both(all[w].even, weight->unit[1], weight->rate[k]);
        const Pair along = pair_sum(all[w].along, all[w].across);
        weight->turned = pair_scaled(pair_sum(even, all[w].odd), number_of(k + 1));
        weight->free = -weight->lever * ((pair_x(along) + pair_y(along)) - weight->roll * carried) -
                       weight->damping_rate * speeds[w];
    }
}

IN_LINE void series_weight_advance(SeriesWeight *weight, int k, const Pair *pull, Pair known, Number speed, Number carried)
{
    series_weights_advance(weight, 1, k, pull, known, &speed, carried);
}

IN_LINE Pair series_weight_force(const SeriesWeight *weight)
{
    const Pair moved = pair_add_scaled(weight->turned, weight->unit[0], weight->free);
    return pair_scaled(pair_turned_back(moved), weight->moment);
}

IN_LINE Number series_weight_pulled(const SeriesWeight *weight, Pair acceleration)
{
    const Pair along = pair_times(pair_turned_back(acceleration), weight->along);
    return pair_x(along) + pair_y(along);
}

IN_LINE void series_weight_finish(SeriesWeight *weight, int k, Number acceleration, const double *per)
{
    const Number second = number_of(per[0] * per[1]);
    weight->rate[k + 1] = pair_both(acceleration * per[0]);
    weight->unit[k + 2] =
        pair_scaled(pair_turned(pair_add_scaled(weight->turned, weight->unit[0], acceleration)), second);
}
