#include "contact/impact_law.h"

#include "base/elementary.h"
#include "base/matrix.h"

#define APPROACH_ROUNDING 1e-13 /* of the largest opening speed before the impact */
#define RATE_ROUNDING 2e-15     /* of the largest rate */
#define SLOWEST_APPROACH 1e-290 /* rad/s: products of slower ones vanish */
#define MOST_ROUNDS 100         /* with restitution; a last one without it ends every approach */
#define PIVOTS_PER_PAIR 200

enum { VECTORS = 9, SQUARES = 3, IMPACT_INTS = 5 }; /* doubles a weight, squares of n, and ints a weight */

size_t impact_doubles(int count)
{
    const size_t n = (size_t)count, ints = IMPACT_INTS * n * sizeof(int);
    return VECTORS * n + SQUARES * n * n + (ints + sizeof(double) - 1) / sizeof(double);
}

Impact impact_begin(const double *mobility, int planes, int count, double *memory)
{
    const size_t n = (size_t)count;
    double *squares = memory + VECTORS * n;
    int *ints = (int *)(void *)(squares + SQUARES * n * n);
    Impact impact;
    impact.mobility = mobility;
    impact.planes = planes;
    impact.count = impact.contacts = 0;
    impact.inertia = memory;
    impact.moment = memory + n;
    impact.direction = (Complex *)(void *)(memory + 2 * n);
    impact.rate = memory + 4 * n;
    impact.before = memory + 5 * n;
    impact.restitution = memory + 6 * n;
    impact.impulse = memory + 7 * n;
    impact.right = memory + 8 * n;
    impact.jumps = squares;
    impact.openings = squares + n * n;
    impact.square = squares + 2 * n * n;
    impact.plane = ints;
    impact.behind = ints + n;
    impact.ahead = ints + 2 * n;
    impact.lasting = ints + 3 * n;
    impact.pushing = ints + 4 * n;
    return impact;
}

double impact_opening(const Impact *impact, int contact)
{
    return impact->rate[impact->ahead[contact]] - impact->rate[impact->behind[contact]];
}

/* The angles' inertia B, (n, n). */
static void fill_inertia(const Impact *impact, double *matrix)
{
    const int n = impact->count;
    int k, l;
    for (k = 0; k < n; k++) {
        for (l = 0; l < n; l++) {
            const double mobility =
                impact->mobility[impact->plane[k] * impact->planes + impact->plane[l]];
            const Complex a = impact->direction[k], b = impact->direction[l];
            matrix[k * n + l] = (k == l ? impact->inertia[k] : 0.0) -
                                mobility * impact->moment[k] * impact->moment[l] *
                                    (a.re * b.re + a.im * b.im);
        }
    }
}

/* Jumps of the rates by unit impulses, and what they make of the opening speeds; 1: B is singular. */
static int fill_responses(Impact *impact)
{
    const int n = impact->count, c = impact->contacts;
    double *jumps = impact->jumps;
    int i, j;
    fill_inertia(impact, impact->openings);
    fill_doubles((size_t)n * (size_t)c, 0.0, jumps);
    for (j = 0; j < c; j++) {
        jumps[impact->behind[j] * c + j] -= 1.0;
        jumps[impact->ahead[j] * c + j] += 1.0;
    }
    if (matrix_solve(1, n, c, impact->openings, jumps)) {
        return 1;
    }
    for (i = 0; i < c; i++) {
        for (j = 0; j < c; j++) {
            impact->openings[i * c + j] =
                jumps[impact->ahead[i] * c + j] - jumps[impact->behind[i] * c + j];
        }
    }
    return 0;
}

/* Impulses of the pairs that push, so that their right-hand sides vanish; all others are 0. */
static int fill_impulses(Impact *impact)
{
    const int c = impact->contacts;
    double *square = impact->square;
    int count = 0, i, j;
    for (i = 0; i < c; i++) {
        if (!impact->pushing[i]) {
            continue;
        }
        for (j = 0; j < c; j++) {
            if (impact->pushing[j]) {
                *square++ = impact->openings[i * c + j];
            }
        }
        impact->impulse[count++] = -impact->right[i];
    }
    if (matrix_solve(1, count, 1, impact->square, impact->impulse)) {
        return 1;
    }
    for (i = c - 1; i >= 0; i--) {
        impact->impulse[i] = impact->pushing[i] ? impact->impulse[--count] : 0.0;
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
        double left = impact->right[i];
        if (impact->lasting[i]) {
            continue;
        }
        for (j = 0; j < c; j++) {
            left += row[j] * impact->impulse[j];
        }
        if ((impact->pushing[i] ? impact->impulse[i] * row[i] : left) < -tiny) {
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
    if (fill_responses(impact)) {
        return 1;
    }
    for (i = 0; i < c; i++) {
        const double e = rebounds && !impact->lasting[i] ? impact->restitution[i] : 0.0;
        impact->right[i] = (1.0 + e) * impact_opening(impact, i);
        impact->pushing[i] = impact->lasting[i];
    }
    for (pivot = 0; pivot < PIVOTS_PER_PAIR * c; pivot++) {
        if (fill_impulses(impact)) {
            return 1;
        }
        i = first_violation(impact, tiny);
        if (i < 0) {
            break;
        }
        impact->pushing[i] = !impact->pushing[i];
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
            closing = larger(closing, impact->lasting[i] ? absolute(opening) : -opening);
        }
        if (closing <= tiny) {
            return FINE;
        }
        if (collide(impact, round < MOST_ROUNDS, tiny)) {
            break;
        }
    }
    return fail(failure, FAILURE_IMPACT, "weights", impact->contacts, largest, 0.0, 0.0, 0.0);
}

Complex impact_on_plane(const Impact *impact, int plane)
{
    Complex rate = {0.0, 0.0};
    int k;
    for (k = 0; k < impact->count; k++) {
        if (impact->plane[k] == plane) {
            const double jump = impact->moment[k] * (impact->rate[k] - impact->before[k]);
            rate = complex_sum(rate, complex_scaled(jump, impact->direction[k]));
        }
    }
    return complex_of(rate.im, -rate.re); /* -i times it */
}
