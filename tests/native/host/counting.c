/* Counts calls of malloc and calloc, which the library takes from its host as from any other.
   A sanitizer has a malloc of its own: then nothing is counted. */
#include <stddef.h>

unsigned long allocations(void);

#ifdef __SANITIZE_ADDRESS__
static const unsigned long asked = 0;
#else
void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);

static unsigned long asked = 1;

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
#endif

unsigned long allocations(void)
{
    return asked;
}
