/* The sum of a series up to an order of 1 or more at a time, put in place for each kind of numbers.  There stands what it
   is made of, which is undefined again at the end:

   SUM                       name of the function; Sum: what it returns; Time: that of the time
   AT(at)                    the coefficient at a place, which is a const Coefficient *
   PLUS(a, b), TIMES(a, t)   the sum of two; one by a Time */
static inline Sum SUM(const Coefficient *series, int stride, int order, Time time)
{
    const Coefficient *at = series + order * stride;
    const Time square = time * time;
    Sum high = AT(at), low = AT(at - stride); /* two sums in turn: neither waits for the other */
    int k;
    for (k = order; k > 2; k -= 2, at -= 2 * stride) {
        high = PLUS(TIMES(high, square), AT(at - 2 * stride));
        low = PLUS(TIMES(low, square), AT(at - 3 * stride));
    }
    return k == 2 ? PLUS(PLUS(TIMES(high, square), AT(series)), TIMES(low, time)) : PLUS(low, TIMES(high, time));
}
#undef SUM
#undef Sum
#undef Time
#undef AT
#undef Coefficient
#undef PLUS
#undef TIMES
