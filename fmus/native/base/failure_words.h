/* The words for what the core could not do: those of the Python units. */
#ifndef AUTOBALANCER_FAILURE_WORDS_H
#define AUTOBALANCER_FAILURE_WORDS_H

#include "base/failure.h"
#include "base/text.h"

/* `values`: what a message lists: the stations' places, the angles, or the compliance. */
void failure_words(Text *text, const Failure *failure, const double *values, size_t count);

#endif
