/* What a host needs of its system. */
#ifndef SYSTEM_H
#define SYSTEM_H

#include <stddef.h>

size_t system_read(char *buffer, size_t size); /* 0 at the end */
void system_write(const char *text, size_t length);
void system_exit(int code);
void *system_open(const char *library);
void *system_symbol(void *library, const char *name);

/* The program; the system's entry point calls it. */
void run(void);

#endif
