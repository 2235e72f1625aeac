/* Counts what is asked for by malloc and calloc; the library takes the host's, as any does. */
#include <stddef.h>

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);

unsigned long allocations(void);

static unsigned long asked = 1;

unsigned long allocations(void)
{
    return asked;
}

void *malloc(size_t size)
{
    __sync_fetch_and_add(&asked, 1);
    return __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    __sync_fetch_and_add(&asked, 1);
    return __libc_calloc(count, size);
}
