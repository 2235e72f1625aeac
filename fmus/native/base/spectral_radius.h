/* The largest modulus of the eigenvalues of a matrix. */
#ifndef AUTOBALANCER_SPECTRAL_RADIUS_H
#define AUTOBALANCER_SPECTRAL_RADIUS_H

/* Of a (n, n) matrix, which is overwritten; work: (n, n). */
double spectral_radius(int n, double *matrix, double *work);

#endif
