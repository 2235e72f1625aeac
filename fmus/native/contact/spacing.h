/* Weights of radius r whose centres share a circle of radius R: how close, and how many. */
#ifndef AUTOBALANCER_SPACING_H
#define AUTOBALANCER_SPACING_H

#include <stdbool.h>

/* alpha, half the angle between neighbours that touch [rad]; NaN when they cannot share a track. */
double half_angle(double radius, double track);

/* Radius at which `count` weights fill a track [m]; one weight: that of the track. */
double largest_radius(int count, double track);

/* Whether `count` weights have room on a track. */
bool fits(int count, double radius, double track);

#endif
