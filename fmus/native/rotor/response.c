#include "rotor/response.h"

#include "base/elementary.h"

enum { LAST_PHI = SIGNAL_ORDERS + 1 };

void phi_functions(double z, double *phi)
{
    static const double factorials[LAST_PHI + 1] = {1.0, 1.0, 2.0, 6.0, 24.0, 120.0};
    double term, last;
    int j = LAST_PHI, k;
    if (z < -1.0) {
        phi[0] = natural_exp(z);
        for (k = 0; k < LAST_PHI; k++) {
            phi[k + 1] = (phi[k] - 1.0 / factorials[k]) / z;
        }
        return;
    }
    /* upward recursion loses digits for small |z|: sum the last one, the others follow downward */
    term = last = 1.0 / factorials[LAST_PHI];
    while (absolute(term) > 1e-18 * last) {
        j++;
        term *= z / j;
        last += term;
    }
    phi[LAST_PHI] = last;
    for (k = LAST_PHI - 1; k >= 0; k--) {
        phi[k] = z * phi[k + 1] + 1.0 / factorials[k];
    }
}

Quadrature quadrature_empty(void)
{
    Quadrature empty = {-1.0, -1.0, {0.0}};
    return empty;
}

const double *quadrature(Quadrature *memory, double damping_rate, double step)
{
    double phi[LAST_PHI + 1], power = 1.0;
    int k;
    if (memory->damping_rate != damping_rate || memory->step != step) {
        phi_functions(-damping_rate * step, phi);
        for (k = 0; k < LAST_PHI; k++) {
            memory->response[k] = power * phi[k];
            power *= step;
            memory->response[LAST_PHI + k] = power * phi[k + 1];
        }
        memory->damping_rate = damping_rate;
        memory->step = step;
    }
    return memory->response;
}
