/* What other platforms have in every process: the few names of the C library that the units need. */
#include <stdlib.h>
#include <string.h>

extern unsigned char __heap_base; /* of the linker: memory is zero from here on */

/* Nothing is given back: a page drops an instance with its whole memory. */
void *calloc(size_t count, size_t size)
{
    enum { PAGE = 65536, BLOCK = 16 };
    static size_t used;
    const size_t first = used ? used : (size_t)&__heap_base;
    const size_t begin = (first + BLOCK - 1) / BLOCK * BLOCK;
    const size_t there = __builtin_wasm_memory_size(0) * PAGE;
    size_t bytes;
    if (__builtin_mul_overflow(count, size, &bytes) || bytes > (size_t)-1 - PAGE - begin) {
        return NULL;
    }
    if (begin + bytes > there &&
        __builtin_wasm_memory_grow(0, (begin + bytes - there + PAGE - 1) / PAGE) == (size_t)-1) {
        return NULL;
    }
    used = begin + bytes;
    return (void *)begin;
}

void free(void *block)
{
}

size_t strlen(const char *text)
{
    const char *end = text;
    while (*end) {
        end++;
    }
    return (size_t)(end - text);
}

int strncmp(const char *a, const char *b, size_t count)
{
    size_t k;
    for (k = 0; k < count; k++) {
        if (a[k] != b[k] || !a[k]) {
            return (unsigned char)a[k] - (unsigned char)b[k];
        }
    }
    return 0;
}

int memcmp(const void *a, const void *b, size_t count)
{
    const unsigned char *left = a, *right = b;
    size_t k;
    for (k = 0; k < count; k++) {
        if (left[k] != right[k]) {
            return left[k] - right[k];
        }
    }
    return 0;
}
