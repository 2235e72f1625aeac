#include "weights/weights.h"

#include <stddef.h>

#include "base/elementary.h"

Weights weights_single(const Weights *weights, int k)
{
    const int n = weights->count;
    Weights one = *weights;
    one.count = 1;
    one.each = NULL;
    if (weights->each) {
        one.mass *= weights->each[k];
        one.drag *= weights->each[n + k];
        one.radius *= weights->each[2 * n + k];
    }
    return one;
}

double weights_mass_ratio(const Weights *weights, int k)
{
    return weights->each ? weights->each[k] : 1.0;
}

double weights_added_mass(const Weights *weights)
{
    return weights->each ? weights->mass * sum_of(weights->each, weights->count)
                         : weights->count * weights->mass;
}

double weights_lever(const Weights *weights)
{
    return 1.0 / (weights->kappa * weights->track_radius);
}

double weights_damping_rate(const Weights *weights)
{
    return weights->drag / (weights->kappa * weights->mass);
}

/* e^{i theta} of the k-th weight. */
static Complex unit_of(Turned *turned, const double *angles, int k)
{
    return turned_by(turned ? turned + 2 * k : NULL, angles[k]);
}

/* rho at an angle [m]. */
static double track_radius_at(const Weights *weights, double angle)
{
    double rho = weights->track_radius;
    int n;
    for (n = 0; n < weights->lobes; n++) {
        const double *lobe = weights->lobe + 3 * n;
        rho += lobe[1] * rect(1.0, lobe[0] * (angle - lobe[2])).re;
    }
    return rho;
}

Complex weights_static_moment(const Weights *weights, const double *angles, Turned *turned)
{
    Complex sum = {0.0, 0.0};
    int k;
    for (k = 0; k < weights->count; k++) {
        const Complex unit = unit_of(turned, angles, k);
        double share = weights_mass_ratio(weights, k);
        if (weights->lobes) {
            share *= track_radius_at(weights, angles[k]) / weights->track_radius;
        }
        sum = complex_sum(sum, complex_scaled(share, unit));
    }
    return complex_scaled(weights->mass * weights->track_radius, sum);
}

double weights_alignment(int count, const double *angles, Turned *turned)
{
    Complex sum = {0.0, 0.0};
    int k;
    for (k = 0; k < count; k++) {
        const Complex unit = unit_of(turned, angles, k);
        sum = complex_sum(sum, complex_product(unit, unit));
    }
    return magnitude(sum) / count;
}
