/* In place of base/number.h: a number of several machines that go on side by side, each in a lane of its own.
   Every operation is rounded lane by lane, so that each machine has the bits that it has alone. */
#ifndef AUTOBALANCER_NUMBER_H
#define AUTOBALANCER_NUMBER_H

#include "base/elementary.h"
#include "lanes/lanes.h"

/* Clang and GCC alone: the libraries are compiled by Clang, and sources of FMUs have no lanes. */
typedef double Number __attribute__((vector_size(8 * LANES), aligned(16)));

static inline Number number_of(double value)
{
    return value - (Number){0.0};
}

/* Whether it is 0 in every machine. */
static inline int number_is_zero(Number a)
{
    int lane, zero = 1;
    for (lane = 0; lane < LANES; lane++) {
        zero &= a[lane] == 0.0;
    }
    return zero;
}

static inline Number number_root(Number a)
{
    int lane;
    for (lane = 0; lane < LANES; lane++) {
        a[lane] = square_root(a[lane]);
    }
    return a;
}

/* What a comparison of numbers gives: all bits of a lane, or none. */
typedef long long Lanewise __attribute__((vector_size(8 * LANES), aligned(16)));

static inline Number number_size(Number a)
{
    return __builtin_elementwise_abs(a);
}

static inline int number_all(Lanewise held)
{
    int lane;
    long long all = -1;
    for (lane = 0; lane < LANES; lane++) {
        all &= held[lane];
    }
    return all != 0;
}

/* turned_by_quarters of base/direction.h: quarters + rounder is the whole number in the last bits. */
static inline void number_turned(Number quarters, Number rounder, Number c, Number s, Number *cosine, Number *sine)
{
    const Number shifted = quarters + rounder;
    const Lanewise whole = (Lanewise)shifted, is_odd = -(whole & 1);
    const Lanewise along = ((Lanewise)c & ~is_odd) | ((Lanewise)s & is_odd);
    const Lanewise across = ((Lanewise)s & ~is_odd) | ((Lanewise)c & is_odd);
    *cosine = (Number)(along ^ ((whole + 1) & 2) << 62); /* the sign of a number is its first bit */
    *sine = (Number)(across ^ (whole & 2) << 62);
}

#endif
