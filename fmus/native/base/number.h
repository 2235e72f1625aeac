/* A number of a machine's series: one.  The library compiles the series once more with lanes/number.h, where it
   is one of each of several machines that go on side by side. */
#ifndef AUTOBALANCER_NUMBER_H
#define AUTOBALANCER_NUMBER_H

#include "base/elementary.h"

typedef double Number;

static inline Number number_of(double value)
{
    return value;
}

/* Whether it is 0 in every machine. */
static inline int number_is_zero(Number a)
{
    return a == 0.0;
}

static inline Number number_root(Number a)
{
    return square_root(a);
}

#endif
