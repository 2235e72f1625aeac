/* Linux, over any C library: glibc or musl. */
#include "system.h"

extern long read(int, void *, unsigned long);
extern long write(int, const void *, unsigned long);
extern void _exit(int);
extern void *dlopen(const char *, int);
extern void *dlsym(void *, const char *);

size_t system_read(char *buffer, size_t size)
{
    long count = read(0, buffer, size);
    return count > 0 ? (size_t)count : 0;
}

void system_write(const char *text, size_t length)
{
    while (length > 0) {
        long count = write(1, text, length);
        if (count <= 0)
            _exit(2);
        text += count;
        length -= (size_t)count;
    }
}

void system_exit(int code)
{
    _exit(code);
}

void *system_open(const char *library)
{
    enum { NOW = 2 };
    return dlopen(library, NOW);
}

void *system_symbol(void *library, const char *name)
{
    return dlsym(library, name);
}

void _start(void)
{
    /* the stack is as the kernel leaves it, not as a called function expects it */
#if defined(__x86_64__)
    __asm__ volatile("andq $-16, %%rsp\n\tcall run" ::: "memory");
#else
    run();
#endif
}
