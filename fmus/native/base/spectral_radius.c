#include "base/spectral_radius.h"

#include <stddef.h>

#include "base/elementary.h"
#include "base/matrix.h"

enum { SQUARINGS = 50 };

/* Gelfand: the n-th root of the size of the n-th power, n = 2^50, by squaring. */
double spectral_radius(int n, double *matrix, double *work)
{
    const size_t count = (size_t)n * (size_t)n;
    double sizes[SQUARINGS + 1], radius = 1.0;
    int turn;
    if (n == 1) {
        return absolute(matrix[0]);
    }
    for (turn = 0; turn <= SQUARINGS; turn++) {
        double size = 0.0;
        size_t k;
        for (k = 0; k < count; k++) {
            size = larger(size, absolute(matrix[k]));
        }
        if (!(size > 0.0)) {
            return 0.0;
        }
        sizes[turn] = size;
        for (k = 0; k < count; k++) {
            work[k] = matrix[k] / size;
        }
        matrix_product(1, n, n, n, work, work, matrix);
    }
    while (turn--) { /* what the t-th was divided by counts by its 2^t-th root */
        radius = sizes[turn] * square_root(radius);
    }
    return radius;
}
