#include "rotor/shaft.h"

#include <stddef.h>

#include "base/elementary.h"
#include "base/matrix.h"
#include "constants.h"

void bending_rows(int n, const double *z, int p, int q, double *rows)
{
    int j, row = 0;
    fill_doubles((size_t)(n - 2) * n, 0.0, rows);
    for (j = 0; j < n; j++) {
        if (j != p && j != q) {
            const double share = (z[j] - z[p]) / (z[q] - z[p]);
            rows[row * n + j] = 1.0;
            rows[row * n + p] -= 1.0 - share;
            rows[row * n + q] -= share;
            row++;
        }
    }
}

void beam_compliance(int n, const double *z, const double *rows, double bending_stiffness,
                     double *delta, double *scratch)
{
    const int size = n - 2;
    int i, j, k;
    for (i = 0; i < size; i++) {
        for (j = 0; j < n; j++) {
            double sum = 0.0;
            for (k = 0; k < n; k++) {
                const double distance = absolute(z[k] - z[j]);
                sum += rows[i * n + k] * (distance * distance * distance);
            }
            scratch[i * n + j] = sum;
        }
    }
    for (i = 0; i < size; i++) {
        for (j = 0; j < size; j++) {
            double sum = 0.0;
            for (k = 0; k < n; k++) {
                sum += scratch[i * n + k] * rows[j * n + k];
            }
            delta[i * size + j] = sum / (12.0 * bending_stiffness);
        }
    }
    for (i = 0; i < size; i++) {
        for (j = 0; j < i; j++) {
            const double mean = (delta[i * size + j] + delta[j * size + i]) / 2.0;
            delta[i * size + j] = delta[j * size + i] = mean;
        }
    }
}

void beam_shares(int n, const double *z, double position, double *shares, double *scratch)
{
    double *moments = scratch, *pivots = scratch + n; /* of the adjoint spline; at both ends 0 */
    int i, left = 0;
    double h, a, b;
    while (left < n - 2 && z[left + 1] <= position) {
        left++;
    }
    h = z[left + 1] - z[left];
    b = (position - z[left]) / h;
    a = 1.0 - b;
    fill_doubles((size_t)n, 0.0, shares);
    fill_doubles((size_t)n, 0.0, moments);
    shares[left] = a;
    shares[left + 1] = b;
    moments[left] = (a * a * a - a) * h * h / 6.0;
    moments[left + 1] = (b * b * b - b) * h * h / 6.0;
    moments[0] = moments[n - 1] = 0.0;
    for (i = 1; i < n - 1; i++) { /* Thomas: the spline's matrix is tridiagonal and dominant */
        const double below = (z[i] - z[i - 1]) / 6.0;
        pivots[i] = (z[i + 1] - z[i - 1]) / 3.0;
        if (i > 1) {
            pivots[i] -= below * below / pivots[i - 1];
            moments[i] -= below / pivots[i - 1] * moments[i - 1];
        }
    }
    for (i = n - 2; i > 0; i--) {
        moments[i] = (moments[i] - (z[i + 1] - z[i]) / 6.0 * moments[i + 1]) / pivots[i];
    }
    for (i = 1; i < n - 1; i++) {
        const double below = moments[i] / (z[i] - z[i - 1]), above = moments[i] / (z[i + 1] - z[i]);
        shares[i - 1] += below;
        shares[i] -= below + above;
        shares[i + 1] += above;
    }
}

int given_compliance(int size, const double *compliance, double *delta, Failure *failure)
{
    double scale = 0.0;
    int i, j, fits = 1;
    for (i = 0; i < size * size; i++) {
        delta[i] = compliance[i];
        scale = larger(scale, absolute(compliance[i]));
    }
    for (i = 0; i < size; i++) {
        for (j = 0; j <= i; j++) {
            const double a = compliance[i * size + j], b = compliance[j * size + i];
            if (!(absolute(a - b) <= SHAFT_SYMMETRIC * scale)) { /* NaN fails too */
                fits = 0;
            }
            delta[i * size + j] = delta[j * size + i] = (a + b) / 2.0;
        }
    }
    return fits ? FINE : fail(failure, "compliance: must be finite and symmetric (Maxwell's reciprocity)");
}

/* Lower triangle of delta scaled to a unit diagonal; 0, or 1 when it is not positive definite. */
static int cholesky(int size, const double *delta, const double *scale, double *lower)
{
    int i, j, k;
    for (i = 0; i < size; i++) {
        for (j = 0; j <= i; j++) {
            double rest = delta[i * size + j] / (scale[i] * scale[j]);
            for (k = 0; k < j; k++) {
                rest -= lower[i * size + k] * lower[j * size + k];
            }
            if (i > j) {
                lower[i * size + j] = rest / lower[j * size + j];
            } else if (rest > SHAFT_SINGULAR) { /* NaN fails too */
                lower[i * size + i] = square_root(rest);
            } else {
                return 1;
            }
        }
    }
    return 0;
}

int shaft_stiffness(int n, const double *delta, const double *rows, double *stiffness,
                    double *scratch, Failure *failure)
{
    const int size = n - 2;
    double *lower = scratch, *bent = lower + size * size, *scale = bent + size * n;
    int i, j, k;
    /* scaled: discs close to a support are stiffer by orders of magnitude */
    for (i = 0; i < size; i++) {
        scale[i] = square_root(absolute(delta[i * size + i]));
    }
    if (cholesky(size, delta, scale, lower)) {
        return fail(failure, "compliance = %l m/N: must be positive definite: every load bends the shaft "
                    "its own way (are two stations almost at one place?)",
                    delta, (size_t)(size * size));
    }
    for (i = 0; i < size; i++) {
        for (j = 0; j < n; j++) {
            double rest = rows[i * n + j] / scale[i];
            for (k = 0; k < i; k++) {
                rest -= lower[i * size + k] * bent[k * n + j];
            }
            bent[i * n + j] = rest / lower[i * size + i];
        }
    }
    for (i = 0; i < n; i++) {
        for (j = 0; j < n; j++) {
            double sum = 0.0;
            for (k = 0; k < size; k++) {
                sum += bent[k * n + i] * bent[k * n + j];
            }
            stiffness[i * n + j] = sum;
        }
    }
    return FINE;
}
