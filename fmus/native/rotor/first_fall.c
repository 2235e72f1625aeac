#include "rotor/first_fall.h"

#include "base/elementary.h"
#include "base/matrix.h"
#include "base/roots.h"

static const double TOUCH_OF_ZERO = 1e-13; /* a polynomial that is negative on less only touches 0 */
static const double TO_ROUNDING = 1e-15; /* of an interval; brackets cannot be much shorter */

typedef struct {
    const double *coefficients;
    int count;
} Polynomial;

static double polynomial_value(void *context, double s)
{
    const Polynomial *polynomial = context;
    double total = 0.0;
    int k;
    for (k = polynomial->count - 1; k >= 0; k--) {
        total = total * s + polynomial->coefficients[k];
    }
    return total;
}

void polynomial_about(const double *coefficients, int count, double s, double *shifted)
{
    int first, k;
    copy_doubles((size_t)count, coefficients, shifted);
    for (first = 0; first < count - 1 && s != 0.0; first++) {
        for (k = count - 2; k >= first; k--) {
            shifted[k] += s * shifted[k + 1];
        }
    }
}

/* As find_first_fall in an interval, halved until the polynomial or its slope has one sign. */
static double fall_within(const double *coefficients, int count, double begin, double end)
{
    const double width = end - begin, middle = 0.5 * (begin + end);
    double here[MOST_COEFFICIENTS], power = width, moved = 0.0, bent = 0.0, slope = 0.0, found;
    Polynomial polynomial;
    int k;
    polynomial_about(coefficients, count, begin, here);
    for (k = 1; k < count; k++, power *= width) {
        const double size = absolute(here[k]) * power;
        moved += size;
        slope = k == 1 ? size : slope;
        bent += k == 1 ? 0.0 : k * size;
    }
    if (here[0] > moved) {
        return infinity();
    }
    if (slope > bent || count == 1 || width < TOUCH_OF_ZERO) {
        polynomial.coefficients = here;
        polynomial.count = count;
        if (polynomial_value(&polynomial, width) >= 0.0) {
            return infinity();
        }
        return begin + find_crossing(polynomial_value, &polynomial, larger(here[0], 0.0), width,
                                TO_ROUNDING * width);
    }
    found = fall_within(coefficients, count, begin, middle);
    return is_finite(found) ? found : fall_within(coefficients, count, middle, end);
}

double find_first_fall(const double *coefficients, int count, double until, const double *rounding)
{
    double others = 0.0;
    int first = 0, k;
    while (first < count &&
           !(absolute(coefficients[first]) > (first < 3 ? rounding[first] : 0.0))) {
        first++;
    }
    for (k = first + 1; k < count; k++) {
        others += absolute(coefficients[k]);
    }
    if (first == count || coefficients[first] > others) {
        return infinity();
    }
    return coefficients[first] < 0.0
               ? 0.0
               : fall_within(coefficients + first, count - first, 0.0, until);
}
