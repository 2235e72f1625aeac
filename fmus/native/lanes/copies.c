/* A text of its own: copies of the recurrence of machine/ for plain machines, with what only some processors have
   (AVX2, on x86-64).  Elsewhere they are for any processor. */
#include "lanes/lane_names.h"

#include <string.h>

#include "lanes/copies.h"
#include "lanes/two_weights.h"
#include "machine/factors.c"
#include "machine/orders_copies.h"
#include "machine/race_series.c"
#include "machine/unknowns.c"
#include "machine/weights_series.c"

void copies_expand_simple(Machine *m, double angle, int order)
{
    expand_simple(m, angle, order);
}

void copies_go_through(const Machine *m, int order, bool is_beside)
{
    go_through_copy(m, order, is_beside);
}

/* Two columns that stand side by side. */
static inline Pairs columns_at(const Pair *at)
{
    Pairs made;
    memcpy(&made, at, sizeof made);
    return made;
}

#define SUM sum_of_columns
#define Sum Pairs
#define Time double
#define Coefficient Pair
#define AT(at) columns_at(at)
#define PLUS(a, b) ((a) + (b))
#define TIMES(a, time) ((a) * (time))
#include "base/series_sum_template.h"

void copies_reach_end(Machine *m, int order, double time)
{
    int i;
    for (i = 0; i < m->width; i += 2) { /* behind the last column the next order begins, which the next step writes anew */
        const Pairs q = sum_of_columns(m->motion + i, m->width, order, time);
        const Pairs v = sum_of_columns(m->velocity + i, m->width, order - 1, time);
        memcpy(m->motion + i, &q, sizeof q);
        memcpy(m->velocity + i, &v, sizeof v);
    }
}
