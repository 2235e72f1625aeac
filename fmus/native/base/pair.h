/* Two numbers that are computed together: the parts of a vector or of a complex number x + i y, or two of a
   kind.  Every operation is rounded number by number, as if there were no pairs. */
#ifndef AUTOBALANCER_PAIR_H
#define AUTOBALANCER_PAIR_H

/* Wherever a number may stand, a pair may. */
typedef double Pair __attribute__((vector_size(16), aligned(8)));

static inline Pair pair_of(double x, double y)
{
    const Pair made = {x, y};
    return made;
}

static inline Pair pair_both(double x)
{
    return pair_of(x, x);
}

/* i a: a quarter turn further. */
static inline Pair pair_turned(Pair a)
{
    return pair_of(-a[1], a[0]);
}

/* -i a: a quarter turn back. */
static inline Pair pair_turned_back(Pair a)
{
    return pair_of(a[1], -a[0]);
}

/* a b as complex numbers. */
static inline Pair pair_product(Pair a, Pair b)
{
    return pair_of(a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]);
}

/* Im(a* b). */
static inline double pair_crossed(Pair a, Pair b)
{
    return a[0] * b[1] - a[1] * b[0];
}

#endif
