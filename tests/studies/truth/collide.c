/* Rotor and colliding weights as one ordinary differential equation, from contact to contact: an
   independent reference, fast enough for hundreds of revolutions with impacts.

   It shares no code with the units and none with models/reference, whose equations it repeats: the axes are
   fixed, the angles phi of the weights absolute.  With q = (x, y, phi) and lines c of the weights in contact,

       I(q) q'' + C^T l = f,    C q'' = 0,    l >= 0 where they press,

   is solved as it stands by elimination with pivots.  An impact has the least L >= 0 with
   v+ + e v- >= 0, v+ = v- + D L, D = C I^-1 C^T, complementary; every subset of contacts is tried for it.
   Two methods of different kind integrate: Runge-Kutta of order 8 (Prince and Dormand 1981) and
   extrapolation of the midpoint rule (Gragg 1965, Bulirsch and Stoer 1966).  An event is met by the step that
   ends there, so that nothing is interpolated. */
#include <float.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

enum { MOST_STATIONS = 24, MOST_WEIGHTS = 24, MOST_SIZE = 4 * MOST_STATIONS + 2 * MOST_WEIGHTS };
enum { MOST_UNKNOWNS = 2 * MOST_STATIONS + 2 * MOST_WEIGHTS, MOST_TOUCHING = 14 };
enum { MOST_STAGES = 16, MOST_STEPS = 20000000, MOST_EVENTS = 200000, MOST_BLOWS = 100, SHIFTS = 8, ROWS = 6 };
enum { OK, TOO_MANY_STEPS, TOO_MANY_EVENTS, NO_END_OF_IMPACTS, NOT_FINITE, PASSES_THROUGH, TOO_LARGE };
static const double LONGEST = 0.3; /* rad of the fastest turning in a step */
static const double CLOSED = 1e-12, SLACK = 2e-13, OVERLAP = 1e-9, LOWEST = 1e-9; /* rad; SLACK: rounding */

typedef struct {
    int first, second;      /* weights, the second ahead of the first */
    double touching, turns; /* distance at which they touch, whole turns between them [rad] */
    double restitution;
} Contact;

/* Arrays as `compiled.py` fills them: matrices (n, n) by rows, along x and y. */
typedef struct {
    int stations, weights, contacts;
    double *mass, *stiffness[2][2], *damping[2][2], *internal_damping, *gyroscopic;
    double *unbalance;            /* (n, 2) */
    double gravity[2];
    double *row;                  /* (N, n) of the plane of each weight */
    double *own;                  /* (N, 6) mass, track radius, drag, kappa, radius, and */
    double *offset;               /* (N, 2) of its track */
    Contact *between;
    double angle, speed, acceleration; /* of the rotor at time 0, the last constant */
} Machine;

static int unknowns_of(const Machine *m)
{
    return 2 * m->stations + m->weights;
}

/* -- equations ------------------------------------------------------------------------------- */

/* Solve a x = b for `count` right sides that lie behind each other; 1 where a is singular. */
static int eliminate(int size, double *a, int count, double *b)
{
    int i, j, k, r;
    for (k = 0; k < size; k++) {
        int pivot = k;
        for (i = k + 1; i < size; i++) {
            pivot = fabs(a[i * size + k]) > fabs(a[pivot * size + k]) ? i : pivot;
        }
        if (!(fabs(a[pivot * size + k]) > 0.0)) {
            return 1;
        }
        for (j = 0; pivot != k && j < size; j++) {
            const double kept = a[k * size + j];
            a[k * size + j] = a[pivot * size + j];
            a[pivot * size + j] = kept;
        }
        for (r = 0; pivot != k && r < count; r++) {
            const double kept = b[r * size + k];
            b[r * size + k] = b[r * size + pivot];
            b[r * size + pivot] = kept;
        }
        for (i = k + 1; i < size; i++) {
            const double factor = a[i * size + k] / a[k * size + k];
            for (j = k + 1; factor != 0.0 && j < size; j++) {
                a[i * size + j] -= factor * a[k * size + j];
            }
            for (r = 0; factor != 0.0 && r < count; r++) {
                b[r * size + i] -= factor * b[r * size + k];
            }
        }
    }
    for (r = 0; r < count; r++) {
        for (i = size - 1; i >= 0; i--) {
            for (j = i + 1; j < size; j++) {
                b[r * size + i] -= a[i * size + j] * b[r * size + j];
            }
            b[r * size + i] /= a[i * size + i];
        }
    }
    return 0;
}

/* Inertia (size, size) of all coordinates, `size` being at least their number, and forces on them. */
static void fill(const Machine *m, double t, const double *y, int size, double *inertia, double *force)
{
    const int n = m->stations, all = unknowns_of(m);
    const double *x = y, *v = y + 2 * n, *phi = y + 4 * n, *rate = phi + m->weights;
    const double w = m->speed + m->acceleration * t, turned = m->angle + (m->speed + 0.5 * m->acceleration * t) * t;
    const double c = cos(turned), s = sin(turned);
    int i, j, k, a, b;
    memset(inertia, 0, sizeof(double) * (size_t)size * (size_t)size);
    memset(force, 0, sizeof(double) * (size_t)size);
    for (i = 0; i < n; i++) {
        const double u = m->unbalance[2 * i] * c - m->unbalance[2 * i + 1] * s;
        const double o = m->unbalance[2 * i] * s + m->unbalance[2 * i + 1] * c;
        force[i] = w * w * u + m->acceleration * o;
        force[n + i] = w * w * o - m->acceleration * u;
        for (j = 0; j < n; j++) {
            const int at = i * n + j;
            inertia[i * size + j] = inertia[(n + i) * size + n + j] = m->mass[at];
            for (a = 0; a < 2; a++) {
                for (b = 0; b < 2; b++) {
                    force[a * n + i] -=
                        m->stiffness[a][b][at] * x[b * n + j] + m->damping[a][b][at] * v[b * n + j];
                }
            }
            force[i] -= m->internal_damping[at] * (v[j] + w * x[n + j]) + w * m->gyroscopic[at] * v[n + j];
            force[n + i] -= m->internal_damping[at] * (v[n + j] - w * x[j]) - w * m->gyroscopic[at] * v[j];
        }
    }
    for (k = 0; k < m->weights; k++) {
        const double *own = m->own + 6 * k, *row = m->row + k * n;
        const double mass = own[0], track = own[1], rolls = (own[3] - 1.0) * mass * track * track;
        const double arm[2] = {track * cos(phi[k]), track * sin(phi[k])};
        const double off[2] = {m->offset[2 * k] * c - m->offset[2 * k + 1] * s,
                               m->offset[2 * k] * s + m->offset[2 * k + 1] * c};
        const double pull[2] = {w * w * off[0] + m->acceleration * off[1] + rate[k] * rate[k] * arm[0],
                                w * w * off[1] - m->acceleration * off[0] + rate[k] * rate[k] * arm[1]};
        const int here = 2 * n + k;
        inertia[here * size + here] = mass * track * track + rolls;
        force[here] = mass * (arm[0] * pull[1] - arm[1] * pull[0]) - own[2] * track * track * (rate[k] - w) +
                      rolls * (1.0 + own[4] / track) * m->acceleration;
        for (i = 0; i < n; i++) {
            force[i] += row[i] * mass * pull[0];
            force[n + i] += row[i] * mass * pull[1];
            inertia[i * size + here] = inertia[here * size + i] = -row[i] * mass * arm[1];
            inertia[(n + i) * size + here] = inertia[here * size + n + i] = row[i] * mass * arm[0];
            for (j = 0; j < n; j++) {
                inertia[i * size + j] += row[i] * row[j] * mass;
                inertia[(n + i) * size + n + j] += row[i] * row[j] * mass;
            }
        }
    }
    for (k = all; k < size; k++) {
        inertia[k * size + k] = 0.0;
    }
}

/* Accelerations of all coordinates, and how the contacts in `joined` press [N m]. */
static int accelerate(const Machine *m, double t, const double *y, const int *joined, double *a, double *press)
{
    static double matrix[MOST_UNKNOWNS * MOST_UNKNOWNS], right[MOST_UNKNOWNS];
    const int n = m->stations, all = unknowns_of(m);
    int size = all, k, i;
    for (k = 0; k < m->contacts; k++) {
        size += joined[k];
    }
    fill(m, t, y, size, matrix, right);
    for (k = 0, i = all; k < m->contacts; k++) {
        if (joined[k]) {
            const int first = 2 * n + m->between[k].first, second = 2 * n + m->between[k].second;
            /* the push on the first is back, on the second ahead */
            matrix[first * size + i] = matrix[i * size + first] = 1.0;
            matrix[second * size + i] = matrix[i * size + second] = -1.0;
            i++;
        }
    }
    if (eliminate(size, matrix, 1, right)) {
        return NOT_FINITE;
    }
    memcpy(a, right, sizeof(double) * (size_t)all);
    for (k = 0; k < n; k++) {
        a[k] += m->gravity[0];
        a[n + k] += m->gravity[1];
    }
    for (k = 0, i = all; press && k < m->contacts; k++) {
        press[k] = joined[k] ? right[i++] : 0.0;
    }
    return OK;
}

static int derive(const Machine *m, double t, const double *y, const int *joined, double *change)
{
    const int n = m->stations;
    double a[MOST_UNKNOWNS];
    const int wrong = accelerate(m, t, y, joined, a, NULL);
    memcpy(change, y + 2 * n, sizeof(double) * 2 * (size_t)n);
    memcpy(change + 2 * n, a, sizeof(double) * 2 * (size_t)n);
    memcpy(change + 4 * n, y + 4 * n + m->weights, sizeof(double) * (size_t)m->weights);
    memcpy(change + 4 * n + m->weights, a + 2 * n, sizeof(double) * (size_t)m->weights);
    return wrong;
}

/* -- steps ------------------------------------------------------------------------------------ */

/* Coefficients of the method by stages: a (S, S), c, b (S,), and of its two errors (S,). */
typedef struct {
    int stages;
    const double *a, *c, *b, *fifth, *third;
} Stages;

typedef struct {
    const Machine *machine;
    const int *joined;
    const Stages *stages; /* NULL: by extrapolation */
    int size;
    double rtol;
    const double *scale;
} Way;

static double norm(const Way *way, const double *y, const double *z, const double *error)
{
    double sum = 0.0;
    int i;
    for (i = 0; i < way->size; i++) {
        const double allowed = way->rtol * (way->scale[i] + fmax(fabs(y[i]), fabs(z[i])));
        sum += error[i] / allowed * (error[i] / allowed);
    }
    return sqrt(sum / way->size);
}

static int step_by_stages(const Way *way, double t, const double *y, double h, double *z, double *error)
{
    static double stage[MOST_STAGES][MOST_SIZE];
    const Stages *table = way->stages;
    double at[MOST_SIZE], fifth[MOST_SIZE], third[MOST_SIZE], five, three;
    int s, j, i, wrong = OK;
    for (s = 0; s < table->stages; s++) {
        for (i = 0; i < way->size; i++) {
            double sum = 0.0;
            for (j = 0; j < s; j++) {
                sum += table->a[s * table->stages + j] * stage[j][i];
            }
            at[i] = y[i] + h * sum;
        }
        wrong |= derive(way->machine, t + table->c[s] * h, at, way->joined, stage[s]);
    }
    for (i = 0; i < way->size; i++) {
        double sum = 0.0;
        fifth[i] = third[i] = 0.0;
        for (s = 0; s < table->stages; s++) {
            sum += table->b[s] * stage[s][i];
            fifth[i] += h * table->fifth[s] * stage[s][i];
            third[i] += h * table->third[s] * stage[s][i];
        }
        z[i] = y[i] + h * sum;
    }
    five = norm(way, y, z, fifth);
    three = norm(way, y, z, third);
    *error = five > 0.0 ? five * five / sqrt(five * five + 0.01 * three * three) : 0.0;
    return wrong;
}

/* Neville's table of the midpoint rule with 2, 4, 6 ... parts. */
static int step_by_extrapolation(const Way *way, double t, const double *y, double h, double *z, double *error)
{
    static double table[2][ROWS][MOST_SIZE];
    double before[MOST_SIZE], now[MOST_SIZE], change[MOST_SIZE], first[MOST_SIZE], last[MOST_SIZE];
    int row, k, i, j, wrong = derive(way->machine, t, y, way->joined, first);
    for (row = 0; row < ROWS; row++) {
        const int count = 2 * (row + 1);
        const double part = h / count;
        double(*here)[MOST_SIZE] = table[row % 2], (*above)[MOST_SIZE] = table[(row + 1) % 2];
        for (i = 0; i < way->size; i++) {
            before[i] = y[i];
            now[i] = y[i] + part * first[i];
        }
        for (k = 1; k < count; k++) {
            wrong |= derive(way->machine, t + k * part, now, way->joined, change);
            for (i = 0; i < way->size; i++) {
                const double next = before[i] + 2.0 * part * change[i];
                before[i] = now[i];
                now[i] = next;
            }
        }
        wrong |= derive(way->machine, t + h, now, way->joined, change);
        for (i = 0; i < way->size; i++) {
            here[0][i] = 0.5 * (now[i] + before[i] + part * change[i]);
            for (j = 1; j <= row; j++) {
                const double ratio = (double)(row + 1) / (row - j + 1);
                last[i] = (here[j - 1][i] - above[j - 1][i]) / (ratio * ratio - 1.0);
                here[j][i] = here[j - 1][i] + last[i];
            }
        }
    }
    memcpy(z, table[(ROWS - 1) % 2][ROWS - 1], sizeof(double) * (size_t)way->size);
    *error = norm(way, y, z, last);
    return wrong;
}

static int step(const Way *way, double t, const double *y, double h, double *z, double *error)
{
    return way->stages ? step_by_stages(way, t, y, h, z, error) : step_by_extrapolation(way, t, y, h, z, error);
}

/* -- contacts ----------------------------------------------------------------------------------- */

static double gap_of(const Machine *m, const Contact *contact, const double *y)
{
    const double *phi = y + 4 * m->stations;
    return phi[contact->second] - phi[contact->first] + contact->turns - contact->touching;
}

static double opening_of(const Machine *m, const Contact *contact, const double *y)
{
    const double *rate = y + 4 * m->stations + m->weights;
    return rate[contact->second] - rate[contact->first];
}

/* Changes of all rates by a unit push along each contact (count, all), and of the openings (count, count). */
static int respond(const Machine *m, double t, const double *y, int count, const int *which, double *moved,
                   double *response)
{
    static double inertia[MOST_UNKNOWNS * MOST_UNKNOWNS];
    double force[MOST_UNKNOWNS];
    const int all = unknowns_of(m), n = m->stations;
    int k, j;
    fill(m, t, y, all, inertia, force);
    memset(moved, 0, sizeof(double) * (size_t)count * (size_t)all);
    for (k = 0; k < count; k++) {
        const Contact *contact = m->between + which[k];
        moved[k * all + 2 * n + contact->first] -= 1.0;
        moved[k * all + 2 * n + contact->second] += 1.0;
    }
    if (eliminate(all, inertia, count, moved)) {
        return NOT_FINITE;
    }
    for (j = 0; j < count; j++) {
        for (k = 0; k < count; k++) {
            const Contact *contact = m->between + which[j];
            response[j * count + k] =
                moved[k * all + 2 * n + contact->second] - moved[k * all + 2 * n + contact->first];
        }
    }
    return OK;
}

/* l >= 0, w = D l + q >= 0, l w = 0: of all subsets that one which violates least. */
static int complement(int count, const double *response, const double *q, double *found)
{
    double matrix[MOST_TOUCHING * MOST_TOUCHING], l[MOST_TOUCHING], least = DBL_MAX, scale = DBL_MIN;
    unsigned subset;
    int k, j;
    if (count > MOST_TOUCHING) {
        return TOO_LARGE;
    }
    for (k = 0; k < count; k++) {
        scale = fmax(scale, fabs(q[k]));
    }
    for (subset = 0; subset < 1u << count; subset++) {
        int in[MOST_TOUCHING], size = 0;
        double worst = 0.0;
        for (k = 0; k < count; k++) {
            if (subset >> k & 1u) {
                in[size++] = k;
            }
        }
        for (k = 0; k < size; k++) {
            l[k] = -q[in[k]];
            for (j = 0; j < size; j++) {
                matrix[k * size + j] = response[in[k] * count + in[j]];
            }
        }
        if (eliminate(size, matrix, 1, l)) {
            continue;
        }
        for (k = 0; k < size; k++) { /* in units of a speed */
            worst = fmax(worst, -l[k] * response[in[k] * count + in[k]] / scale);
        }
        for (k = 0; k < count; k++) {
            double w = q[k];
            for (j = 0; j < size; j++) {
                w += response[k * count + in[j]] * l[j];
            }
            worst = subset >> k & 1u ? worst : fmax(worst, -w / scale);
        }
        if (worst < least) {
            least = worst;
            memset(found, 0, sizeof(double) * (size_t)count);
            for (k = 0; k < size; k++) {
                found[in[k]] = l[k];
            }
        }
    }
    return least < 1e-6 ? OK : NO_END_OF_IMPACTS;
}

static void push(const Machine *m, int count, const double *moved, const double *impulse, double *y)
{
    const int n = m->stations, all = unknowns_of(m);
    int k, i;
    for (k = 0; k < count; k++) {
        for (i = 0; i < 2 * n; i++) {
            y[2 * n + i] += impulse[k] * moved[k * all + i];
        }
        for (i = 0; i < m->weights; i++) {
            y[4 * n + m->weights + i] += impulse[k] * moved[k * all + 2 * n + i];
        }
    }
}

/* Impacts between neighbours that touch, until none approaches another. */
static int collide(const Machine *m, int count, const int *which, const double *moved, const double *response,
                   double *y)
{
    const double *rate = y + 4 * m->stations + m->weights;
    int blow, k;
    for (blow = 0; blow < MOST_BLOWS; blow++) {
        double q[MOST_TOUCHING], impulse[MOST_TOUCHING], least = 0.0, fastest = 0.0;
        int wrong;
        for (k = 0; k < m->weights; k++) {
            fastest = fmax(fastest, fabs(rate[k]));
        }
        for (k = 0; k < count; k++) {
            const Contact *contact = m->between + which[k];
            const double opening = opening_of(m, contact, y);
            least = fmin(least, opening);
            q[k] = (1.0 + contact->restitution) * opening;
        }
        if (least >= -1e-13 * fastest) {
            return OK;
        }
        if ((wrong = complement(count, response, q, impulse))) {
            return wrong;
        }
        push(m, count, moved, impulse, y);
    }
    return NO_END_OF_IMPACTS;
}

/* Which of the contacts in `joined` press from here on. */
static int hold(const Machine *m, double t, const double *y, int *joined)
{
    double moved[MOST_TOUCHING * MOST_UNKNOWNS], response[MOST_TOUCHING * MOST_TOUCHING];
    double a[MOST_UNKNOWNS], q[MOST_TOUCHING], press[MOST_TOUCHING];
    static const int none[MOST_WEIGHTS] = {0};
    int which[MOST_WEIGHTS], count = 0, k, wrong;
    for (k = 0; k < m->contacts; k++) {
        if (joined[k]) {
            which[count++] = k;
        }
    }
    if (!count) {
        return OK;
    }
    if (count > MOST_TOUCHING) {
        return TOO_LARGE;
    }
    wrong = respond(m, t, y, count, which, moved, response) | accelerate(m, t, y, none, a, NULL);
    for (k = 0; k < count; k++) {
        const Contact *contact = m->between + which[k];
        q[k] = a[2 * m->stations + contact->second] - a[2 * m->stations + contact->first];
    }
    if (wrong || (wrong = complement(count, response, q, press))) {
        return wrong;
    }
    for (k = 0; k < count; k++) {
        joined[which[k]] = press[k] > 0.0;
    }
    return OK;
}

/* Move what touches, and what overlaps, to gaps of zero. */
static void close_gaps(const Machine *m, const int *touches, double *y)
{
    double *phi = y + 4 * m->stations;
    int shift, k;
    for (shift = 0; shift < SHIFTS; shift++) {
        for (k = 0; k < m->contacts; k++) {
            const double gap = gap_of(m, m->between + k, y);
            if (touches[k] || gap < 0.0) {
                phi[m->between[k].first] += 0.5 * gap;
                phi[m->between[k].second] -= 0.5 * gap;
            }
        }
    }
}

/* All that follows where gaps have closed: impacts, the end of bounces that are too low, and contacts. */
static int meet(const Machine *m, double t, double *y, int *joined)
{
    double moved[MOST_TOUCHING * MOST_UNKNOWNS], response[MOST_TOUCHING * MOST_TOUCHING];
    double within[MOST_TOUCHING * MOST_TOUCHING], impulse[MOST_TOUCHING], a[MOST_UNKNOWNS];
    double apart_free[MOST_TOUCHING], press[MOST_TOUCHING];
    static const int none[MOST_WEIGHTS] = {0};
    int touches[MOST_WEIGHTS] = {0}, which[MOST_WEIGHTS], kept[MOST_WEIGHTS], count = 0, left = 0, k, j, wrong;
    for (k = 0; k < m->contacts; k++) {
        touches[k] = joined[k] || gap_of(m, m->between + k, y) <= CLOSED;
        if (touches[k]) {
            which[count++] = k;
        }
    }
    if (count > MOST_TOUCHING) {
        return TOO_LARGE;
    }
    if ((wrong = respond(m, t, y, count, which, moved, response)) ||
        (wrong = collide(m, count, which, moved, response, y)) || (wrong = accelerate(m, t, y, none, a, NULL))) {
        return wrong;
    }
    for (k = 0; k < count; k++) { /* what each would press if all that touch stayed in contact */
        const Contact *contact = m->between + which[k];
        apart_free[k] = a[2 * m->stations + contact->second] - a[2 * m->stations + contact->first];
    }
    if ((wrong = complement(count, response, apart_free, press))) {
        return wrong;
    }
    for (k = 0; k < count; k++) {
        const Contact *contact = m->between + which[k];
        const double apart = fmax(0.0, opening_of(m, contact, y));
        const double pressed = press[k] * response[k * count + k];
        joined[which[k]] = apart * apart <= 2.0 * LOWEST * fmax(pressed, 0.0);
        if (joined[which[k]]) {
            kept[left++] = k;
        }
    }
    for (k = 0; k < left; k++) { /* what bounces no more gives its momentum to the rotor */
        impulse[k] = -opening_of(m, m->between + which[kept[k]], y);
        for (j = 0; j < left; j++) {
            within[k * left + j] = response[kept[k] * count + kept[j]];
        }
    }
    if (left && eliminate(left, within, 1, impulse)) {
        return NOT_FINITE;
    }
    for (k = 0; k < left; k++) {
        push(m, 1, moved + kept[k] * unknowns_of(m), impulse + k, y);
    }
    close_gaps(m, touches, y);
    return hold(m, t, y, joined);
}

/* -- from event to event -------------------------------------------------------------------------- */

/* The least of what must not fall below 0: gaps of `which`, or what joined contacts press. */
static double least_of(const Machine *m, double t, const double *y, const int *joined, const int *which,
                       int *wrong)
{
    double a[MOST_UNKNOWNS], press[MOST_WEIGHTS], least = DBL_MAX;
    int k;
    *wrong |= accelerate(m, t, y, joined, a, press);
    for (k = 0; k < m->contacts; k++) {
        if (which[k]) {
            least = fmin(least, joined[k] ? press[k] : gap_of(m, m->between + k, y) + SLACK);
        }
    }
    return least;
}

/* First time within a step at which a cubic between both ends is least, and below 0; or `h`. */
static double first_dip(const Machine *m, const double *y, const double *z, double h, const int *joined)
{
    double first = h;
    int k, look;
    for (k = 0; k < m->contacts; k++) {
        const Contact *contact = m->between + k;
        const double g0 = gap_of(m, contact, y), g1 = gap_of(m, contact, z);
        const double r0 = h * opening_of(m, contact, y), r1 = h * opening_of(m, contact, z);
        if (joined[k] || !(r0 < 0.0 && r1 > 0.0)) {
            continue;
        }
        for (look = 1; look < 32; look++) {
            const double s = look / 32.0, r = 1.0 - s;
            const double gap = r * r * (g0 * (1.0 + 2.0 * s) + r0 * s) + s * s * (g1 * (1.0 + 2.0 * r) - r1 * r);
            if (gap < 1e-4 * fmin(-r0, r1) && s * h < first) {
                first = s * h;
                break;
            }
        }
    }
    return first;
}

static int all_finite(int count, const double *values)
{
    int i;
    for (i = 0; i < count; i++) {
        if (!(fabs(values[i]) <= DBL_MAX)) {
            return 0;
        }
    }
    return 1;
}

/* The step that ends where the least of `which` is 0, within one of length h at whose end it is below. */
static int step_to_event(const Way *way, double t, const double *y, double h, const int *which, double *z,
                         double *taken)
{
    const Machine *m = way->machine;
    double low = 0.0, high = h, at_low, at_high, error;
    int wrong = OK, k;
    at_low = least_of(m, t, y, way->joined, which, &wrong);
    wrong |= step(way, t, y, h, z, &error);
    at_high = least_of(m, t + h, z, way->joined, which, &wrong);
    at_low = fmax(at_low, 0.0);
    for (k = 0; k < 200 && high - low > 4e-16 * (fabs(t) + h) && !wrong; k++) {
        /* false position, and every third time the middle */
        double at = k % 3 == 2 ? 0.5 * (low + high) : low + (high - low) * at_low / (at_low - at_high), value;
        at = fmin(fmax(at, low + 1e-3 * (high - low)), high - 1e-3 * (high - low));
        wrong |= step(way, t, y, at, z, &error);
        value = least_of(m, t + at, z, way->joined, which, &wrong);
        if (value > 0.0) {
            low = at;
            at_low = value;
        } else {
            high = at;
            at_high = value;
        }
    }
    *taken = high;
    return wrong | step(way, t, y, high, z, &error);
}

static double fastest_of(const Machine *m, double t, const double *y)
{
    double fastest = fabs(m->speed + m->acceleration * t);
    int k;
    for (k = 0; k < m->weights; k++) {
        fastest = fmax(fastest, fabs(y[4 * m->stations + m->weights + k]));
    }
    return fastest;
}

/* Integrate from `begin` through ascending `times`; y (size,) and joined (contacts,) are those of the start,
   then of the end.  states (count, size) and accelerations (count, 2 n + N) are filled.  events: how many. */
int integrate(const Machine *m, const Stages *stages, double rtol, const double *scale, double begin, int begins,
              int count, const double *times, double *y, int *joined, double *states, double *accelerations,
              int *events)
{
    const int size = 4 * m->stations + 2 * m->weights, all = unknowns_of(m);
    const Way way = {m, joined, stages, size, rtol, scale};
    double t = begin, wanted = 0.0, z[MOST_SIZE], press[MOST_WEIGHTS], a[MOST_UNKNOWNS];
    int shown, wrong = OK, k;
    long steps = 0;
    if (m->stations > MOST_STATIONS || m->weights > MOST_WEIGHTS || m->contacts > MOST_WEIGHTS) {
        return TOO_LARGE;
    }
    if (begins) {
        for (k = 0; k < m->contacts; k++) {
            joined[k] = gap_of(m, m->between + k, y) <= CLOSED && opening_of(m, m->between + k, y) == 0.0;
        }
    }
    if ((wrong = hold(m, t, y, joined))) {
        return wrong;
    }
    for (shown = 0; shown < count; shown++) {
        while (t < times[shown]) {
            const double left = times[shown] - t, longest = LONGEST / fmax(fastest_of(m, t, y), 1e-3 / (left + 1e-300));
            double h = fmin(fmin(wanted > 0.0 ? wanted : 1e-2 * longest, longest), left), error, dip;
            int which[MOST_WEIGHTS], any = 0;
            if (++steps > MOST_STEPS) {
                return TOO_MANY_STEPS;
            }
            wrong = step(&way, t, y, h, z, &error);
            if (wrong || !all_finite(size, z) || !(error <= 1.0)) {
                if (!(h > 1e-15 * (fabs(t) + h))) {
                    return NOT_FINITE;
                }
                wanted = h * (error > 1.0 && error < 1e6 ? fmax(0.2, 0.9 * pow(error, -1.0 / 8.0)) : 0.2);
                continue;
            }
            dip = first_dip(m, y, z, h, joined);
            if (dip < h) {
                double before = h;
                h = dip;
                wrong = step(&way, t, y, h, z, &error);
                wanted = before;
            } else if (h < left || wanted == 0.0) {
                wanted = h * fmin(4.0, error > 0.0 ? 0.9 * pow(error, -1.0 / 8.0) : 4.0);
            }
            wrong |= accelerate(m, t + h, z, joined, a, press);
            for (k = 0; k < m->contacts; k++) {
                which[k] = joined[k] ? press[k] < 0.0 : gap_of(m, m->between + k, z) < -SLACK;
                any |= which[k];
            }
            if (any && !wrong) {
                int closes = 0;
                wrong = step_to_event(&way, t, y, h, which, z, &h);
                wrong |= accelerate(m, t + h, z, joined, a, press);
                for (k = 0; k < m->contacts; k++) {
                    const double gap = gap_of(m, m->between + k, z);
                    closes |= !joined[k] && gap <= 0.0;
                    if (gap < -OVERLAP) {
                        return PASSES_THROUGH;
                    }
                }
                if (!wrong) {
                    wrong = closes ? meet(m, t + h, z, joined) : hold(m, t + h, z, joined);
                }
                if (++*events > MOST_EVENTS) {
                    return TOO_MANY_EVENTS;
                }
            }
            if (wrong) {
                return wrong;
            }
            t = h == left ? times[shown] : t + h;
            memcpy(y, z, sizeof(double) * (size_t)size);
        }
        memcpy(states + (size_t)shown * (size_t)size, y, sizeof(double) * (size_t)size);
        if ((wrong = accelerate(m, t, y, joined, accelerations + (size_t)shown * (size_t)all, NULL))) {
            return wrong;
        }
    }
    return OK;
}
