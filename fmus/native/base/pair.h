/* Two numbers that are computed together: the parts of a vector or of a complex number x + i y, or two of a
   kind.  Every operation is rounded number by number, as if there were no pairs.

   An x86-64 or 64-bit ARM processor holds both numbers in one register; compilers make use of that only
   where they are told to.  Elsewhere, and of machines side by side, a pair is two numbers.  A pair lies at a
   multiple of its size. */
#ifndef AUTOBALANCER_PAIR_H
#define AUTOBALANCER_PAIR_H

#include "base/direction.h"

#if (defined(__x86_64__) || defined(_M_X64)) && !defined(SIDE_BY_SIDE)
#include <emmintrin.h>

typedef struct {
    __m128d both;
} Pair;

static inline Pair pair_of(double x, double y)
{
    const Pair made = {_mm_set_pd(y, x)};
    return made;
}

static inline double pair_x(Pair a)
{
    return _mm_cvtsd_f64(a.both);
}

static inline double pair_y(Pair a)
{
    return _mm_cvtsd_f64(_mm_unpackhi_pd(a.both, a.both));
}

/* a + b */
static inline Pair pair_sum(Pair a, Pair b)
{
    const Pair made = {_mm_add_pd(a.both, b.both)};
    return made;
}

/* a - b */
static inline Pair pair_difference(Pair a, Pair b)
{
    const Pair made = {_mm_sub_pd(a.both, b.both)};
    return made;
}

/* Each number of a by that of b. */
static inline Pair pair_times(Pair a, Pair b)
{
    const Pair made = {_mm_mul_pd(a.both, b.both)};
    return made;
}

#elif (defined(__aarch64__) || defined(_M_ARM64)) && !defined(SIDE_BY_SIDE)
#include <arm_neon.h>

typedef struct {
    float64x2_t both;
} Pair;

static inline Pair pair_of(double x, double y)
{
    const Pair made = {vcombine_f64(vdup_n_f64(x), vdup_n_f64(y))};
    return made;
}

static inline double pair_x(Pair a)
{
    return vgetq_lane_f64(a.both, 0);
}

static inline double pair_y(Pair a)
{
    return vgetq_lane_f64(a.both, 1);
}

/* a + b */
static inline Pair pair_sum(Pair a, Pair b)
{
    const Pair made = {vaddq_f64(a.both, b.both)};
    return made;
}

/* a - b */
static inline Pair pair_difference(Pair a, Pair b)
{
    const Pair made = {vsubq_f64(a.both, b.both)};
    return made;
}

/* Each number of a by that of b. */
static inline Pair pair_times(Pair a, Pair b)
{
    const Pair made = {vmulq_f64(a.both, b.both)};
    return made;
}

#else

typedef struct {
    Number x, y;
} Pair;

static inline Pair pair_of(Number x, Number y)
{
    const Pair made = {x, y};
    return made;
}

static inline Number pair_x(Pair a)
{
    return a.x;
}

static inline Number pair_y(Pair a)
{
    return a.y;
}

/* a + b */
static inline Pair pair_sum(Pair a, Pair b)
{
    return pair_of(a.x + b.x, a.y + b.y);
}

/* a - b */
static inline Pair pair_difference(Pair a, Pair b)
{
    return pair_of(a.x - b.x, a.y - b.y);
}

/* Each number of a by that of b. */
static inline Pair pair_times(Pair a, Pair b)
{
    return pair_of(a.x * b.x, a.y * b.y);
}

#endif

static inline Pair pair_both(Number x)
{
    return pair_of(x, x);
}

static inline Pair pair_zero(void)
{
    return pair_both(number_of(0.0));
}

/* e^{i angle} */
static inline Pair pair_direction(Number angle)
{
    Number cosine, sine;
    number_direction(angle, &cosine, &sine);
    return pair_of(cosine, sine);
}

/* The first number, or the second. */
static inline Number pair_at(Pair a, int second)
{
    return second ? pair_y(a) : pair_x(a);
}

static inline void pair_set(Pair *a, int second, Number value)
{
    *a = second ? pair_of(pair_x(*a), value) : pair_of(value, pair_y(*a));
}

static inline Pair pair_scaled(Pair a, Number factor)
{
    return pair_times(a, pair_both(factor));
}

/* a + b c, number by number. */
static inline Pair pair_add_times(Pair a, Pair b, Pair c)
{
    return pair_sum(a, pair_times(b, c));
}

/* The same where both numbers of c are one. */
static inline Pair pair_add_by_both(Pair a, Pair b, Pair c)
{
#ifdef SIDE_BY_SIDE
    return pair_of(a.x + b.x * c.x, a.y + b.y * c.x); /* the second is not read */
#else
    return pair_add_times(a, b, c);
#endif
}

static inline Pair pair_add_scaled(Pair a, Pair b, Number factor)
{
    return pair_sum(a, pair_scaled(b, factor));
}

static inline Pair pair_negative(Pair a)
{
    return pair_of(-pair_x(a), -pair_y(a));
}

/* What a sum begins with that adds nothing: even a zero keeps its sign, and the first addition need not be done. */
static inline Pair pair_nothing(void)
{
    return pair_negative(pair_zero());
}

/* i a: a quarter turn further. */
static inline Pair pair_turned(Pair a)
{
    return pair_of(-pair_y(a), pair_x(a));
}

/* -i a: a quarter turn back. */
static inline Pair pair_turned_back(Pair a)
{
    return pair_of(pair_y(a), -pair_x(a));
}

static inline Pair pair_swapped(Pair a)
{
    return pair_of(pair_y(a), pair_x(a));
}

/* a b as complex numbers. */
static inline Pair pair_product(Pair a, Pair b)
{
    return pair_of(pair_x(a) * pair_x(b) - pair_y(a) * pair_y(b), pair_x(a) * pair_y(b) + pair_y(a) * pair_x(b));
}

/* Im(a* b). */
static inline Number pair_crossed(Pair a, Pair b)
{
    return pair_x(a) * pair_y(b) - pair_y(a) * pair_x(b);
}

#endif
