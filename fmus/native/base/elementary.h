/* Elementary functions from + - * / and sqrt alone: the same bits on every platform.

   A system's own sin, cos and exp differ in the last digit from platform to platform, and asking
   for them would tie the library to one C library. */
#ifndef AUTOBALANCER_ELEMENTARY_H
#define AUTOBALANCER_ELEMENTARY_H

#include <math.h> /* sqrt, fabs and copysign, which are instructions */
#include <stdbool.h>

#include "base/complex_number.h"

#define PI 3.14159265358979323846
#define TAU 6.28318530717958647692 /* 2 pi */

/* Of a function that is put in line wherever it is called: who compiles the libraries says how. */
#ifndef IN_LINE
#define IN_LINE
#endif

/* True when x is neither infinite nor NaN. */
static inline bool is_finite(double x)
{
    return x - x == 0.0;
}

static inline double square_root(double x) /* correctly rounded */
{
    return sqrt(x);
}

static inline double absolute(double x)
{
    return fabs(x);
}

static inline double larger(double a, double b) /* a unless b > a */
{
    return b > a ? b : a;
}

static inline double smaller(double a, double b) /* a unless b < a */
{
    return b < a ? b : a;
}

static inline double copy_sign(double size, double sign)
{
    return copysign(size, sign);
}

static inline double infinity(void)
{
    return INFINITY;
}

static inline double not_a_number(void)
{
    return NAN;
}

double nearest(double x); /* integer, halves to even: Python's round */

/* x = fraction 2^exponent with a fraction of 1/2 to 1; 0 for 0, infinite and NaN. */
int binary_exponent(double x);
/* x 2^exponent, rounded once. */
double scaled_by_power(double x, int exponent);

/* sin and cos, below 1 ulp for |x| up to 2^52; beyond, where neighbouring numbers are more than a
   radian apart, still on the unit circle and the same everywhere, without a true digit.  NaN for
   infinite x. */
double sine(double x);
double cosine(double x);
/* size e^{i angle}: Python's cmath.rect. */
Complex rect(double size, double angle);

/* e^{i angle}. */
typedef struct {
    double angle;
    Complex turn;
} Turned;

/* The same of the last two angles asked for, at first not a number: passes ask for the ends of a
   step again and again.  kept (2,), or NULL. */
Complex turned_by(Turned *cache, double angle);

double natural_exp(double x);  /* e^x, below 1 ulp */
double arc_sine(double x);     /* -1 to 1, below 1 ulp; NaN beyond */
double hypotenuse(double x, double y); /* sqrt(x^2 + y^2), below 0.6 ulp, no overflow within */
double magnitude(Complex z);   /* |z|, below 1.1 ulp */

double sum_of(const double *values, int count); /* one after the other */

/* Exact: x less a whole multiple of y > 0.  Python's x % y and math.remainder(x, y). */
double modulo(double x, double y);
double ieee_remainder(double x, double y);

#endif
