/* Messages: texts in a buffer of fixed size, and numbers as Python writes them.

   A C library's own number formats depend on the host's locale. */
#ifndef AUTOBALANCER_TEXT_H
#define AUTOBALANCER_TEXT_H

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

/* A text that ends with "..." where it did not fit. */
typedef struct {
    char *at;
    size_t size, length;
} Text;

/* An empty text in a buffer of at least 4 characters. */
Text text_in(char *buffer, size_t size);
void text_put(Text *text, const char *words);
void text_put_part(Text *text, const char *words, size_t length);
/* Sixteen hexadecimal digits. */
void text_hexadecimal(Text *text, uint64_t value);
/* Add words with values: %s a text, %u an unsigned long, %v a number of twelve significant digits without zeros
   at the end, 1.0 for a whole one, %3 one of 3, Python's format(value, ".3g"), %l a list of numbers, given as
   an array and its size: [1.0, 2.0]. */
void text_format(Text *text, const char *format, ...);
void text_format_values(Text *text, const char *format, va_list values);

int text_equal(const char *a, const char *b);
/* Where a text goes on behind what it begins with, or NULL. */
const char *text_after(const char *text, const char *begin);
/* A whole number in digits of a base, the largest one where it is larger, and where the text goes on. */
const char *text_whole(const char *at, int base, uint64_t *value);
/* Value of a hexadecimal digit; 16 for any other letter. */
int text_digit(char c);

#endif
