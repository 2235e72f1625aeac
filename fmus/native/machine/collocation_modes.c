/* The linear systems of a collocation: one of as many unknowns as the machine has, by each eigenvalue of the rule. */
#include "machine/collocation.h"

#include "base/elementary.h"

static Complex quotient(Complex a, Complex b)
{
    const double over = 1.0 / (b.re * b.re + b.im * b.im);
    return complex_scaled(over, complex_product(a, complex_conjugate(b)));
}

/* Factors of a matrix (d, d), with the rows that are exchanged; 1 where it is singular. */
static int factorise_complex(int d, Complex *a, int *rows)
{
    int i, j, k;
    for (k = 0; k < d; k++) {
        double most = 0.0;
        rows[k] = k;
        for (i = k; i < d; i++) {
            const double size = larger(absolute(a[i * d + k].re), absolute(a[i * d + k].im));
            if (size > most) {
                most = size;
                rows[k] = i;
            }
        }
        if (!(most > 0.0)) {
            return 1;
        }
        for (j = 0; j < d; j++) {
            const Complex kept = a[k * d + j];
            a[k * d + j] = a[rows[k] * d + j];
            a[rows[k] * d + j] = kept;
        }
        for (i = k + 1; i < d; i++) {
            const Complex part = quotient(a[i * d + k], a[k * d + k]);
            a[i * d + k] = part;
            for (j = k + 1; j < d; j++) {
                a[i * d + j] = complex_difference(a[i * d + j], complex_product(part, a[k * d + j]));
            }
        }
    }
    return 0;
}

/* b becomes the solution. */
static void solve_complex(int d, const Complex *a, const int *rows, Complex *b)
{
    int i, k;
    for (k = 0; k < d; k++) {
        const Complex kept = b[k];
        b[k] = b[rows[k]];
        b[rows[k]] = kept;
    }
    for (i = 0; i < d; i++) {
        for (k = 0; k < i; k++) {
            b[i] = complex_difference(b[i], complex_product(a[i * d + k], b[k]));
        }
    }
    for (i = d - 1; i >= 0; i--) {
        for (k = i + 1; k < d; k++) {
            b[i] = complex_difference(b[i], complex_product(a[i * d + k], b[k]));
        }
        b[i] = quotient(b[i], a[i * d + i]);
    }
}

/* Factors of 1 - h s V - (h s)^2 P for an eigenvalue s and the derivatives by speeds V and places P, of weights apart
   its diagonal alone; 1 where it is singular. */
static int factorise_mode(const Collocation *c, int mode, double length)
{
    const int d = c->unknowns, next = c->are_apart ? d + 1 : 1;
    const Complex first = complex_scaled(length, c->rule->values[mode]), second = complex_product(first, first);
    Complex *a = c->factors + (size_t)(mode * d) * (size_t)d;
    int i;
    for (i = 0; i < d * d; i += next) {
        a[i] = complex_scaled(-1.0, complex_sum(complex_scaled(c->by_speed[i], first),
                                                complex_scaled(c->by_place[i], second)));
    }
    for (i = 0; i < d; i++) {
        a[i * d + i].re += 1.0;
    }
    return next == 1 && factorise_complex(d, a, c->rows + mode * d);
}

int collocation_factorise(const Collocation *c, double length)
{
    int k;
    for (k = 0; k < c->rule->modes; k++) {
        if (factorise_mode(c, k, length)) {
            return 1;
        }
    }
    return 0;
}

void collocation_solve_mode(const Collocation *c, int mode)
{
    const int d = c->unknowns;
    const Complex *a = c->factors + (size_t)(mode * d) * (size_t)d;
    int i;
    if (!c->are_apart) {
        solve_complex(d, a, c->rows + mode * d, c->right);
        return;
    }
    for (i = 0; i < d; i++) {
        c->right[i] = quotient(c->right[i], a[i * d + i]);
    }
}
