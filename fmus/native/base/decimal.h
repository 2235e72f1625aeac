/* Decimal digits of a number, exact: Steele and White 1990, "How to print floating-point numbers
   accurately", in whole numbers. */
#ifndef AUTOBALANCER_DECIMAL_H
#define AUTOBALANCER_DECIMAL_H

enum { DECIMAL_DIGITS = 20 }; /* of an array that holds those of any number */

/* Digits of value > 0 = d.ddd 10^exponent: as few as tell it from its neighbours (asked = 0), or as
   many as asked, rounded.  Returns how many. */
int decimal(double value, int asked, char *digits, int *exponent);

#endif
