/* Two weights of one track as one, in the machine's own numbers: their series lie side by side.

   A vector of four doubles then holds a pair of each.  A processor with AVX2 has it in one register; of others the
   compiler makes two.  Each number is rounded as that of one weight is. */
#ifndef AUTOBALANCER_TWO_WEIGHTS_H
#define AUTOBALANCER_TWO_WEIGHTS_H

#include <string.h>

#include "base/pair.h"
#include "machine/weights_series.h"

#define HAS_TWO_WEIGHTS

typedef double NumberOfTwo __attribute__((vector_size(16)));            /* that of the first weight, and of the second */
typedef double Pairs __attribute__((vector_size(32), aligned(16))); /* a pair of the first, and of the second */

/* As SeriesWeight has them. */
typedef struct {
    NumberOfTwo moment, lever, damping_rate, roll, free;
    Pairs along, turned;
    Pairs unit[MOST_ORDER + 3], rate[MOST_ORDER + 2];
} TwoWeights;

static inline NumberOfTwo numbers_of_pair(Pair a)
{
    NumberOfTwo made;
    memcpy(&made, &a, sizeof made);
    return made;
}

static inline Pair pair_of_numbers(NumberOfTwo a)
{
    Pair made;
    memcpy(&made, &a, sizeof made);
    return made;
}

static inline NumberOfTwo numbers_both(double value)
{
    return (NumberOfTwo){value, value};
}

/* -- pairs of both, as base/pair.h has them of one ------------------------------------------------------------ */

static inline Pairs pairs_of(Pair first, Pair second)
{
    return __builtin_shufflevector(numbers_of_pair(first), numbers_of_pair(second), 0, 1, 2, 3);
}

static inline Pairs pairs_of_track(Pair a)
{
    return pairs_of(a, a);
}

static inline Pairs pairs_both(NumberOfTwo a)
{
    return __builtin_shufflevector(a, a, 0, 0, 1, 1);
}

static inline Pairs pairs_zero(void)
{
    return (Pairs){0.0, 0.0, 0.0, 0.0};
}

static inline NumberOfTwo pairs_x(Pairs a)
{
    return __builtin_shufflevector(a, a, 0, 2);
}

static inline NumberOfTwo pairs_y(Pairs a)
{
    return __builtin_shufflevector(a, a, 1, 3);
}

static inline Pairs pairs_sum(Pairs a, Pairs b)
{
    return a + b;
}

static inline Pairs pairs_times(Pairs a, Pairs b)
{
    return a * b;
}

static inline Pairs pairs_scaled(Pairs a, NumberOfTwo factor)
{
    return a * pairs_both(factor);
}

static inline Pairs pairs_add_times(Pairs a, Pairs b, Pairs c)
{
    return a + b * c;
}

#define pairs_add_by_both pairs_add_times

static inline Pairs pairs_add_scaled(Pairs a, Pairs b, NumberOfTwo factor)
{
    return a + pairs_scaled(b, factor);
}

static inline Pairs pairs_turned(Pairs a)
{
    const Pairs swapped = __builtin_shufflevector(a, a, 1, 0, 3, 2), less = -swapped;
    return __builtin_shufflevector(less, swapped, 0, 5, 2, 7);
}

static inline Pairs pairs_turned_back(Pairs a)
{
    const Pairs swapped = __builtin_shufflevector(a, a, 1, 0, 3, 2), less = -swapped;
    return __builtin_shufflevector(swapped, less, 0, 5, 2, 7);
}

/* The pair of the first and that of the second: pair_nothing() and each of them, one after the other. */
static inline Pair pairs_added(Pairs a)
{
    const Pair first = pair_of_numbers(__builtin_shufflevector(a, a, 0, 1));
    return pair_sum(first, pair_of_numbers(__builtin_shufflevector(a, a, 2, 3)));
}

/* -- the weights ----------------------------------------------------------------------------------------------- */

/* Two weights that have been started. */
static inline void two_weights_take(TwoWeights *made, const SeriesWeight *weights)
{
    const SeriesWeight *a = weights, *b = weights + 1;
    made->moment = (NumberOfTwo){a->moment, b->moment};
    made->lever = (NumberOfTwo){a->lever, b->lever};
    made->damping_rate = (NumberOfTwo){a->damping_rate, b->damping_rate};
    made->roll = (NumberOfTwo){a->roll, b->roll};
    made->along = pairs_of(a->along, b->along);
    made->unit[0] = pairs_of(a->unit[0], b->unit[0]);
    made->unit[1] = pairs_of(a->unit[1], b->unit[1]);
    made->rate[0] = pairs_of(a->rate[0], b->rate[0]);
}

/* As series_weight_advance, _force, _pulled and _finish. */
static void two_weights_advance(TwoWeights *two, int k, const Pair *pull, Pair known, NumberOfTwo speed, Number carried);
static Pairs two_weights_force(const TwoWeights *two);
static NumberOfTwo two_weights_pulled(const TwoWeights *two, Pair acceleration);
static void two_weights_finish(TwoWeights *two, int k, NumberOfTwo acceleration, const double *per);

#define WEIGHTS(name) two_weights_##name
#define Weights TwoWeights
#define Numbers NumberOfTwo
#define NUMBERS(value) numbers_both(value)
#define Vectors Pairs
#define VECTORS(name) pairs_##name
#define OF_TRACK(pair) pairs_of_track(pair)
#include "machine/weight_orders_template.h"

#endif
