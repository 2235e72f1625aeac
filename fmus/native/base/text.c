#include "base/text.h"

#include <string.h>

#include "base/elementary.h"

enum { MOST_DIGITS = 12, INTEGER_DIGITS = 20 };

Text text_in(char *buffer, size_t size)
{
    Text text;
    text.at = buffer;
    text.size = size;
    text.length = 0;
    buffer[0] = 0;
    return text;
}

void text_put_part(Text *text, const char *words, size_t length)
{
    const size_t room = text->size - 1 - text->length;
    const size_t fits = length < room ? length : room;
    memcpy(text->at + text->length, words, fits);
    text->length += fits;
    text->at[text->length] = 0;
    if (fits < length) {
        memcpy(text->at + text->size - 4, "...", 4);
    }
}

void text_put(Text *text, const char *words)
{
    text_put_part(text, words, strlen(words));
}

static void put_integer(Text *text, unsigned long value)
{
    char digits[INTEGER_DIGITS];
    int at = INTEGER_DIGITS;
    do {
        digits[--at] = (char)('0' + value % 10);
        value /= 10;
    } while (value);
    text_put_part(text, digits + at, (size_t)(INTEGER_DIGITS - at));
}

void text_hexadecimal(Text *text, uint64_t value)
{
    int shift;
    for (shift = 60; shift >= 0; shift -= 4) {
        text_put_part(text, &"0123456789abcdef"[value >> shift & 15], 1);
    }
}

int text_equal(const char *a, const char *b)
{
    while (*a && *a == *b) {
        a++;
        b++;
    }
    return *a == *b;
}

/* Digits of value > 0 = d.ddd 10^exponent, rounded to so many, without zeros at the end; returns how
   many are left.  Divisions by ten round: no more than MOST_DIGITS are right. */
static int find_digits(double value, int asked, char *digits, int *exponent)
{
    uint64_t whole;
    int k;
    *exponent = 0;
    for (; value >= 10.0; value /= 10.0) {
        ++*exponent;
    }
    for (; value < 1.0; value *= 10.0) {
        --*exponent;
    }
    for (k = 1; k < asked; k++) {
        value *= 10.0;
    }
    whole = (uint64_t)(value + 0.5);
    for (k = asked - 1; k >= 0; k--) {
        digits[k] = (char)('0' + whole % 10);
        whole /= 10;
    }
    if (whole) { /* all were nines */
        digits[0] = '1';
        ++*exponent;
    }
    while (asked > 1 && digits[asked - 1] == '0') {
        asked--;
    }
    return asked;
}

/* Digits with point or exponent, which begins at 10^`widest`. */
static void put_decimal(Text *text, const char *digits, int count, int exponent, int widest,
                        const char *whole_end)
{
    int k;
    if (exponent < -4 || exponent >= widest) {
        text_put_part(text, digits, 1);
        if (count > 1) {
            text_put(text, ".");
            text_put_part(text, digits + 1, (size_t)(count - 1));
        }
        text_put(text, exponent < 0 ? "e-" : "e+");
        exponent = exponent < 0 ? -exponent : exponent;
        text_put(text, exponent < 10 ? "0" : "");
        put_integer(text, (unsigned long)exponent);
        return;
    }
    if (exponent < 0) {
        text_put(text, "0.");
        for (k = -1; k > exponent; k--) {
            text_put(text, "0");
        }
        text_put_part(text, digits, (size_t)count);
        return;
    }
    for (k = 0; k <= exponent; k++) {
        text_put_part(text, k < count ? digits + k : "0", 1);
    }
    if (count > exponent + 1) {
        text_put(text, ".");
        text_put_part(text, digits + exponent + 1, (size_t)(count - exponent - 1));
    } else {
        text_put(text, whole_end);
    }
}

/* True when the words are written already: not a number, infinite, or zero after its sign. */
static int put_special(Text *text, double value, const char *zero)
{
    if (value != value) {
        text_put(text, "nan");
        return 1;
    }
    if (copy_sign(1.0, value) < 0.0) {
        text_put(text, "-");
    }
    if (!is_finite(value)) {
        text_put(text, "inf");
        return 1;
    }
    if (value == 0.0) {
        text_put(text, zero);
        return 1;
    }
    return 0;
}

static void put_digits(Text *text, double value, int digits, int widest, const char *whole_end)
{
    char found[MOST_DIGITS];
    int exponent, count;
    if (put_special(text, value, *whole_end ? "0.0" : "0")) {
        return;
    }
    count = find_digits(absolute(value), digits, found, &exponent);
    put_decimal(text, found, count, exponent, widest, whole_end);
}

/* Twelve significant digits without zeros at the end, 1.0 for a whole number. */
static void put_number(Text *text, double value)
{
    put_digits(text, value, MOST_DIGITS, 16, ".0");
}

static void put_list(Text *text, const double *values, size_t count)
{
    size_t k;
    text_put(text, "[");
    for (k = 0; k < count; k++) {
        text_put(text, k ? ", " : "");
        put_number(text, values[k]);
    }
    text_put(text, "]");
}

void text_format_values(Text *text, const char *format, va_list values)
{
    const double *list;
    for (; *format; format++) {
        size_t plain = 0;
        while (format[plain] && format[plain] != '%') {
            plain++;
        }
        text_put_part(text, format, plain);
        format += plain;
        if (!*format) {
            return;
        }
        switch (*++format) {
        case 's':
            text_put(text, va_arg(values, const char *));
            break;
        case 'u':
            put_integer(text, va_arg(values, unsigned long));
            break;
        case 'l':
            list = va_arg(values, const double *);
            put_list(text, list, va_arg(values, size_t));
            break;
        case 'v':
            put_number(text, va_arg(values, double));
            break;
        default:
            put_digits(text, va_arg(values, double), *format - '0', *format - '0', "");
        }
    }
}

void text_format(Text *text, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    text_format_values(text, format, values);
    va_end(values);
}

int text_digit(char c)
{
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : 16;
}

const char *text_after(const char *text, const char *begin)
{
    const size_t length = strlen(begin);
    return strncmp(text, begin, length) ? NULL : text + length;
}

const char *text_whole(const char *at, int base, uint64_t *value)
{
    *value = 0;
    for (; text_digit(*at) < base; at++) {
        const uint64_t digit = (uint64_t)text_digit(*at), times = (uint64_t)base;
        *value = *value > (UINT64_MAX - digit) / times ? UINT64_MAX : *value * times + digit;
    }
    return at;
}
