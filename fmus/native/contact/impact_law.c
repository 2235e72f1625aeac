#include "contact/impact_law.h"

#include "base/elementary.h"
#include "base/matrix.h"

#define APPROACH_ROUNDING 1e-13 /* of the largest opening speed before the impact */
#define RATE_ROUNDING 2e-15     /* of the largest rate */
#define SLOWEST_APPROACH 1e-290 /* rad/s: products of slower ones vanish */
#define MOST_ROUNDS 100         /* with restitution; a last one without it ends every approach */
#define PIVOTS_PER_PAIR 200

enum { VECTORS = 2, SQUARES = 3 }; /* doubles a weight, and squares of n */

static size_t doubles_of(size_t bytes)
{
    return bytes / sizeof(double);
}

size_t impact_doubles(int count)
{
    const size_t n = (size_t)count;
    return n * doubles_of(sizeof(ImpactPair)) + n * (VECTORS + SQUARES * n);
}

Impact impact_begin(int count, double *memory)
{
    const size_t n = (size_t)count;
    Impact impact;
    impact.count = count;
    impact.contacts = 0;
    impact.pairs = (ImpactPair *)(void *)memory;
    memory += n * doubles_of(sizeof(ImpactPair));
    impact.rate = memory;
    impact.impulse = memory + n;
    memory += VECTORS * n;
    impact.jumps = memory;
    impact.openings = memory + n * n;
    impact.square = memory + 2 * n * n;
    return impact;
}

double impact_opening(const Impact *impact, int contact)
{
    return impact->rate[impact->pairs[contact].ahead] - impact->rate[impact->pairs[contact].behind];
}

/* What unit impulses make of the opening speeds. */
static void fill_responses(Impact *impact)
{
    const int c = impact->contacts;
    const double *jumps = impact->jumps;
    int i, j;
    for (i = 0; i < c; i++) {
        for (j = 0; j < c; j++) {
            impact->openings[i * c + j] =
                jumps[impact->pairs[i].ahead * c + j] - jumps[impact->pairs[i].behind * c + j];
        }
    }
}

/* Impulses of the pairs that push, so that their right-hand sides vanish; all others are 0. */
static int fill_impulses(Impact *impact)
{
    const int c = impact->contacts;
    double *square = impact->square;
    int count = 0, i, j;
    for (i = 0; i < c; i++) {
        if (!impact->pairs[i].pushing) {
            continue;
        }
        for (j = 0; j < c; j++) {
            if (impact->pairs[j].pushing) {
                *square++ = impact->openings[i * c + j];
            }
        }
        impact->impulse[count++] = -impact->pairs[i].right;
    }
    if (matrix_solve(1, count, 1, impact->square, impact->impulse)) {
        return 1;
    }
    for (i = c - 1; i >= 0; i--) {
        impact->impulse[i] = impact->pairs[i].pushing ? impact->impulse[--count] : 0.0;
    }
    return 0;
}

/* The first pair that pulls, or that approaches without a push; -1: the impulses are the solution. */
static int first_violation(const Impact *impact, double tiny)
{
    const int c = impact->contacts;
    int i, j;
    for (i = 0; i < c; i++) {
        const double *row = impact->openings + i * c;
        double left = impact->pairs[i].right;
        if (impact->pairs[i].lasting) {
            continue;
        }
        for (j = 0; j < c; j++) {
            left += row[j] * impact->impulse[j];
        }
        if ((impact->pairs[i].pushing ? impact->impulse[i] * row[i] : left) < -tiny) {
            return i;
        }
    }
    return -1;
}

/* One impact, by principal pivoting with the least index: it ends as the matrix is positive definite
   (Murty 1974). */
static int collide(Impact *impact, int rebounds, double tiny)
{
    const int n = impact->count, c = impact->contacts;
    int i, j, pivot;
    fill_responses(impact);
    for (i = 0; i < c; i++) {
        const double e = rebounds && !impact->pairs[i].lasting ? impact->pairs[i].restitution : 0.0;
        impact->pairs[i].right = (1.0 + e) * impact_opening(impact, i);
        impact->pairs[i].pushing = impact->pairs[i].lasting;
    }
    for (pivot = 0; pivot < PIVOTS_PER_PAIR * c; pivot++) {
        if (fill_impulses(impact)) {
            return 1;
        }
        i = first_violation(impact, tiny);
        if (i < 0) {
            break;
        }
        impact->pairs[i].pushing = !impact->pairs[i].pushing;
    }
    for (i = 0; i < n; i++) {
        for (j = 0; j < c; j++) {
            impact->rate[i] += impact->jumps[i * c + j] * impact->impulse[j];
        }
    }
    return pivot == PIVOTS_PER_PAIR * c;
}

int impact_solve(Impact *impact, Failure *failure)
{
    double largest = 0.0, tiny = SLOWEST_APPROACH;
    int round, i;
    for (i = 0; i < impact->contacts; i++) {
        largest = larger(largest, absolute(impact_opening(impact, i)));
    }
    for (i = 0; i < impact->count; i++) {
        tiny = larger(tiny, RATE_ROUNDING * absolute(impact->rate[i]));
    }
    tiny = larger(tiny, APPROACH_ROUNDING * largest);
    for (round = 0; round <= MOST_ROUNDS; round++) {
        double closing = 0.0;
        for (i = 0; i < impact->contacts; i++) {
            const double opening = impact_opening(impact, i);
            closing = larger(closing, impact->pairs[i].lasting ? absolute(opening) : -opening);
        }
        if (closing <= tiny) {
            return FINE;
        }
        if (collide(impact, round < MOST_ROUNDS, tiny)) {
            break;
        }
    }
    return fail(failure, "no solution was found for an impact of %u pairs of weights, which close at "
                "%6 rad/s", (unsigned long)impact->contacts, largest);
}
