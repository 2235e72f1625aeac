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

void series_weight_start(SeriesWeight *weight, Pair direction)
{
    weight->unit[0] = direction;
    weight->unit[1] = pair_times(pair_turned(weight->unit[0]), weight->rate[0]);
    weight->along = weight->unit[0];
}

#define WEIGHTS(name) series_weight_##name
#define Weights SeriesWeight
#define Numbers Number
#define NUMBERS(value) number_of(value)
#define Vectors Pair
#define VECTORS(name) pair_##name
#define OF_TRACK(pair) (pair)
#include "machine/weight_orders_template.h"
