/* The motion of one machine at several times: a number here is one of each of LANES times.  A part of the text of
   lanes.c. */
#include <string.h>

#include "base/pair.h"

#define SUM sum_at_times
#define Sum Pair
#define Time Number
#define Coefficient double
#define AT(at) pair_of(number_of((at)[0]), number_of((at)[1]))
#define PLUS(a, b) pair_sum(a, b)
#define TIMES(a, time) pair_scaled(a, time)
#include "base/series_sum_template.h"

static void sum_beside(const double *series, int stride, int order, const double *times, double *x, double *y)
{
    Number time;
    Pair sum;
    memcpy(&time, times, sizeof time);
    sum = sum_at_times(series, stride, order, time);
    memcpy(x, &sum.x, sizeof sum.x);
    memcpy(y, &sum.y, sizeof sum.y);
}
