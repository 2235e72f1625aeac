/* The weights of one machine side by side: a number here is one of each of LANES weights. */
#include <string.h>

#include "base/pair.h"
#include "lanes/lanes.h"
#include "machine/weights_series.h"

/* Some weights, and what pulls their tracks. */
typedef struct {
    SeriesWeight weights;
    Pair *pull;
} Four;

static WeightsBeside *allocate_beside(Unit *unit, int weights, int tracks)
{
    enum { COEFFICIENTS = MOST_ORDER + 3 };
    const size_t fours = ((size_t)weights + LANES - 1) / LANES, of_tracks = 2 * (size_t)tracks;
    WeightsBeside *made = unit_allocate(unit, 1, sizeof *made);
    Four *four;
    size_t k;
    if (!made) {
        return NULL;
    }
    made->weights = weights;
    made->track_of = unit_allocate(unit, fours * LANES, sizeof(int));
    made->known = unit_allocate(unit, of_tracks, sizeof(double));
    made->pull = unit_allocate(unit, of_tracks, sizeof(double));
    made->moved = unit_allocate(unit, of_tracks, sizeof(double));
    made->found = unit_allocate(unit, 2 * LANES * fours, sizeof(double));
    made->fours = four = unit_allocate(unit, fours, sizeof *four);
    if (!made->track_of || !made->known || !made->pull || !made->moved || !made->found || !four) {
        return NULL;
    }
    for (k = 0; k < fours; k++, four++) {
        four->pull = unit_allocate(unit, COEFFICIENTS, sizeof(Pair));
        four->weights.unit = unit_allocate(unit, COEFFICIENTS, sizeof(Pair));
        four->weights.rate = unit_allocate(unit, COEFFICIENTS, sizeof(Pair));
        if (!four->pull || !four->weights.unit || !four->weights.rate) {
            return NULL;
        }
    }
    return made;
}

/* Numbers of some weights; 0 where there are not so many. */
static inline Number load(const double *from, int count)
{
    Number made = number_of(0.0);
    int k;
    if (count >= LANES) {
        memcpy(&made, from, sizeof made);
        return made;
    }
    for (k = 0; k < count; k++) {
        made[k] = from[k];
    }
    return made;
}

static inline void store(Number from, double *to, int count)
{
    int k;
    if (count >= LANES) {
        memcpy(to, &from, sizeof from);
        return;
    }
    for (k = 0; k < count; k++) {
        to[k] = from[k];
    }
}

static inline void store_pairs(Pair from, double *to)
{
    const Number early = __builtin_shufflevector(from.x, from.y, 0, LANES, 1, LANES + 1);
    const Number late = __builtin_shufflevector(from.x, from.y, 2, LANES + 2, 3, LANES + 3);
    memcpy(to, &early, sizeof early);
    memcpy(to + LANES, &late, sizeof late);
}

static void find_directions_beside(const double *angles, double *directions)
{
    store_pairs(pair_direction(load(angles, LANES)), directions);
}

/* A vector of each weight's track, of weights on several. */
static inline Pair spread_apart(const double *of_tracks, const int *track_of)
{
    const double *a = of_tracks + 2 * track_of[0], *b = of_tracks + 2 * track_of[1];
    const double *c = of_tracks + 2 * track_of[2], *d = of_tracks + 2 * track_of[3];
    const Number x = {a[0], b[0], c[0], d[0]}, y = {a[1], b[1], c[1], d[1]};
    return pair_of(x, y);
}

/* A vector of each weight's track. */
static inline Pair spread(const double *of_tracks, const int *track_of)
{
    const double *a = of_tracks + 2 * track_of[0];
    if (track_of[0] == track_of[LANES - 1]) { /* they are in order */
        return pair_of(number_of(a[0]), number_of(a[1]));
    }
    return spread_apart(of_tracks, track_of);
}

static void load_constants(SeriesWeight *four, const double *numbers, size_t stride, int count)
{
    double *to = (double *)&four->moment;
    int k, lane;
    for (k = 0; k < WEIGHT_NUMBERS; k++, to += LANES) {
        for (lane = 0; lane < LANES; lane++) {
            to[lane] = lane < count ? numbers[stride * (size_t)lane + (size_t)k] : 0.0;
        }
    }
}

static void start_beside(WeightsBeside *beside, const double *numbers, size_t stride, double angle, double turning,
                         const double *angles, const double *rates)
{
    Four *four = beside->fours;
    double *direction = beside->found;
    int left = beside->weights;
    for (; left > 0; left -= LANES, four++, direction += 2 * LANES) {
        SeriesWeight *weights = &four->weights;
        load_constants(weights, numbers, stride, left);
        weights->rate[0] = pair_both(turning + load(rates, left));
        series_weight_start(weights, pair_direction(angle + load(angles, left)));
        store_pairs(weights->along, direction);
        numbers += stride * LANES;
        angles += LANES;
        rates += LANES;
    }
}

static void push_beside(WeightsBeside *beside, int k, const double *speeds, double carried)
{
    Four *four = beside->fours;
    const int *track_of = beside->track_of;
    double *force = beside->found;
    int left = beside->weights;
    for (; left > 0; left -= LANES, four++, force += 2 * LANES, track_of += LANES, speeds += LANES) {
        series_weight_advance(&four->weights, k, four->pull, spread(beside->known, track_of), load(speeds, left),
                              number_of(carried));
        store_pairs(series_weight_force(&four->weights), force);
    }
}

static void take_beside(WeightsBeside *beside, int k, double gained, const double *per, double *speeds)
{
    Four *four = beside->fours;
    const int *track_of = beside->track_of;
    int left = beside->weights;
    for (; left > 0; left -= LANES, four++, track_of += LANES, speeds += LANES) {
        SeriesWeight *weights = &four->weights;
        const Number pulled = series_weight_pulled(weights, spread(beside->moved, track_of));
        four->pull[k] = spread(beside->pull, track_of);
        series_weight_finish(weights, k, weights->free - weights->lever * pulled, per);
        store(pair_x(weights->rate[k + 1]) - gained, speeds, left);
    }
}
