/* Complex numbers as pairs: C's own are not known to every compiler.

   An array of complex numbers is an array of doubles, real and imaginary part alternating, and may
   be read as an array of `Complex`. */
#ifndef AUTOBALANCER_COMPLEX_NUMBER_H
#define AUTOBALANCER_COMPLEX_NUMBER_H

typedef struct {
    double re, im;
} Complex;

static inline Complex complex_of(double re, double im)
{
    Complex z;
    z.re = re;
    z.im = im;
    return z;
}

static inline Complex complex_sum(Complex a, Complex b)
{
    return complex_of(a.re + b.re, a.im + b.im);
}

static inline Complex complex_difference(Complex a, Complex b)
{
    return complex_of(a.re - b.re, a.im - b.im);
}

static inline Complex complex_scaled(double factor, Complex a)
{
    return complex_of(factor * a.re, factor * a.im);
}

static inline Complex complex_product(Complex a, Complex b)
{
    return complex_of(a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re);
}

static inline Complex complex_conjugate(Complex a)
{
    return complex_of(a.re, -a.im);
}

#endif
