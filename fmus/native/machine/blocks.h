/* What a machine's series are made of, and the series, as blocks of numbers: how a machine goes into a lane. */
#ifndef AUTOBALANCER_BLOCKS_H
#define AUTOBALANCER_BLOCKS_H

#include <stddef.h>

/* Numbers that stand one behind the other; in lanes each is several doubles. */
typedef struct {
    double *first;
    size_t count;
} NumberBlock;

/* The largest coefficients of an order: of the rotor, its displacements over the largest so far and its angle over 1, and
   of the weights' angles over 1; NaN where one is not finite. */
typedef struct {
    double rotor, weights;
} Terms;

enum { BLOCKS = 10, BLOCKS_OF_TRACK = 4, BLOCKS_OF_WEIGHT = 2 }; /* at most */
enum { SHAPE_SIZE = 8, SHAPE_OF_TRACK = 4 };

#endif
