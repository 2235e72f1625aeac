/* The motion of one machine at several times: a number here is one of each of LANES times.  A part of the text of
   lanes.c. */
#include <string.h>

#include "base/number.h"

static void sum_beside(const double *series, int stride, int order, const double *times, double *x, double *y)
{
    const double *at = series + order * stride;
    Number time, square, high_x = number_of(at[0]), high_y = number_of(at[1]);
    Number low_x = number_of(at[-stride]), low_y = number_of(at[1 - stride]);
    int k;
    memcpy(&time, times, sizeof time);
    square = time * time;
    for (k = order; k > 2; k -= 2, at -= 2 * stride) {
        high_x = high_x * square + number_of(at[-2 * stride]);
        high_y = high_y * square + number_of(at[1 - 2 * stride]);
        low_x = low_x * square + number_of(at[-3 * stride]);
        low_y = low_y * square + number_of(at[1 - 3 * stride]);
    }
    if (k == 2) {
        high_x = (high_x * square + number_of(series[0])) + low_x * time;
        high_y = (high_y * square + number_of(series[1])) + low_y * time;
    } else {
        high_x = low_x + high_x * time;
        high_y = low_y + high_y * time;
    }
    memcpy(x, &high_x, sizeof high_x);
    memcpy(y, &high_y, sizeof high_y);
}
