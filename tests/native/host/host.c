/* A host in plain C that treats the units as badly as hosts do, and says what went wrong.

       host LIBRARY REPEATED THREADS [TOKEN FIRST_INPUT INPUTS FIRST_OUTPUT OUTPUTS]...

   Every unit by FMI 2.0 and 3.0: threads, calls in any order, wrong arguments, instances one after
   the other, a thousand damaged states, allocation while stepping; and what belongs to the host
   stays as it was. */
#include <dlfcn.h>
#include <fenv.h>
#include <locale.h>
#include <pthread.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi/fmi2.h"
#include "fmi/fmi3.h"

enum { MOST = 512, TOKEN = 8192, STEPS = 20, MOST_THREADS = 64, INSTANCES = 3, WARM = 30 };
enum { RANDOM_CALLS = 1000, DAMAGED = 1000, VALUES = 9 };

/* Memory that was asked for so far; in counting.c. */
unsigned long allocations(void);

typedef struct {
    const char *token;
    unsigned first_input, inputs, first_output, outputs;
} Kind;

static struct {
    fmi2Component (*instantiate)(fmi2String, fmi2Type, fmi2String, fmi2String,
                                 const fmi2CallbackFunctions *, fmi2Boolean, fmi2Boolean);
    void (*release)(fmi2Component);
    fmi2Status (*setup)(fmi2Component, fmi2Boolean, fmi2Real, fmi2Real, fmi2Boolean, fmi2Real);
    fmi2Status (*enter)(fmi2Component), (*leave)(fmi2Component);
    fmi2Status (*terminate)(fmi2Component), (*reset)(fmi2Component);
    fmi2Status (*get)(fmi2Component, const fmi2ValueReference *, size_t, fmi2Real *);
    fmi2Status (*set)(fmi2Component, const fmi2ValueReference *, size_t, const fmi2Real *);
    fmi2Status (*step)(fmi2Component, fmi2Real, fmi2Real, fmi2Boolean);
    fmi2Status (*save)(fmi2Component, fmi2FMUstate *);
    fmi2Status (*restore)(fmi2Component, fmi2FMUstate);
    fmi2Status (*forget)(fmi2Component, fmi2FMUstate *);
    fmi2Status (*state_size)(fmi2Component, fmi2FMUstate, size_t *);
    fmi2Status (*serialise)(fmi2Component, fmi2FMUstate, fmi2Byte *, size_t);
    fmi2Status (*deserialise)(fmi2Component, const fmi2Byte *, size_t, fmi2FMUstate *);
    fmi2Status (*derive)(fmi2Component, const fmi2ValueReference *, size_t,
                         const fmi2ValueReference *, size_t, const fmi2Real *, fmi2Real *);
    fmi2Status (*set_slopes)(fmi2Component, const fmi2ValueReference *, size_t,
                             const fmi2Integer *, const fmi2Real *);
    fmi2Status (*get_slopes)(fmi2Component, const fmi2ValueReference *, size_t,
                             const fmi2Integer *, fmi2Real *);
    fmi2Status (*cancel)(fmi2Component);
    fmi2Status (*get_states)(fmi2Component, fmi2Real *, size_t);
    fmi2Status (*set_states)(fmi2Component, const fmi2Real *, size_t);
    fmi2Status (*derivatives)(fmi2Component, fmi2Real *, size_t);
    fmi2Status (*events)(fmi2Component, fmi2EventInfo *);
    fmi2Status (*complete)(fmi2Component, fmi2Boolean, fmi2Boolean *, fmi2Boolean *);
} two;

static struct {
    fmi3Instance (*instantiate)(fmi3String, fmi3String, fmi3String, fmi3Boolean, fmi3Boolean,
                                fmi3Boolean, fmi3Boolean, const fmi3ValueReference *, size_t,
                                fmi3InstanceEnvironment, fmi3LogMessageCallback,
                                fmi3IntermediateUpdateCallback);
    void (*release)(fmi3Instance);
    fmi3Status (*enter)(fmi3Instance, fmi3Boolean, fmi3Float64, fmi3Float64, fmi3Boolean,
                        fmi3Float64);
    fmi3Status (*leave)(fmi3Instance), (*terminate)(fmi3Instance);
    fmi3Status (*get)(fmi3Instance, const fmi3ValueReference *, size_t, fmi3Float64 *, size_t);
    fmi3Status (*set)(fmi3Instance, const fmi3ValueReference *, size_t, const fmi3Float64 *,
                      size_t);
    fmi3Status (*step)(fmi3Instance, fmi3Float64, fmi3Float64, fmi3Boolean, fmi3Boolean *,
                       fmi3Boolean *, fmi3Boolean *, fmi3Float64 *);
    fmi3Status (*count)(fmi3Instance, size_t *);
} three;

static int failures;
static char last[8192];
static int messages;

static void check(int holds, const char *claim, const char *token)
{
    if (!holds) {
        fprintf(stderr, "not so: %s (%s)\n", claim, token);
        failures++;
    }
}

static void listen2(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status,
                    fmi2String category, fmi2String message, ...)
{
    messages++;
    snprintf(last, sizeof last, "%s", message);
}

static void listen3(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category,
                    fmi3String message)
{
    messages++;
    snprintf(last, sizeof last, "%s", message);
}

static const fmi2CallbackFunctions LISTENING = {listen2, calloc, free, NULL, NULL};
static const fmi2CallbackFunctions QUIET = {NULL, NULL, NULL, NULL, NULL};

/* A function pointer from a symbol, without a cast that ISO C does not know. */
static void bind(void *library, const char *name, void *pointer)
{
    void *symbol = dlsym(library, name);
    if (!symbol) {
        fprintf(stderr, "%s is missing\n", name);
        exit(2);
    }
    memcpy(pointer, &symbol, sizeof symbol);
}

static void load(void *library)
{
    bind(library, "fmi2Instantiate", &two.instantiate);
    bind(library, "fmi2FreeInstance", &two.release);
    bind(library, "fmi2SetupExperiment", &two.setup);
    bind(library, "fmi2EnterInitializationMode", &two.enter);
    bind(library, "fmi2ExitInitializationMode", &two.leave);
    bind(library, "fmi2Terminate", &two.terminate);
    bind(library, "fmi2Reset", &two.reset);
    bind(library, "fmi2GetReal", &two.get);
    bind(library, "fmi2SetReal", &two.set);
    bind(library, "fmi2DoStep", &two.step);
    bind(library, "fmi2GetFMUstate", &two.save);
    bind(library, "fmi2SetFMUstate", &two.restore);
    bind(library, "fmi2FreeFMUstate", &two.forget);
    bind(library, "fmi2SerializedFMUstateSize", &two.state_size);
    bind(library, "fmi2SerializeFMUstate", &two.serialise);
    bind(library, "fmi2DeSerializeFMUstate", &two.deserialise);
    bind(library, "fmi2GetDirectionalDerivative", &two.derive);
    bind(library, "fmi2SetRealInputDerivatives", &two.set_slopes);
    bind(library, "fmi2GetRealOutputDerivatives", &two.get_slopes);
    bind(library, "fmi2CancelStep", &two.cancel);
    bind(library, "fmi2GetContinuousStates", &two.get_states);
    bind(library, "fmi2SetContinuousStates", &two.set_states);
    bind(library, "fmi2GetDerivatives", &two.derivatives);
    bind(library, "fmi2NewDiscreteStates", &two.events);
    bind(library, "fmi2CompletedIntegratorStep", &two.complete);
    bind(library, "fmi3GetNumberOfContinuousStates", &three.count);
    bind(library, "fmi3InstantiateCoSimulation", &three.instantiate);
    bind(library, "fmi3FreeInstance", &three.release);
    bind(library, "fmi3EnterInitializationMode", &three.enter);
    bind(library, "fmi3ExitInitializationMode", &three.leave);
    bind(library, "fmi3Terminate", &three.terminate);
    bind(library, "fmi3GetFloat64", &three.get);
    bind(library, "fmi3SetFloat64", &three.set);
    bind(library, "fmi3DoStep", &three.step);
}

static void count_up(unsigned *references, unsigned first, unsigned count)
{
    unsigned k;
    for (k = 0; k < count; k++) {
        references[k] = first + k;
    }
}

/* -- one motion ----------------------------------------------------------------------------- */

/* The first input of each unit moves: a force, an acceleration or a mass. */
static double input_at(int k)
{
    return 1.0 + 0.25 * (k % 4);
}

static fmi2Component begun(const Kind *kind, const char *name, const fmi2CallbackFunctions *host)
{
    fmi2Component c = two.instantiate(name, fmi2CoSimulation, kind->token, "", host, 0, 0);
    if (!c || two.setup(c, 0, 0.0, 0.0, 0, 0.0) || two.enter(c) || two.leave(c)) {
        check(0, "an instance begins", kind->token);
    }
    return c;
}

static int advance(fmi2Component c, const Kind *kind, int k, double *outputs)
{
    unsigned references[MOST];
    const double value = input_at(k);
    count_up(references, kind->first_output, kind->outputs);
    return two.set(c, &kind->first_input, 1, &value) || two.step(c, 1e-3 * k, 1e-3, 1) ||
           two.get(c, references, kind->outputs, outputs);
}

static void run(const Kind *kind, double *outputs)
{
    fmi2Component c = begun(kind, "alone", &QUIET);
    int k, wrong = 0;
    for (k = 0; k < STEPS; k++) {
        wrong |= advance(c, kind, k, outputs);
    }
    check(!wrong, "an instance steps", kind->token);
    check(!two.terminate(c), "an instance ends", kind->token);
    two.release(c);
}

static void fmi3_gives_the_same_bits(const Kind *kind, const double *expected)
{
    unsigned references[MOST];
    double outputs[MOST], time;
    fmi3Boolean event, end, early;
    fmi3Instance c = three.instantiate("three", kind->token, NULL, 0, 0, 0, 0, NULL, 0, NULL,
                                       listen3, NULL);
    int k, wrong = !c || three.enter(c, 0, 0.0, 0.0, 0, 0.0) || three.leave(c);
    count_up(references, kind->first_output, kind->outputs);
    for (k = 0; k < STEPS && !wrong; k++) {
        const double value = input_at(k);
        wrong |= three.set(c, &kind->first_input, 1, &value, 1) ||
                 three.step(c, 1e-3 * k, 1e-3, 1, &event, &end, &early, &time) ||
                 three.get(c, references, kind->outputs, outputs, kind->outputs);
    }
    check(!wrong && !memcmp(outputs, expected, kind->outputs * sizeof *outputs), "FMI 3.0",
          kind->token);
    check(!wrong && three.get(c, references, 1, outputs, 2) == fmi3Error,
          "more values than references are refused", kind->token);
    if (c) {
        check(!three.terminate(c), "FMI 3.0 ends", kind->token);
        three.release(c);
    }
}

/* -- threads -------------------------------------------------------------------------------- */

static const Kind *threaded;
static const double *awaited;

static void *many(void *unused)
{
    fmi2Component each[INSTANCES];
    double outputs[MOST];
    intptr_t wrong = 0;
    int i, k;
    for (i = 0; i < INSTANCES; i++) {
        each[i] = begun(threaded, "thread", &QUIET);
    }
    for (k = 0; k < STEPS; k++) {
        for (i = 0; i < INSTANCES; i++) {
            wrong += advance(each[i], threaded, k, outputs);
            wrong += k == STEPS - 1 &&
                     memcmp(outputs, awaited, threaded->outputs * sizeof *outputs);
        }
    }
    for (i = 0; i < INSTANCES; i++) {
        two.release(each[i]);
    }
    return (void *)wrong;
}

static void threads_do_not_meet(const Kind *kind, const double *expected, int count)
{
    pthread_t threads[MOST_THREADS];
    void *wrong;
    int k;
    threaded = kind;
    awaited = expected;
    for (k = 0; k < count; k++) {
        pthread_create(threads + k, NULL, many, NULL);
    }
    for (k = 0; k < count; k++) {
        pthread_join(threads[k], &wrong);
        check(!wrong, "threads with instances of their own", kind->token);
    }
}

/* -- wrong use ------------------------------------------------------------------------------ */

static void refused(fmi2Status status, const char *claim, const Kind *kind)
{
    check(status == fmi2Error && messages == 1, claim, kind->token);
    messages = 0;
}

static void calls_out_of_order(const Kind *kind)
{
    double value = 0.0;
    fmi2FMUstate state = NULL;
    fmi2Component c =
        two.instantiate("order", fmi2CoSimulation, kind->token, "", &LISTENING, 0, 0);
    messages = 0;
    refused(two.step(c, 0.0, 1e-3, 1), "no step before initialisation", kind);
    refused(two.leave(c), "initialisation ends after it has begun", kind);
    refused(two.terminate(c), "an end comes after a beginning", kind);
    refused(two.derive(c, &kind->first_output, 1, &kind->first_input, 1, &value, &value),
            "no derivatives before initialisation", kind);
    check(!two.enter(c), "set-up may be left out", kind->token);
    refused(two.enter(c), "initialisation begins once", kind);
    refused(two.setup(c, 0, 0.0, 0.0, 0, 0.0), "set-up comes before initialisation", kind);
    refused(two.step(c, 0.0, 1e-3, 1), "no step during initialisation", kind);
    check(!two.leave(c), "initialisation ends", kind->token);
    refused(two.leave(c), "initialisation ends once", kind);
    refused(two.enter(c), "no initialisation afterwards", kind);
    refused(two.cancel(c), "there is no step to cancel", kind);
    refused(two.get(c, NULL, 1, &value), "references are needed", kind);
    refused(two.set(c, &kind->first_input, 1, NULL), "values are needed", kind);
    refused(two.save(c, NULL), "a place for the state is needed", kind);
    refused(two.restore(c, NULL), "a state is needed", kind);
    check(!two.get(c, NULL, 0, NULL), "nothing may be read", kind->token);
    check(!two.save(c, &state) && state, "a state is saved", kind->token);
    check(!two.terminate(c), "an instance ends", kind->token);
    refused(two.step(c, 0.0, 1e-3, 1), "no step after the end", kind);
    check(!two.get(c, &kind->first_output, 1, &value), "outputs stay", kind->token);
    check(!two.restore(c, state) && !two.step(c, 0.0, 1e-3, 1), "a state goes on", kind->token);
    check(!two.forget(c, &state) && !state && !two.forget(c, &state), "a state is cleared",
          kind->token);
    check(!two.reset(c) && !two.enter(c) && !two.leave(c) && !two.step(c, 0.0, 1e-3, 1),
          "a reset instance begins anew", kind->token);
    two.release(c);
    two.release(NULL);
    check(two.step(NULL, 0.0, 1e-3, 1) == fmi2Error && two.reset(NULL) == fmi2Error &&
              two.get(NULL, &kind->first_output, 1, &value) == fmi2Error,
          "no instance", kind->token);
}

static uint32_t drawn(uint32_t below)
{
    static uint64_t state = 88172645463325252u;
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(state >> 33) % below;
}

static double drawn_value(void)
{
    const double values[] = {0.0, 1.0, -1.0, 1e-300, 1e300, -1e18, 0.001, 1.0 / 0.0, 0.0 / 0.0};
    return drawn(3) ? (double)drawn(1000) / 100.0 : values[drawn(9)];
}

static void calls_in_any_order(const Kind *kind)
{
    fmi2Component c =
        two.instantiate("any", fmi2CoSimulation, kind->token, NULL, &QUIET, 1, 1);
    fmi2FMUstate state = NULL;
    unsigned references[8];
    double values[8], time = 0.0;
    int orders[VALUES], k, i, wrong = 0;
    for (k = 0; k < RANDOM_CALLS; k++) {
        const size_t count = drawn(9);
        fmi2Status status = fmi2OK;
        for (i = 0; i < 8; i++) {
            references[i] = drawn(8) ? drawn(kind->first_output + kind->outputs) : drawn(~0u);
            values[i] = drawn_value();
            orders[i] = (int)drawn(5) - 1;
        }
        switch (drawn(14)) {
        case 0: status = two.setup(c, 0, 0.0, values[0], drawn(2) != 0, values[1]); break;
        case 1: status = two.enter(c); break;
        case 2: status = two.leave(c); break;
        case 3: status = drawn(20) ? fmi2OK : two.terminate(c); break;
        case 4: status = drawn(20) ? fmi2OK : two.reset(c); break;
        case 5: status = two.get(c, references, count, values); break;
        case 6: status = two.set(c, references, count, values); break;
        case 7: status = two.save(c, &state); break;
        case 8: status = state ? two.restore(c, state) : fmi2OK; break;
        case 9: status = two.forget(c, &state); break;
        case 10:
            status = two.derive(c, references, 4, references + 4, 4, values, values + 4);
            break;
        case 11: status = two.set_slopes(c, references, count, orders, values); break;
        case 12: status = two.get_slopes(c, references, count, orders, values); break;
        default:
            status = two.step(c, time, drawn(4) ? 1e-3 : values[0], 1);
            time = status == fmi2OK && drawn(8) ? time + 1e-3 : 0.0;
        }
        wrong |= status < fmi2OK || status > fmi2Error;
    }
    check(!wrong, "calls in any order", kind->token);
    two.forget(c, &state);
    two.release(c);
}

/* Bytes of a state of their very length, for a sanitizer to watch, with some of them changed. */
static char *damaged_copy(const char *bytes, size_t whole, size_t *size)
{
    const size_t longer = whole + drawn(64);
    char *copy;
    size_t k;
    *size = drawn(2) ? whole : drawn((uint32_t)longer);
    copy = malloc(*size ? *size : 1);
    for (k = 0; k < *size; k++) {
        copy[k] = k < whole ? bytes[k] : (char)drawn(256);
    }
    for (k = 0; *size && k < 1 + drawn(3); k++) {
        copy[drawn((uint32_t)*size)] ^= (char)(1 + drawn(255));
    }
    return copy;
}

static void damaged_states_are_refused(const Kind *kind)
{
    double before[MOST], after[MOST];
    fmi2Component c = begun(kind, "damaged", &QUIET);
    fmi2FMUstate state = NULL;
    size_t whole = 0, size;
    char *bytes;
    unsigned references[MOST];
    int k, wrong = advance(c, kind, 0, before) || two.save(c, &state) ||
                   two.state_size(c, state, &whole);
    bytes = malloc(whole);
    wrong |= two.serialise(c, state, bytes, whole - 1) != fmi2Error ||
             two.serialise(c, state, bytes, whole) != fmi2OK;
    for (k = 0; k < DAMAGED; k++) {
        char *copy = damaged_copy(bytes, whole, &size);
        fmi2FMUstate made = NULL;
        const int same = size == whole && !memcmp(copy, bytes, whole);
        wrong |= !same && (two.deserialise(c, copy, size, &made) != fmi2Error || made);
        free(copy);
    }
    count_up(references, kind->first_output, kind->outputs);
    wrong |= two.get(c, references, kind->outputs, after) ||
             memcmp(before, after, kind->outputs * sizeof *after);
    check(!wrong, "damaged states are refused and change nothing", kind->token);
    free(bytes);
    two.forget(c, &state);
    two.release(c);
}

static void wrong_identity(const Kind *kind)
{
    const char *const names[] = {"%s%n%s%n", "", "J\303\266rg [1] (a+b) 'x'", NULL};
    const char *const places[] = {"file:/a%20b/resources", "file:///%4A%C3%B6rg/#?",
                                  "file://localhost/a/resources", NULL};
    char token[TOKEN];
    size_t k;
    /* the text of a composite, which is no GUID, has a hash for one */
    for (k = 0; kind->token[k] && kind->token[k] != ';'; k++) {
        fmi2Component c;
        snprintf(token, sizeof token, "%s", kind->token);
        token[k] ^= 1;
        messages = 0;
        c = two.instantiate("%s%n", fmi2CoSimulation, token, "", &LISTENING, 0, 0);
        check(!c && messages == 1 && strstr(last, "instantiation failed: "), "a wrong GUID", token);
        messages = 0;
        check(!three.instantiate("%s%n", token, NULL, 0, 0, 0, 0, NULL, 0, NULL, listen3, NULL) &&
                  messages == 1,
              "a wrong token", token);
    }
    messages = 0;
    check(!two.instantiate("a", fmi2CoSimulation, NULL, NULL, &LISTENING, 0, 0) && messages == 1,
          "no GUID", kind->token);
    for (k = 0; k < sizeof names / sizeof *names; k++) {
        fmi2Component c =
            two.instantiate(names[k], fmi2CoSimulation, kind->token, places[k], NULL, 0, 0);
        check(c != NULL, "any name, any place, no callbacks", kind->token);
        check(two.step(c, 0.0, 1e-3, 0) == fmi2Error, "a refusal that nobody hears", kind->token);
        two.release(c);
    }
}

/* -- model exchange ------------------------------------------------------------------------- */

/* Composites without events have it; what is refused is in test_model_exchange.py. */
static void exchange(const Kind *kind)
{
    double states[MOST], rates[MOST], again[MOST];
    fmi2EventInfo info;
    size_t count = 0;
    fmi2Component c = two.instantiate("a", fmi2ModelExchange, kind->token, NULL, &QUIET, 0, 0);
    check(!c == !!strncmp(kind->token, "Composite", 9), "composites alone have model exchange",
          kind->token);
    if (c && !two.setup(c, 0, 0.0, 0.0, 0, 0.0) && !two.enter(c) && !two.leave(c)) {
        check(!three.count(c, &count) && !two.events(c, &info) && !two.get_states(c, states, count) &&
                  !two.derivatives(c, rates, count) && !two.set_states(c, states, count) &&
                  !two.derivatives(c, again, count) && !memcmp(rates, again, count * sizeof *rates) &&
                  !two.complete(c, 1, NULL, NULL),
              "states set and derivatives read", kind->token);
        check(two.set_states(c, states, count + 1) == fmi2Error &&
                  two.get_states(c, NULL, count) == fmi2Error && two.events(c, NULL) == fmi2Error,
              "wrong calls refused", kind->token);
    }
    two.release(c);
}

/* -- memory --------------------------------------------------------------------------------- */

static long resident(void)
{
    long total = 0, pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (file) {
        if (fscanf(file, "%ld %ld", &total, &pages) != 2) {
            pages = 0;
        }
        fclose(file);
    }
    return pages * 4;
}

static void repeated_instances_leave_nothing(const Kind *kind, int count, int measured)
{
    double first[MOST], outputs[MOST];
    long before = 0;
    int k, same = 1;
    for (k = 0; k < count; k++) {
        fmi2Component c = begun(kind, "again", &QUIET);
        fmi2FMUstate state = NULL;
        advance(c, kind, 0, k ? outputs : first);
        same &= !k || !memcmp(outputs, first, kind->outputs * sizeof *first);
        two.save(c, &state);
        two.forget(c, &state);
        two.release(c);
        before = k == WARM ? resident() : before;
    }
    check(same, "repeated instances have the same bits", kind->token);
    check(!measured || resident() - before < 256, "no growth (kB)", kind->token);
}

static void a_step_allocates_nothing(const Kind *kind)
{
    double outputs[MOST];
    fmi2Component c = begun(kind, "still", &QUIET);
    fmi2FMUstate state = NULL;
    unsigned long before = allocations();
    int k;
    two.save(c, &state);
    check(!before || allocations() > before, "allocations are counted", kind->token);
    before = allocations();
    for (k = 0; k < STEPS; k++) {
        advance(c, kind, k, outputs);
        two.save(c, &state);
        two.restore(c, state);
    }
    check(allocations() == before, "no allocation while stepping", kind->token);
    two.forget(c, &state);
    two.release(c);
}

/* -- what is the host's --------------------------------------------------------------------- */

static volatile sig_atomic_t interrupted;

static void on_interrupt(int signal_number)
{
    interrupted = 1;
}

static void the_host_is_left_alone(void (*handler)(int), int rounding, int traps)
{
    struct sigaction now;
    sigaction(SIGINT, NULL, &now);
    check(now.sa_handler == handler, "SIGINT is the host's", "");
    raise(SIGINT);
    check(interrupted, "SIGINT comes", "");
    check(fegetround() == rounding, "the rounding mode is the host's", "");
    check(fegetexcept() == traps, "traps are the host's", "");
    check(!strcmp(setlocale(LC_ALL, NULL), "C"), "the locale is the host's", "");
}

int main(int count, char **words)
{
    struct sigaction action;
    void *library;
    int k;
    const int rounding = fegetround(), traps = fegetexcept();
    memset(&action, 0, sizeof action);
    action.sa_handler = on_interrupt;
    sigaction(SIGINT, &action, NULL);
    library = count > 3 ? dlopen(words[1], RTLD_NOW | RTLD_LOCAL) : NULL;
    if (!library) {
        fprintf(stderr, "no library: %s\n", dlerror());
        return 2;
    }
    load(library);
    for (k = 4; k + 4 < count; k += 5) {
        static Kind kind;
        double expected[MOST];
        kind.token = words[k];
        kind.first_input = (unsigned)atoi(words[k + 1]);
        kind.inputs = (unsigned)atoi(words[k + 2]);
        kind.first_output = (unsigned)atoi(words[k + 3]);
        kind.outputs = (unsigned)atoi(words[k + 4]);
        run(&kind, expected);
        fmi3_gives_the_same_bits(&kind, expected);
        threads_do_not_meet(&kind, expected, atoi(words[3]));
        calls_out_of_order(&kind);
        calls_in_any_order(&kind);
        damaged_states_are_refused(&kind);
        exchange(&kind);
        wrong_identity(&kind);
        a_step_allocates_nothing(&kind);
        repeated_instances_leave_nothing(&kind, atoi(words[2]), allocations() != 0);
    }
    the_host_is_left_alone(on_interrupt, rounding, traps);
    if (dlclose(library)) {
        failures++;
    }
    printf("%d units, %d failures\n", (count - 4) / 5, failures);
    return failures != 0;
}
