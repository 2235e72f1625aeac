#include "contact/ring.h"

#include "base/elementary.h"
#include "base/matrix.h"
#include "constants.h"
#include "contact/spacing.h"

#define OVERLAP 1e-7  /* rad: of a start; rounding of angles after a million turns stays below */
#define ALIGNED 1e-12 /* rad: contacts this exact are left alone, so that weights never creep */

enum { RING_DOUBLES = 9, RING_INTS = 4 }; /* arrays of N doubles, and of N ints */

size_t ring_scratch(int count)
{
    const size_t n = (size_t)count;
    return RING_DOUBLES * n + (RING_INTS * n * sizeof(int) + sizeof(double) - 1) / sizeof(double);
}

static double *next_doubles(double **free, int count)
{
    double *const block = *free;
    *free += count;
    return block;
}

static int *next_ints(int **free, int count)
{
    int *const block = *free;
    *free += count;
    return block;
}

/* Hand out the arrays of `scratch`. */
static void lay_out_scratch(int n, double *scratch, WeightsInOrder *w)
{
    double *d = scratch;
    int *i = (int *)(void *)(scratch + RING_DOUBLES * n);
    w->given = next_doubles(&d, n);
    w->begin = next_doubles(&d, n);
    w->angle = next_doubles(&d, n);
    w->angle_rate = next_doubles(&d, n);
    w->mass = next_doubles(&d, 2 * n);
    w->offset = next_doubles(&d, 2 * n);
    w->spacing = next_doubles(&d, n);
    w->order = next_ints(&i, n);
    w->joined = next_ints(&i, n);
    w->chains.first = next_ints(&i, n);
    w->chains.size = next_ints(&i, n);
}

/* Weights by their angle within a turn, those at one place as they were given. */
static void sort_by_angle(int n, const double *within, int *order)
{
    int j, k;
    for (k = 1; k < n; k++) {
        const int weight = order[k];
        for (j = k; j > 0 && within[order[j - 1]] > within[weight]; j--) {
            order[j] = order[j - 1];
        }
        order[j] = weight;
    }
}

/* What each weight has of its own, in the order in which they stand. */
static void set_each(WeightsInOrder *w)
{
    const Track *track = w->track;
    const Weights *all = &track->weights;
    const int n = w->count;
    int j;
    for (j = 0; j < n; j++) {
        w->mass[j] = w->mass[n + j] = weights_mass_ratio(all, w->order[j]);
        w->spacing[j] = 2.0 * track->alpha;
        if (all->each) {
            const Weights one = weights_single(all, w->order[j]);
            const Weights next = weights_single(all, w->order[(j + 1) % n]);
            w->spacing[j] = 2.0 * half_angle(0.5 * (one.radius + next.radius), all->track_radius);
        }
    }
}

void write_weights(const WeightsInOrder *weights, double *angles, double *speeds, double *contacts)
{
    int j;
    for (j = 0; j < weights->count; j++) {
        const int k = weights->order[j];
        /* turns are kept, and a weight that has not moved keeps its angle to the last digit */
        angles[k] = weights->given[k] + (weights->angle[j] - weights->begin[j]);
        speeds[k] = weights->angle_rate[j];
        contacts[k] = weights->joined[j] ? 1.0 : 0.0;
    }
}

double gap(const WeightsInOrder *weights, int k)
{
    const double *angle = weights->angle;
    const double ahead = k + 1 < weights->count ? angle[k + 1] : angle[0] + TAU;
    return ahead - angle[k] - weights->spacing[k];
}

/* Set `chains`, the runs of weights each of which lastingly touches the next. */
static void find_chains(WeightsInOrder *weights)
{
    const int n = weights->count, *linked = weights->joined;
    Runs *chains = &weights->chains;
    int start = 0, first, count = 0, k;
    if (weights->track->solid) { /* behind the first link that is missing */
        while (start < n && linked[start]) {
            start++;
        }
        start = start == n ? 0 : start + 1;
    }
    first = start;
    for (k = start; k < start + n; k++) {
        if (k == start + n - 1 || !linked[k % n]) {
            chains->first[count] = first % n;
            chains->size[count] = k + 1 - first;
            first = k + 1;
            count++;
        }
    }
    chains->count = count;
}

static bool is_aligned(const WeightsInOrder *weights, int first, int size)
{
    const int n = weights->count;
    const double *rate = weights->angle_rate;
    int j;
    for (j = first; j < first + size - 1; j++) {
        if (absolute(gap(weights, j % n)) > ALIGNED || rate[(j + 1) % n] != rate[first]) {
            return 0;
        }
    }
    return 1;
}

/* Angle of a vector [rad]. */
static double angle_of(Complex vector)
{
    const double size = magnitude(vector), angle = size > 0.0 ? arc_sine(vector.im / size) : 0.0;
    return vector.re < 0.0 ? copy_sign(PI, vector.im) - angle : angle;
}

/* sin(n alpha)/(n sin alpha): static moment of a packed group in units of that of its mass at the middle. */
static double group_factor(int count, double alpha)
{
    if (count == 1 || alpha == 0.0) {
        return 1.0;
    }
    return sine(count * alpha) / (count * sine(alpha));
}

double find_offsets(WeightsInOrder *weights, int first, int size)
{
    const double alpha = weights->track->alpha;
    double *offset = weights->offset + first, at = 0.0, middle, mass = 0.0;
    Complex moment = {0.0, 0.0};
    int j;
    if (!weights->track->weights.each) {
        for (j = 0; j < size; j++) {
            offset[j] = (2 * j - size + 1) * alpha;
        }
        return group_factor(size, alpha);
    }
    for (j = 0; j < size; j++) {
        offset[j] = at;
        mass += weights->mass[first + j];
        moment = complex_sum(moment, rect(weights->mass[first + j], at));
        at += weights->spacing[(first + j) % weights->count];
    }
    middle = angle_of(moment);
    for (j = 0; j < size; j++) {
        offset[j] -= middle;
    }
    return magnitude(moment) / mass;
}

/* Put a run of weights that touch, whose offsets are set, about the angle `middle`. */
static void place_group(WeightsInOrder *weights, int first, int size, double middle, double rate)
{
    int j;
    for (j = 0; j < size; j++) {
        int k = first + j;
        double angle = middle + weights->offset[k];
        if (k >= weights->count) {
            k -= weights->count;
            angle -= TAU;
        }
        weights->angle[k] = angle;
        weights->angle_rate[k] = rate;
    }
}

/* Put the weights of a chain about the mean of their angles, with the mean of their rates. */
static void place_about_mean(WeightsInOrder *weights, int first, int size)
{
    const int unequal = weights->track->weights.each != NULL;
    double middle = 0.0, rate = 0.0, mass = 0.0;
    int j;
    find_offsets(weights, first, size);
    for (j = first; j < first + size; j++) {
        const int k = j % weights->count;
        middle += weights->angle[k] + (k < first ? TAU : 0.0) - (unequal ? weights->offset[j] : 0.0);
        rate += weights->mass[j] * weights->angle_rate[k];
        mass += weights->mass[j];
    }
    place_group(weights, first, size, middle / size, rate / mass);
}

/* Exact distances and one rate in every chain of lasting contacts; refuse overlaps. */
static int align_chains(WeightsInOrder *weights)
{
    const Runs *chains = &weights->chains;
    int k, any = 0;
    for (k = 0; k < weights->count; k++) {
        const double opening = gap(weights, k);
        if (opening < -OVERLAP) {
            return fail(weights->failure, "weights overlap by %3 rad: neighbours need %6 rad", -opening,
                        weights->spacing[k]);
        }
        if (weights->joined[k] && opening > OVERLAP) {
            weights->joined[k] = 0;
        }
        any |= weights->joined[k];
    }
    if (!any) {
        return FINE;
    }
    find_chains(weights);
    for (k = 0; k < chains->count; k++) {
        if (chains->size[k] > 1 && !is_aligned(weights, chains->first[k], chains->size[k])) {
            place_about_mean(weights, chains->first[k], chains->size[k]);
        }
    }
    return FINE;
}

int order_weights(const Track *track, const double *angles, const double *speeds,
                 const double *contacts, double *scratch, WeightsInOrder *weights, Failure *failure)
{
    const int n = track->weights.count;
    int j;
    lay_out_scratch(n, scratch, weights);
    failure->code = FINE;
    weights->failure = failure;
    weights->track = track;
    weights->count = n;
    weights->chains.count = 0;
    for (j = 0; j < n; j++) {
        weights->given[j] = angles[j];
        weights->angle[j] = modulo(angles[j], TAU);
        weights->order[j] = j;
    }
    if (track->solid) {
        sort_by_angle(n, weights->angle, weights->order);
    }
    for (j = 0; j < n; j++) {
        const int k = weights->order[j];
        weights->begin[j] = weights->angle[k];
        weights->angle_rate[j] = speeds[k];
        weights->joined[j] = track->full || (track->solid && contacts[k] != 0.0);
    }
    copy_doubles((size_t)n, weights->begin, weights->angle);
    set_each(weights);
    return track->solid ? align_chains(weights) : FINE;
}

int track_first_contacts(const Track *track, const double *angles, const double *speeds,
                         double *contacts, double *scratch, Failure *failure)
{
    const int n = track->weights.count;
    WeightsInOrder weights;
    double room = 0.0;
    int k, code;
    fill_doubles((size_t)n, 0.0, contacts);
    if (!track->solid) {
        return FINE;
    }
    code = order_weights(track, angles, speeds, contacts, scratch, &weights, failure);
    for (k = 0; k < n && !code; k++) {
        const int alike = weights.angle_rate[k] == weights.angle_rate[(k + 1) % n];
        contacts[weights.order[k]] = alike && gap(&weights, k) <= TOUCHING_ANGLE ? 1.0 : 0.0;
        room += gap(&weights, k);
    }
    if (!code && !track->full && !(room > n * TOUCHING_ANGLE)) { /* which depends on their order */
        code = fail(failure, "weight_radius: %u weights of unequal radii need %6 rad of a track of radius "
                    "%v m, must be less than a turn",
                    (unsigned long)n, TAU - room, track->weights.track_radius);
    }
    return code;
}
