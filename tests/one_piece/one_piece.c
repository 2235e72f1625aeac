/* Two weights on a planar rotor at constant speed in one piece, by the eighth-order formula of Dormand
   and Prince with fixed steps: the least that a coupling in C could take.  Coefficients are SciPy's, in
   coefficients.h. */
#include <math.h>
#include <time.h>

#include "coefficients.h" /* STAGES, A[STAGES][STAGES], B[STAGES], C[STAGES] */

enum { X, Y, ANGLE = 2, VX = 4, VY, RATE = 6, SIZE = 8, WEIGHTS = 2 };

typedef struct {
    double mass, stiffness[2], damping[2], unbalance; /* of the rotor */
    double weight, radius, kappa, drag;               /* of each weight, and its track */
    double speed;
} Machine;

/* Absolute angles of the weights: q = (x, y, angles, and their rates). */
static void slope(const Machine *m, double time, const double *q, double *dq)
{
    const double turn = m->speed * time, pull = m->unbalance * m->speed * m->speed;
    const double share = m->weight / m->kappa, slowing = m->drag / (m->kappa * m->weight);
    double fx = pull * cos(turn) - m->damping[0] * q[VX] - m->stiffness[0] * q[X];
    double fy = pull * sin(turn) - m->damping[1] * q[VY] - m->stiffness[1] * q[Y];
    double xx = m->mass + WEIGHTS * m->weight, yy = xx, xy = 0.0, s[WEIGHTS], c[WEIGHTS];
    double braked[WEIGHTS], ax, ay, det;
    int k;
    for (k = 0; k < WEIGHTS; k++) {
        const double rate = q[RATE + k], moment = m->weight * m->radius;
        s[k] = sin(q[ANGLE + k]);
        c[k] = cos(q[ANGLE + k]);
        braked[k] = -slowing * (rate - m->speed);
        fx += moment * (rate * rate * c[k] + braked[k] * s[k]);
        fy += moment * (rate * rate * s[k] - braked[k] * c[k]);
        xx -= share * s[k] * s[k];
        yy -= share * c[k] * c[k];
        xy += share * s[k] * c[k];
    }
    det = xx * yy - xy * xy;
    ax = (yy * fx - xy * fy) / det;
    ay = (xx * fy - xy * fx) / det;
    for (k = 0; k < 4; k++) {
        dq[k] = q[4 + k];
    }
    dq[VX] = ax;
    dq[VY] = ay;
    for (k = 0; k < WEIGHTS; k++) {
        dq[RATE + k] = braked[k] - (ay * c[k] - ax * s[k]) / (m->kappa * m->radius);
    }
}

/* Integrate from q over `steps` of `step` [s]; rows (steps + 1, SIZE) of states; processor time [s]. */
double one_piece(const Machine *m, const double *start, long steps, double step, double *rows)
{
    const clock_t begun = clock();
    double slopes[STAGES][SIZE], q[SIZE], at[SIZE];
    long n;
    int i, j, k;
    for (k = 0; k < SIZE; k++) {
        rows[k] = q[k] = start[k];
    }
    for (n = 0; n < steps; n++) {
        const double time = (double)n * step;
        for (i = 0; i < STAGES; i++) {
            for (k = 0; k < SIZE; k++) {
                double sum = 0.0;
                for (j = 0; j < i; j++) {
                    sum += A[i][j] * slopes[j][k];
                }
                at[k] = q[k] + step * sum;
            }
            slope(m, time + C[i] * step, at, slopes[i]);
        }
        for (k = 0; k < SIZE; k++) {
            double sum = 0.0;
            for (i = 0; i < STAGES; i++) {
                sum += B[i] * slopes[i][k];
            }
            rows[(n + 1) * SIZE + k] = q[k] += step * sum;
        }
    }
    return (double)(clock() - begun) / CLOCKS_PER_SEC;
}
