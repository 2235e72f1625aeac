/* The rotor's angle as whole turns and a remainder, so that sums over any time add no error. */
#ifndef AUTOBALANCER_ANGLE_H
#define AUTOBALANCER_ANGLE_H

#include "fmi/fields.h"

enum { TURNS, REST, CARRY, ANGLE_SIZE };

void angle_fields(Fields *fields);

/* An angle [rad], and one turned by so much; Kahan's summation. */
void angle_start(double *angle, double start);
void angle_turn(double *angle, double by);
/* The angle as one number [rad], with the digits of its size. */
double angle_total(const double *angle);

#endif
