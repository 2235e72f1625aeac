/* The motion of one machine at several times: a number here is one of each of LANES times, or of twice as many, as
   many vectors as a processor keeps at once.  A part of the text of lanes.c. */
#include <string.h>

#include "base/pair.h"

enum { MANY_TIMES = 2 * LANES };
typedef double ManyTimes __attribute__((vector_size(8 * MANY_TIMES), aligned(16)));

typedef struct {
    ManyTimes x, y;
} ManyPlaces;

static inline ManyTimes many_of(double value)
{
    return value - (ManyTimes){0.0};
}

static inline ManyPlaces many_places_of(const double *pair)
{
    const ManyPlaces made = {many_of(pair[0]), many_of(pair[1])};
    return made;
}

static inline ManyPlaces many_places_sum(ManyPlaces a, ManyPlaces b)
{
    const ManyPlaces made = {a.x + b.x, a.y + b.y};
    return made;
}

static inline ManyPlaces many_places_scaled(ManyPlaces a, ManyTimes time)
{
    const ManyPlaces made = {a.x * time, a.y * time};
    return made;
}

#define SUM sum_at_many_times
#define Sum ManyPlaces
#define Time ManyTimes
#define Coefficient double
#define AT(at) many_places_of(at)
#define PLUS(a, b) many_places_sum(a, b)
#define TIMES(a, time) many_places_scaled(a, time)
#include "base/series_sum_template.h"

#define SUM sum_at_times
#define Sum Pair
#define Time Number
#define Coefficient double
#define AT(at) pair_of(number_of((at)[0]), number_of((at)[1]))
#define PLUS(a, b) pair_sum(a, b)
#define TIMES(a, time) pair_scaled(a, time)
#include "base/series_sum_template.h"

static void sum_beside(const double *series, int stride, int order, const double *times, int count, double *x, double *y)
{
    int k = 0;
#ifdef WIDE_VECTORS
    for (; count - k > LANES; k += MANY_TIMES) {
        ManyTimes time;
        ManyPlaces sum;
        memcpy(&time, times + k, sizeof time);
        sum = sum_at_many_times(series, stride, order, time);
        memcpy(x + k, &sum.x, sizeof sum.x);
        memcpy(y + k, &sum.y, sizeof sum.y);
    }
#endif
    for (; k < count; k += LANES) {
        Number time;
        Pair sum;
        memcpy(&time, times + k, sizeof time);
        sum = sum_at_times(series, stride, order, time);
        memcpy(x + k, &sum.x, sizeof sum.x);
        memcpy(y + k, &sum.y, sizeof sum.y);
    }
}
