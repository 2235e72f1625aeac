/* A host in plain C: the same short run many times over, and in many threads at once.

       cycles LIBRARY GUID RESOURCES CYCLES THREADS REFERENCE...

   Prints the time of a cycle [us] and the growth of the memory [kB]; fails where a run does not end
   with the bits of the first one. */
#include <dlfcn.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "fmi/fmi2.h"

enum { MOST = 512, WARM = 1000, STEPS = 500, INSTANCES = 3 };

static struct {
    fmi2Component (*instantiate)(fmi2String, fmi2Type, fmi2String, fmi2String,
                                 const fmi2CallbackFunctions *, fmi2Boolean, fmi2Boolean);
    void (*release)(fmi2Component);
    fmi2Status (*setup)(fmi2Component, fmi2Boolean, fmi2Real, fmi2Real, fmi2Boolean, fmi2Real);
    fmi2Status (*enter)(fmi2Component), (*leave)(fmi2Component), (*terminate)(fmi2Component);
    fmi2Status (*get)(fmi2Component, const fmi2ValueReference *, size_t, fmi2Real *);
    fmi2Status (*step)(fmi2Component, fmi2Real, fmi2Real, fmi2Boolean);
} unit;

static const char *guid, *resources;
static fmi2ValueReference outputs[MOST];
static size_t count;
static pthread_barrier_t gate;
static double expected[MOST];

static void quiet(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status,
                  fmi2String category, fmi2String message, ...)
{
    (void)environment, (void)instance, (void)status, (void)category, (void)message;
}

static const fmi2CallbackFunctions HOST = {quiet, calloc, free, NULL, NULL};

static void fail(const char *why)
{
    fprintf(stderr, "%s\n", why);
    exit(1);
}

static fmi2Component begin(void)
{
    fmi2Component c = unit.instantiate("one", fmi2CoSimulation, guid, resources, &HOST, 0, 0);
    if (!c || unit.setup(c, 0, 0.0, 0.0, 0, 0.0) || unit.enter(c) || unit.leave(c)) {
        fail("an instance does not begin");
    }
    return c;
}

static void advance(fmi2Component c, int k)
{
    if (unit.step(c, 1e-3 * k, 1e-3, 1)) {
        fail("a step fails");
    }
}

static void end(fmi2Component c, double *found)
{
    if (unit.get(c, outputs, count, found) || unit.terminate(c)) {
        fail("an instance does not end");
    }
    unit.release(c);
}

static void cycle(double *found)
{
    fmi2Component c = begin();
    advance(c, 0);
    end(c, found);
}

static long resident(void)
{
    long total = 0, pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file || fscanf(file, "%ld %ld", &total, &pages) != 2) {
        fail("/proc/self/statm: cannot be read");
    }
    fclose(file);
    return pages * 4;
}

static void *side_by_side(void *unused)
{
    fmi2Component each[INSTANCES];
    double found[MOST];
    int k, j;
    pthread_barrier_wait(&gate);
    for (j = 0; j < INSTANCES; j++) {
        each[j] = begin();
    }
    for (k = 0; k < STEPS; k++) {
        for (j = 0; j < INSTANCES; j++) {
            advance(each[j], k);
        }
    }
    for (j = 0; j < INSTANCES; j++) {
        end(each[j], found);
        if (memcmp(found, expected, count * sizeof *found)) {
            fail("a thread has other bits");
        }
    }
    return unused;
}

static void run_threads(int threads)
{
    pthread_t *each = malloc((size_t)threads * sizeof *each);
    fmi2Component alone = begin();
    int k;
    for (k = 0; k < STEPS; k++) {
        advance(alone, k);
    }
    end(alone, expected);
    pthread_barrier_init(&gate, NULL, (unsigned)threads);
    for (k = 0; k < threads; k++) {
        if (pthread_create(&each[k], NULL, side_by_side, NULL)) {
            fail("a thread does not start");
        }
    }
    for (k = 0; k < threads; k++) {
        pthread_join(each[k], NULL);
    }
    free(each);
}

static void bind(void *library, const char *name, void *pointer)
{
    void *symbol = dlsym(library, name);
    if (!symbol) {
        fail(name);
    }
    memcpy(pointer, &symbol, sizeof symbol);
}

int main(int words, char **word)
{
    void *library = words > 6 ? dlopen(word[1], RTLD_NOW) : NULL;
    long k, cycles, before = 0;
    double first[MOST], found[MOST];
    struct timespec start, stop;
    if (!library || words - 6 > MOST) {
        fail("cycles LIBRARY GUID RESOURCES CYCLES THREADS REFERENCE...");
    }
    bind(library, "fmi2Instantiate", &unit.instantiate);
    bind(library, "fmi2FreeInstance", &unit.release);
    bind(library, "fmi2SetupExperiment", &unit.setup);
    bind(library, "fmi2EnterInitializationMode", &unit.enter);
    bind(library, "fmi2ExitInitializationMode", &unit.leave);
    bind(library, "fmi2Terminate", &unit.terminate);
    bind(library, "fmi2GetReal", &unit.get);
    bind(library, "fmi2DoStep", &unit.step);
    guid = word[2], resources = word[3], cycles = atol(word[4]);
    for (count = 0; count + 6 < (size_t)words; count++) {
        outputs[count] = (fmi2ValueReference)atol(word[count + 6]);
    }
    cycle(first);
    clock_gettime(CLOCK_MONOTONIC, &start);
    for (k = 0; k < cycles; k++) {
        cycle(found);
        if (memcmp(found, first, count * sizeof *found)) {
            fail("a cycle has other bits");
        }
        before = k == WARM ? resident() : before;
    }
    clock_gettime(CLOCK_MONOTONIC, &stop);
    printf("%.1f %ld\n",
           1e6 * ((double)(stop.tv_sec - start.tv_sec) + 1e-9 * (double)(stop.tv_nsec - start.tv_nsec)) /
               (double)cycles,
           resident() - before);
    run_threads(atoi(word[5]));
    return 0;
}
