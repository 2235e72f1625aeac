#include "contact/contact.h"

#include <stddef.h>

#include "base/elementary.h"

double group_factor(int count, double alpha)
{
    if (count == 1 || alpha == 0.0) {
        return 1.0;
    }
    return sine(count * alpha) / (count * sine(alpha));
}

/* Least of (y - g)^2/2 + f |y|. */
static double shrunk(double forcing, double limit)
{
    return larger(forcing - limit, 0.0) + smaller(forcing + limit, 0.0);
}

void pool_violators(Pools *pools, const double *forcings, const double *limits,
                    const double *masses, int length, double slack)
{
    int count = 0, k;
    for (k = 0; k < length; k++) {
        int first = k, size = 1;
        double forcing = forcings[k], limit = limits ? limits[k] : 0.0;
        double mass = masses ? masses[k] : 1.0, value = shrunk(forcing, limit) / mass;
        while (count && pools->value[count - 1] >= value - slack) {
            count--;
            first = pools->first[count];
            size += pools->size[count];
            forcing = pools->forcing[count] + forcing;
            limit = pools->limit[count] + limit;
            mass = pools->mass[count] + mass;
            value = shrunk(forcing, limit) / mass;
        }
        pools->first[count] = first;
        pools->size[count] = size;
        pools->forcing[count] = forcing;
        pools->limit[count] = limit;
        pools->mass[count] = mass;
        pools->value[count] = value;
        count++;
    }
    pools->count = count;
}

void expand_pools(const Pools *pools, double *values)
{
    int i, k;
    for (i = 0; i < pools->count; i++) {
        for (k = pools->first[i]; k < pools->first[i] + pools->size[i]; k++) {
            values[k] = pools->value[i];
        }
    }
}
