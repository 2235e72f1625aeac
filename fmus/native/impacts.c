#include "impacts.h"

#include "elementary.h"
#include "groups.h"
#include "matrix.h"

#define LOWEST_BOUNCE 1e-9 /* rad: less than what the surfaces of real weights yield in contact */

int approaching(const WeightsInOrder *weights)
{
    const int n = weights->count;
    const double *rate = weights->angle_rate;
    int k;
    if (!weights->track->solid || weights->track->full) {
        return 0;
    }
    for (k = 0; k < n; k++) {
        if (rate[k] > rate[(k + 1) % n] && !weights->joined[k] && gap(weights, k) <= TOUCH) {
            return 1;
        }
    }
    return 0;
}

/* Set `accelerations` of a chain's weights with the contacts that are set. */
static void fill_accelerations(WeightsInOrder *weights, int first, int size, const Instant *now,
                               double angular_acceleration)
{
    const int n = weights->count;
    int begin = 0, j;
    for (j = 0; j < size; j++) {
        if (j == size - 1 || !weights->joined[(first + j) % n]) {
            const int length = j + 1 - begin;
            fill_drives(weights, (first + begin) % n, length, now, angular_acceleration);
            pool(&weights->pools, weights->drives, weights->limits, length, 0.0);
            expand(&weights->pools, weights->accelerations + begin);
            begin = j + 1;
        }
    }
}

/* The first weight of a chain that bounces off the next too low; -1: none. */
static int lowest_bounce(int size, const double *rates, const double *accelerations)
{
    int j;
    for (j = 0; j < size - 1; j++) {
        const double opening = rates[j + 1] - rates[j];
        const double closing = accelerations[j] - accelerations[j + 1];
        if (opening > 0.0 && opening * opening <= 2.0 * closing * LOWEST_BOUNCE) {
            return j;
        }
    }
    return -1;
}

/* Unite the weights `low` and `low` + 1 of a chain, with all that move alike. */
static void merge(int size, double *rates, int low, Pools *pools)
{
    int first = low, last = low + 1, j;
    double mean = 0.0;
    while (first > 0 && rates[first - 1] == rates[low]) {
        first--;
    }
    while (last < size - 1 && rates[last + 1] == rates[low + 1]) {
        last++;
    }
    for (j = first; j <= last; j++) {
        mean += rates[j];
    }
    mean /= last + 1 - first;
    for (j = first; j <= last; j++) {
        rates[j] = mean;
    }
    unite(rates, size, pools);
}

/* Set the rates and contacts of a chain; too low bounces are taken for contact. */
static void capture(WeightsInOrder *weights, int first, int size, const Instant *now,
                    double angular_acceleration)
{
    const int n = weights->count;
    double *rates = weights->rates;
    int round, j, low;
    for (round = 0; round < size; round++) {
        for (j = 0; j < size; j++) {
            weights->angle_rate[(first + j) % n] = rates[j];
        }
        for (j = 0; j < size - 1; j++) {
            weights->joined[(first + j) % n] = rates[j + 1] == rates[j];
        }
        fill_accelerations(weights, first, size, now, angular_acceleration);
        low = lowest_bounce(size, rates, weights->accelerations);
        if (low < 0) {
            return;
        }
        merge(size, rates, low, &weights->pools);
    }
}

Complex settle(WeightsInOrder *weights, const Instant *now, double angular_acceleration, int closed)
{
    const int n = weights->count;
    const Runs *chains = &weights->chains;
    double *before = weights->before;
    Complex blow = {0.0, 0.0};
    int i, j, k, any = 0;
    for (k = 0; k < n; k++) {
        weights->linked[k] = k == closed || weights->joined[k] || gap(weights, k) <= TOUCH;
    }
    copy_doubles((size_t)n, weights->angle_rate, before);
    find_chains(weights, weights->linked);
    for (i = 0; i < chains->count; i++) {
        const int first = chains->first[i], size = chains->size[i];
        if (size > 1) {
            for (j = 0; j < size; j++) {
                weights->rates[j] = weights->angle_rate[(first + j) % n];
            }
            collide(weights->rates, size, weights->track->restitution, &weights->pools);
            capture(weights, first, size, now, angular_acceleration);
        }
    }
    for (k = 0; k < n; k++) {
        before[k] = weights->angle_rate[k] - before[k]; /* the change */
        any |= before[k] != 0.0;
    }
    if (any) {
        blow = strike(weights->track->moment, n, weights->angle, before);
    }
    align(weights);
    return blow;
}
