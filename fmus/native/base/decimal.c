#include "base/decimal.h"

#include <stdint.h>
#include <string.h>

/* 2^1024 and 10^324 times a few small factors */
enum { WORD_COUNT = 40 };

/* A whole number, 0 or more, lowest word first. */
typedef struct {
    int count;
    uint32_t word[WORD_COUNT];
} BigInteger;

static BigInteger whole(uint64_t value, int power)
{
    BigInteger made;
    int k;
    const int shift = power % 32;
    memset(&made, 0, sizeof made);
    made.count = power / 32;
    for (k = 0; k < 3; k++) {
        const int low = 32 * k - shift;
        const uint64_t part = low < 0 ? value << -low : low < 64 ? value >> low : 0;
        made.word[made.count++] = (uint32_t)part;
    }
    while (made.count && !made.word[made.count - 1]) {
        made.count--;
    }
    return made;
}

static void whole_times(BigInteger *a, uint32_t factor)
{
    uint64_t carry = 0;
    int k;
    for (k = 0; k < a->count; k++) {
        carry += (uint64_t)a->word[k] * factor;
        a->word[k] = (uint32_t)carry;
        carry >>= 32;
    }
    if (carry) {
        a->word[a->count++] = (uint32_t)carry;
    }
}

static void whole_add(BigInteger *a, const BigInteger *b)
{
    uint64_t carry = 0;
    int k;
    const int count = a->count > b->count ? a->count : b->count;
    for (k = 0; k < count; k++) {
        carry += (uint64_t)(k < a->count ? a->word[k] : 0) + (k < b->count ? b->word[k] : 0);
        a->word[k] = (uint32_t)carry;
        carry >>= 32;
    }
    a->count = count;
    if (carry) {
        a->word[a->count++] = (uint32_t)carry;
    }
}

/* a - b, which is not negative. */
static void whole_subtract(BigInteger *a, const BigInteger *b)
{
    int64_t borrow = 0;
    int k;
    for (k = 0; k < a->count; k++) {
        borrow += (int64_t)a->word[k] - (k < b->count ? b->word[k] : 0);
        a->word[k] = (uint32_t)borrow;
        borrow = borrow < 0 ? -1 : 0;
    }
    while (a->count && !a->word[a->count - 1]) {
        a->count--;
    }
}

/* Sign of a - b. */
static int whole_compare(const BigInteger *a, const BigInteger *b)
{
    int k;
    if (a->count != b->count) {
        return a->count < b->count ? -1 : 1;
    }
    for (k = a->count - 1; k >= 0; k--) {
        if (a->word[k] != b->word[k]) {
            return a->word[k] < b->word[k] ? -1 : 1;
        }
    }
    return 0;
}

/* Sign of a + b - c. */
static int whole_compare_sum(const BigInteger *a, const BigInteger *b, const BigInteger *c)
{
    BigInteger sum = *a;
    whole_add(&sum, b);
    return whole_compare(&sum, c);
}

/* The next digit of rest/unit, and ten times what is left. */
static int next_digit(BigInteger *rest, const BigInteger *unit)
{
    int digit = 0;
    while (whole_compare(rest, unit) >= 0) {
        whole_subtract(rest, unit);
        digit++;
    }
    whole_times(rest, 10);
    return digit;
}

/* Add one to the last of the digits; the exponent grows when all were nines. */
static void round_up(char *digits, int count, int *exponent)
{
    int k = count - 1;
    while (k >= 0 && digits[k] == '9') {
        digits[k--] = '0';
    }
    if (k >= 0) {
        digits[k]++;
    } else {
        digits[0] = '1';
        ++*exponent;
    }
}

int decimal(double value, int asked, char *digits, int *exponent)
{
    uint64_t bits;
    int power, count = 0, low, high, narrow, even;
    BigInteger rest, unit, above, below;
    memcpy(&bits, &value, sizeof bits);
    power = (int)(bits >> 52);
    bits &= 0xFFFFFFFFFFFFFu;
    narrow = !bits && power > 1; /* the neighbour below is half as far */
    bits += power ? 0x10000000000000u : 0;
    even = !(bits & 1);
    power = (power ? power : 1) - 1075;
    /* value = rest/unit, half the distance to the neighbours = above/unit, below/unit */
    rest = whole(bits, (power > 0 ? power : 0) + 1 + narrow);
    unit = whole(1, (power < 0 ? -power : 0) + 1 + narrow);
    above = whole(1, (power > 0 ? power : 0) + narrow);
    below = whole(1, power > 0 ? power : 0);
    *exponent = 0;
    for (;;) {
        const int reached = asked ? whole_compare(&rest, &unit)
                                  : whole_compare_sum(&rest, &above, &unit) - !even;
        BigInteger tenth = unit;
        whole_times(&tenth, 10);
        if ((asked ? whole_compare(&rest, &tenth)
                   : whole_compare_sum(&rest, &above, &tenth) - !even) >= 0) {
            whole_times(&unit, 10);
            ++*exponent;
        } else if (reached < 0) {
            whole_times(&rest, 10);
            whole_times(&above, 10);
            whole_times(&below, 10);
            --*exponent;
        } else {
            break;
        }
    }
    for (;;) {
        digits[count] = (char)('0' + next_digit(&rest, &unit));
        count++;
        whole_times(&above, 10);
        whole_times(&below, 10);
        if (asked) {
            if (count < asked) {
                continue;
            }
            whole_times(&unit, 5); /* rest is ten times what is left: half a unit */
            high = whole_compare(&rest, &unit);
            if (high > 0 || (high == 0 && (digits[count - 1] - '0') % 2)) {
                round_up(digits, count, exponent);
            }
            return count;
        }
        {
            BigInteger ten = unit;
            whole_times(&ten, 10);
            low = whole_compare(&rest, &below) - even < 0;
            high = whole_compare_sum(&rest, &above, &ten) + even > 0;
            if (low || high) {
                whole_times(&unit, 5);
                if (high && (!low || whole_compare(&rest, &unit) >= 0)) {
                    round_up(digits, count, exponent);
                }
                return count;
            }
        }
    }
}
