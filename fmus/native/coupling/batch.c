#include "coupling/batch.h"

#include <string.h>

#include "base/elementary.h"
#include "coupling/batch_run.h"

size_t autobalancer_runs(const char *token, const Batch *batch, size_t runs, const double *values,
                         const double *ends, double *signals, double *last, char *reasons)
{
    BatchCall all = {batch, runs, 0, 0, values, ends, signals, last, reasons};
    BatchRun lanes[LANES];
    const int most = side_by_side_most(), asked = batch->side_by_side, wanted = asked < 1 || asked > most ? most : asked;
    int count = 0, k;
    memset(reasons, 0, runs * BATCH_REASON);
    memset(lanes, 0, sizeof lanes);
    while (count < wanted && (size_t)count < runs && !batch_run_open(lanes + count, token, &all)) {
        count++;
    }
    if (!count && runs) {
        batch_refuse_all(&all);
    }
    side_by_side_run(lanes, count, &all);
    for (k = 0; k < count; k++) {
        unit_free(lanes[k].unit);
    }
    return all.failed;
}
