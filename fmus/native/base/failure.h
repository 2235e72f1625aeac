/* What a function of the core could not do, in words: those of the Python units. */
#ifndef AUTOBALANCER_FAILURE_H
#define AUTOBALANCER_FAILURE_H

enum { FINE = 0, FAILURE_SIZE = 1024 };

typedef struct {
    int code; /* FINE, or 1 */
    char words[FAILURE_SIZE];
} Failure;

/* Write a failure, with values as in text_format, and return 1, so that a caller can return what this
   returns. */
int fail(Failure *failure, const char *format, ...);

#endif
