#include "contact.h"

#include <stddef.h>

#include "elementary.h"

#define SWEEPS_PER_WEIGHT 8 /* a blow passes one contact a sweep; what still goes on collapses */
#define WEAKEST 1e-4 /* of the largest difference of rates: blows below end without rebound */
#define NO_APPROACH 1e-12 /* the same with e = 1, where nothing dies out: rounding only */

double group_factor(int count, double alpha)
{
    if (count == 1 || alpha == 0.0) {
        return 1.0;
    }
    return sine(count * alpha) / (count * sine(alpha));
}

void pressure_factors(int count, double alpha, Complex *factors)
{
    Complex total = {0.0, 0.0}, mean = total;
    int k;
    for (k = 0; k < count; k++) {
        mean = complex_sum(mean, rect(1.0, -(2 * k - count + 1) * alpha));
    }
    mean = complex_of(mean.re / count, mean.im / count);
    for (k = 0; k < count - 1; k++) {
        const Complex unit = rect(1.0, -(2 * k - count + 1) * alpha);
        total = complex_sum(total, complex_difference(unit, mean));
        factors[k] = total;
    }
}

/* Least of (y - g)^2/2 + f |y|. */
static double shrunk(double drive, double limit)
{
    return larger(drive - limit, 0.0) + smaller(drive + limit, 0.0);
}

void pool(Pools *pools, const double *drives, const double *limits, int length, double slack)
{
    int count = 0, k;
    for (k = 0; k < length; k++) {
        int first = k, size = 1;
        double drive = drives[k], limit = limits ? limits[k] : 0.0;
        double value = shrunk(drive, limit);
        while (count && pools->value[count - 1] >= value - slack) {
            count--;
            first = pools->first[count];
            size += pools->size[count];
            drive = pools->drive[count] + drive;
            limit = pools->limit[count] + limit;
            value = shrunk(drive, limit) / size;
        }
        pools->first[count] = first;
        pools->size[count] = size;
        pools->drive[count] = drive;
        pools->limit[count] = limit;
        pools->value[count] = value;
        count++;
    }
    pools->count = count;
}

void expand(const Pools *pools, double *values)
{
    int i, k;
    for (i = 0; i < pools->count; i++) {
        for (k = pools->first[i]; k < pools->first[i] + pools->size[i]; k++) {
            values[k] = pools->value[i];
        }
    }
}

/* Turn round all runs of weights each of which approaches the next; 0: there was none. */
static int rebound(double *rates, int length, double restitution, double tiny)
{
    int struck = 0, k = 0, j;
    while (k < length - 1) {
        const int first = k;
        while (k < length - 1 && rates[k] - rates[k + 1] > tiny) {
            k++;
        }
        k++;
        if (k - first > 1) {
            double mean = 0.0;
            for (j = first; j < k; j++) {
                mean += rates[j];
            }
            mean /= k - first;
            for (j = first; j < k; j++) {
                rates[j] = (1.0 + restitution) * mean - restitution * rates[j];
            }
            struck = 1;
        }
    }
    return struck;
}

void collide(double *rates, int length, double restitution, Pools *pools)
{
    double largest = rates[0], least = rates[0], tiny;
    int sweeps = restitution > 0.0 ? SWEEPS_PER_WEIGHT * length : 0, k;
    for (k = 1; k < length; k++) {
        largest = larger(largest, rates[k]);
        least = smaller(least, rates[k]);
    }
    tiny = (restitution == 1.0 ? NO_APPROACH : WEAKEST) * (largest - least);
    while (sweeps && rebound(rates, length, restitution, tiny)) {
        sweeps--;
    }
    unite(rates, length, pools);
}

void unite(double *rates, int length, Pools *pools)
{
    int k, approach = 0;
    for (k = 0; k < length - 1; k++) {
        if (rates[k] > rates[k + 1]) {
            approach = 1;
        }
    }
    if (approach) {
        pool(pools, rates, NULL, length, 0.0);
        expand(pools, rates);
    }
}

Complex strike(double moment, int count, const double *angles, const double *changes)
{
    Complex rate = {0.0, 0.0};
    int k;
    for (k = 0; k < count; k++) {
        rate = complex_sum(rate, complex_scaled(changes[k], rect(1.0, angles[k])));
    }
    return complex_of(moment * rate.im, -moment * rate.re);
}
