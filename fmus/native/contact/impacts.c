#include "contact/impacts.h"

#include "base/elementary.h"
#include "contact/groups.h"

#define LOWEST_BOUNCE 1e-9 /* rad: less than what the surfaces of real weights yield in contact */
#define EQUAL_RATES 1e-12  /* of the largest rate: rounding of the impact law */

static int closes(const WeightsInOrder *weights, int k, double soon)
{
    const double closing =
        weights->angle_rate[k] - weights->angle_rate[(k + 1) % weights->count];
    return closing > 0.0 && gap(weights, k) <= TOUCHING_ANGLE + soon * closing;
}

int approaching(const WeightsInOrder *weights, double soon)
{
    int k;
    if (!weights->track->solid || weights->track->full) {
        return 0;
    }
    for (k = 0; k < weights->count; k++) {
        if (!weights->joined[k] && closes(weights, k, soon)) {
            return 1;
        }
    }
    return 0;
}

void impact_add(Impact *impact, const WeightsInOrder *weights, int plane, int closed, double soon)
{
    const Track *track = weights->track;
    const int n = weights->count, first = impact->count;
    int k;
    for (k = 0; k < n; k++) {
        const int i = first + k;
        const double moment = weights->mass[k] * track->moment;
        const double inertia = track->weights.kappa * moment * track->weights.track_radius;
        impact->rate[i] = weights->angle_rate[k];
        impact->weights[i] = (ImpactWeight){plane, inertia, moment, weights->angle_rate[k],
                                            rect(1.0, weights->angle[k])};
    }
    impact->count += n;
    for (k = 0; k < n && track->solid; k++) {
        const int pair = impact->contacts;
        /* the last contact of a full track follows from the others */
        const int lasts = track->full && k < n - 1;
        if (lasts || (!track->full && (k == closed || weights->joined[k] ||
                                       gap(weights, k) <= TOUCHING_ANGLE || closes(weights, k, soon)))) {
            impact->pairs[pair].behind = first + k;
            impact->pairs[pair].ahead = first + (k + 1) % n;
            impact->pairs[pair].restitution = track_touch(track).restitution;
            impact->pairs[pair].lasting = lasts;
            impact->contacts++;
        }
    }
}

/* Accelerations of all weights with the contacts that are set, in weights->sides. */
static const double *accelerations_of(WeightsInOrder *weights, const Instant *now)
{
    const Runs *chains = &weights->chains;
    int i, j;
    find_chains(weights);
    for (i = 0; i < chains->count; i++) {
        const int first = chains->first[i], size = chains->size[i];
        fill_forcings(weights, first, size, now);
        pool_violators(&weights->pools, weights->forcings, weights->limits, weights->mass + first,
                       size, 0.0);
        expand_pools(&weights->pools, weights->forcings);
        for (j = 0; j < size; j++) {
            weights->sides[(first + j) % weights->count] = weights->forcings[j];
        }
    }
    return weights->sides;
}

/* Whether a pair that opens would come back after less than is followed. */
static bool bounces_low(const WeightsInOrder *weights, int k, const double *accelerations,
                        double opening)
{
    const double closing = accelerations[k] - accelerations[(k + 1) % weights->count];
    return opening > 0.0 && opening * opening <= 2.0 * closing * LOWEST_BOUNCE;
}

int impact_apply(Impact *impact, int first, WeightsInOrder *weights, const Instant *now)
{
    const int n = weights->count;
    const double rounding = EQUAL_RATES * largest_of(n, impact->rate + first);
    const double *accelerations;
    int pair, k, low = 0;
    for (k = 0; k < n; k++) {
        weights->angle_rate[k] = impact->rate[first + k];
        weights->joined[k] = weights->track->full;
    }
    for (pair = 0; pair < impact->contacts; pair++) {
        k = impact->pairs[pair].behind - first;
        if (k >= 0 && k < n && absolute(impact_opening(impact, pair)) <= rounding) {
            weights->joined[k] = 1;
        }
    }
    accelerations = accelerations_of(weights, now);
    for (pair = 0; pair < impact->contacts; pair++) {
        k = impact->pairs[pair].behind - first;
        if (k >= 0 && k < n && !weights->joined[k] &&
            bounces_low(weights, k, accelerations, impact_opening(impact, pair))) {
            impact->pairs[pair].lasting = true;
            low++;
        }
    }
    return low;
}

Complex collide_weights(WeightsInOrder *weights, const Instant *now, int closed)
{
    Impact impact = impact_begin(&weights->track->mobility, 1, weights->count, weights->impact);
    impact_add(&impact, weights, 0, closed, 0.0);
    do {
        if (impact_solve(&impact, weights->failure)) {
            return complex_of(0.0, 0.0);
        }
    } while (impact_apply(&impact, 0, weights, now));
    align_chains(weights);
    return impact_on_plane(&impact, 0);
}
