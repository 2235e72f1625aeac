/* Fixed-step Runge-Kutta of a rotor with point weights, in fixed axes and in one piece.

   q = (x of n stations, y of n stations), weights at angles p in fixed axes:
     (M + sum s s^T m) q'' + (D0 + w D1) q' + (K0 + w K1) q
         = u (w^2 cos, sin - w' ...) + sum s m R (p'^2 e - p'' e_t)
     kappa m R p'' = (kappa - 1) m R w' - h R (p' - w) - m (y'' cos p - x'' sin p)
   with e = (cos p, sin p), e_t = (-sin p, cos p) at the weight's plane.  Constants of the weights'
   equation: a weight that rolls and keeps its rest in the turning rotor. */

#include <math.h>
#include <string.h>

#define DOF 12
#define MOST 16

typedef struct {
    int n, weights, corners, windows;
    double mass[DOF * DOF];              /* 2n x 2n, weights' masses included */
    double d0[DOF * DOF], d1[DOF * DOF], k0[DOF * DOF], k1[DOF * DOF];
    double ux[DOF], uy[DOF];             /* generalised unbalance, rotor axes, n each */
    double planes[MOST * DOF];           /* n shares of each weight's plane */
    double m[MOST], radius[MOST], kappa[MOST], drag[MOST];
    double times[16], speeds[16];
    double step, end;
} Machine;

static void drive(const Machine *a, double t, double *angle, double *speed, double *rate)
{
    double turned = 0.0;
    for (int k = 1; k < a->corners; k++) {
        double length = a->times[k] - a->times[k - 1];
        double slope = (a->speeds[k] - a->speeds[k - 1]) / length;
        if (t < a->times[k]) {
            double s = t - a->times[k - 1];
            *angle = turned + s * (a->speeds[k - 1] + 0.5 * slope * s);
            *speed = a->speeds[k - 1] + slope * s;
            *rate = slope;
            return;
        }
        turned += 0.5 * length * (a->speeds[k] + a->speeds[k - 1]);
    }
    *speed = a->speeds[a->corners - 1];
    *angle = turned + (t - a->times[a->corners - 1]) * *speed;
    *rate = 0.0;
}

/* state: q (2n), q' (2n), p (N), p' (N) */
static void slope(const Machine *a, double t, const double *y, double *f)
{
    int n = a->n, d = 2 * n, N = a->weights;
    double angle, w, rate, force[DOF], matrix[DOF * DOF], c[MOST], s[MOST], free[MOST];
    const double *q = y, *v = y + d, *p = y + 2 * d, *r = p + N;
    drive(a, t, &angle, &w, &rate);
    double cb = cos(angle), sb = sin(angle);
    for (int i = 0; i < n; i++) {
        double re = a->ux[i] * cb - a->uy[i] * sb, im = a->ux[i] * sb + a->uy[i] * cb;
        force[i] = re * w * w + im * rate;
        force[n + i] = im * w * w - re * rate;
    }
    for (int i = 0; i < d; i++) {
        double sum = 0.0;
        for (int j = 0; j < d; j++)
            sum += (a->d0[i * d + j] + w * a->d1[i * d + j]) * v[j] + (a->k0[i * d + j] + w * a->k1[i * d + j]) * q[j];
        force[i] -= sum;
    }
    memcpy(matrix, a->mass, sizeof(double) * (size_t)(d * d));
    for (int k = 0; k < N; k++) {
        const double *row = a->planes + k * n;
        c[k] = cos(p[k]);
        s[k] = sin(p[k]);
        double m = a->m[k], R = a->radius[k], kappa = a->kappa[k];
        free[k] = ((kappa - 1.0) * m * R * rate - a->drag[k] * R * (r[k] - w)) / (kappa * m * R);
        for (int i = 0; i < n; i++) {
            force[i] += row[i] * m * R * (r[k] * r[k] * c[k] + free[k] * s[k]);
            force[n + i] += row[i] * m * R * (r[k] * r[k] * s[k] - free[k] * c[k]);
        }
        /* p'' = free + (x'' sin p - y'' cos p)/(kappa R): the part with q'' to the left side */
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++) {
                double g = row[i] * row[j] * m / kappa;
                matrix[i * d + j] -= g * s[k] * s[k];
                matrix[i * d + n + j] += g * s[k] * c[k];
                matrix[(n + i) * d + j] += g * s[k] * c[k];
                matrix[(n + i) * d + n + j] -= g * c[k] * c[k];
            }
    }
    for (int i = 0; i < d; i++) {            /* Gauss: symmetric and positive definite */
        double pivot = 1.0 / matrix[i * d + i];
        for (int j = i + 1; j < d; j++) {
            double part = matrix[j * d + i] * pivot;
            for (int l = i; l < d; l++)
                matrix[j * d + l] -= part * matrix[i * d + l];
            force[j] -= part * force[i];
        }
    }
    for (int i = d - 1; i >= 0; i--) {
        double sum = force[i];
        for (int j = i + 1; j < d; j++)
            sum -= matrix[i * d + j] * f[d + j];
        f[d + i] = sum / matrix[i * d + i];
    }
    memcpy(f, v, sizeof(double) * (size_t)d);
    for (int k = 0; k < N; k++) {
        const double *row = a->planes + k * n;
        double x = 0.0, z = 0.0;
        for (int i = 0; i < n; i++) {
            x += row[i] * f[d + i];
            z += row[i] * f[d + n + i];
        }
        f[2 * d + k] = r[k];
        f[2 * d + N + k] = free[k] + (x * s[k] - z * c[k]) / (a->kappa[k] * a->radius[k]);
    }
}

/* Of every window: rotor's speed, largest distance of any station, then of each weight its mean,
   smallest and largest speed.  `y` holds the state at the start and the end. */
int integrate(const Machine *a, double *y, double *found)
{
    int size = 4 * a->n + 2 * a->weights, N = a->weights, n = a->n;
    double k1[4 * DOF + 2 * MOST], k2[4 * DOF + 2 * MOST], k3[4 * DOF + 2 * MOST], k4[4 * DOF + 2 * MOST], z[4 * DOF + 2 * MOST];
    long steps = (long)ceil(a->end / a->step), done = 0;
    double h = a->end / (double)steps;
    int width = 2 + 3 * N;
    for (int window = 0; window < a->windows; window++) {
        long until = steps * (window + 1) / a->windows;
        double largest = 0.0, low[MOST], high[MOST], first[MOST], begun = (double)done * h;
        for (int k = 0; k < N; k++) {
            low[k] = 1e300;
            high[k] = -1e300;
            first[k] = y[4 * n + k];
        }
        for (; done < until; done++) {
            double t = (double)done * h;
            slope(a, t, y, k1);
            for (int i = 0; i < size; i++) z[i] = y[i] + 0.5 * h * k1[i];
            slope(a, t + 0.5 * h, z, k2);
            for (int i = 0; i < size; i++) z[i] = y[i] + 0.5 * h * k2[i];
            slope(a, t + 0.5 * h, z, k3);
            for (int i = 0; i < size; i++) z[i] = y[i] + h * k3[i];
            slope(a, t + h, z, k4);
            for (int i = 0; i < size; i++) y[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
            for (int i = 0; i < n; i++) {
                double r = y[i] * y[i] + y[n + i] * y[n + i];
                if (r > largest) largest = r;
            }
            for (int k = 0; k < N; k++) {
                double rate = y[4 * n + N + k];
                if (rate < low[k]) low[k] = rate;
                if (rate > high[k]) high[k] = rate;
            }
        }
        double *row = found + window * width, angle, speed, rate, length = (double)done * h - begun;
        drive(a, (double)done * h, &angle, &speed, &rate);
        row[0] = speed;
        row[1] = sqrt(largest);
        for (int k = 0; k < N; k++) {
            row[2 + 3 * k] = (y[4 * n + k] - first[k]) / length;
            row[3 + 3 * k] = low[k];
            row[4 + 3 * k] = high[k];
        }
        if (!isfinite(y[0])) return 1;
    }
    return 0;
}
