/* A host that forges: states with changed values and a right checksum, and compositions that are crafted.

       forge LIBRARY states KINDS FIRST COUNT
       forge LIBRARY compositions TEXTS FIRST COUNT

   KINDS has for each kind of unit a line with its token and one with its first input, its first output,
   how many outputs there are and how many value references.  TEXTS has a composition a line.  The number of
   each case is written before it begins, so that whoever started this knows which one ended it; a case that
   takes LIMIT seconds of processor time is a hang and ends it too. */
#include <dlfcn.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <unistd.h>

#include "fmi/fmi2.h"

enum { MOST_KINDS = 64, LINE = 1 << 20, OUTPUTS = 4096, TOKEN = 192, TIMES = 4 };
enum { TIME = TOKEN, POINT = TIME + 24, PHASE = TIME + 8 * TIMES };
enum { STALE = PHASE + 4, VALUES = STALE + 4, CHECKSUM = 8, COURSE = 80, LIMIT = 60, HUNG = 3 };
static const double STEP = 1e-3;

typedef struct {
    char *token;
    unsigned first_input, first_output, outputs, references;
    double first_run[OUTPUTS];
} Kind;

typedef struct {
    unsigned char *bytes;
    size_t size;
} Serialised;

static struct {
    fmi2Component (*instantiate)(fmi2String, fmi2Type, fmi2String, fmi2String,
                                 const fmi2CallbackFunctions *, fmi2Boolean, fmi2Boolean);
    void (*release)(fmi2Component);
    fmi2Status (*enter)(fmi2Component), (*leave)(fmi2Component), (*reset)(fmi2Component);
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
    fmi2Status (*get_states)(fmi2Component, fmi2Real *, size_t);
    fmi2Status (*derivatives)(fmi2Component, fmi2Real *, size_t);
    fmi2Status (*events)(fmi2Component, fmi2EventInfo *);
} two;

static Kind kinds[MOST_KINDS];
static int kind_count, current, wrong, refused, refused_later, accepted;
static const fmi2CallbackFunctions QUIET = {NULL, NULL, NULL, NULL, NULL};

static void bind(void *library, const char *name, void *pointer)
{
    void *symbol = dlsym(library, name);
    if (!symbol) {
        fprintf(stderr, "%s is missing\n", name);
        exit(2);
    }
    memcpy(pointer, &symbol, sizeof symbol);
}

static void load(const char *path)
{
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        fprintf(stderr, "no library: %s\n", dlerror());
        exit(2);
    }
    bind(library, "fmi2Instantiate", &two.instantiate);
    bind(library, "fmi2FreeInstance", &two.release);
    bind(library, "fmi2EnterInitializationMode", &two.enter);
    bind(library, "fmi2ExitInitializationMode", &two.leave);
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
    bind(library, "fmi2GetContinuousStates", &two.get_states);
    bind(library, "fmi2GetDerivatives", &two.derivatives);
    bind(library, "fmi2NewDiscreteStates", &two.events);
}

static void check(int holds, const char *claim)
{
    if (!holds) {
        fprintf(stderr, "case %d: not so: %s\n", current, claim);
        wrong++;
    }
}

static void hangs(int signal_number)
{
    static const char words[] = "a hang\n";
    (void)signal_number;
    if (write(2, words, sizeof words - 1) < 0) {
        _exit(2);
    }
    _exit(HUNG);
}

/* Begin a case: say its number, and start its clock. */
static void begin_case(int number)
{
    const struct itimerval limit = {{0, 0}, {LIMIT, 0}};
    current = number;
    printf("%d\n", number);
    fflush(stdout);
    setitimer(ITIMER_PROF, &limit, NULL);
}

/* -- random numbers: the same for a case, whichever came before ------------------------------- */

static uint64_t random_state;

static uint64_t random_bits(void)
{
    uint64_t z = random_state += 0x9E3779B97F4A7C15u;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
    z = (z ^ z >> 27) * 0x94D049BB133111EBu;
    return z ^ z >> 31;
}

static unsigned drawn(unsigned below)
{
    return (unsigned)(random_bits() >> 33) % below;
}

static double forged_value(double value)
{
    static const double values[] = {0.0,   1.0,    -1.0,   0.5,         2.0,     1e9,     -1e9,          1e18,
                                    1e300, -1e300, 1e-300, 4294967296., 1.7e308, 1.0 / 0.0, -1.0 / 0.0, 0.0 / 0.0};
    const uint64_t bits = random_bits();
    double random_value;
    switch (drawn(7)) {
    case 0:
        return -value;
    case 4:
        return (double)drawn(20); /* a count, or an index, a little beyond what there is */
    case 1:
        return value + (double)drawn(1000) - 500.0;
    case 2:
        return value * (1.0 + 1e-3 * drawn(5000));
    case 3:
        memcpy(&random_value, &bits, sizeof bits);
        return random_value;
    default:
        return values[drawn(sizeof values / sizeof *values)];
    }
}

/* -- states ------------------------------------------------------------------------------------ */

static fmi2Component instance(const Kind *kind)
{
    return two.instantiate("forged", fmi2CoSimulation, kind->token, "", &QUIET, 0, 0);
}

static void read_outputs(fmi2Component c, const Kind *kind, double *outputs)
{
    unsigned k, reference;
    for (k = 0; k < kind->outputs && k < OUTPUTS; k++) {
        reference = kind->first_output + k;
        if (two.get(c, &reference, 1, outputs + k)) {
            outputs[k] = 0.0;
        }
    }
}

/* Bring a new instance so far: 0 as it is, 1 initialising, k + 2 behind k steps; its time. */
static double bring(fmi2Component c, const Kind *kind, unsigned far)
{
    double time = 0.0;
    unsigned k;
    if (far > 0) {
        two.enter(c);
    }
    if (far > 1) {
        two.leave(c);
    }
    for (k = 2; k < far; k++, time += STEP) {
        const double value = 1.0 + 0.25 * (k % 4);
        two.set(c, &kind->first_input, 1, &value);
        if (two.step(c, time, STEP, 1)) {
            break;
        }
    }
    return time;
}

static Serialised serialised(fmi2Component c)
{
    Serialised made = {NULL, 0};
    fmi2FMUstate state = NULL;
    check(!two.save(c, &state) && !two.state_size(c, state, &made.size), "a state is saved");
    made.bytes = malloc(made.size);
    check(!two.serialise(c, state, (fmi2Byte *)made.bytes, made.size), "a state is serialised");
    two.forget(c, &state);
    return made;
}

static void write_checksum(Serialised *state)
{
    uint64_t hash = 0xCBF29CE484222325u;
    size_t k;
    for (k = 0; k + CHECKSUM < state->size; k++) {
        hash = (hash ^ state->bytes[k]) * 0x100000001B3u;
    }
    memcpy(state->bytes + k, &hash, CHECKSUM);
}

/* Change one value. */
static void forge(Serialised *state, const Kind *kind)
{
    const size_t doubles = (state->size - CHECKSUM - VALUES) / sizeof(double);
    const size_t behind = state->size - CHECKSUM - VALUES - doubles * sizeof(double);
    unsigned char *at = state->bytes + VALUES + sizeof(double) * drawn((unsigned)doubles);
    const int32_t number = drawn(3) ? (int32_t)drawn(12) - 2 : (int32_t)random_bits();
    double value;
    switch (drawn(12)) {
    case 0:
        at = state->bytes + TIME + sizeof(double) * drawn(TIMES);
        break;
    case 1:
        memcpy(state->bytes + (drawn(2) ? PHASE : STALE), &number, sizeof number);
        return;
    case 2:
        if (behind) {
            state->bytes[state->size - CHECKSUM - 1 - drawn((unsigned)behind)] = (unsigned char)drawn(256);
            return;
        }
        break;
    case 3:
    case 4:
    case 5:
    case 6:
    case 7:
    case 8:
        if (doubles > kind->references + COURSE) { /* what remembers most of a composite */
            at = state->bytes + VALUES + sizeof(double) * (kind->references + drawn(COURSE));
        }
        break;
    default:
        break;
    }
    memcpy(&value, at, sizeof value);
    value = forged_value(value);
    memcpy(at, &value, sizeof value);
}

/* Whether an instance is as it was. */
static int is_as(fmi2Component c, const Serialised *before)
{
    Serialised now = serialised(c);
    const int same = now.size == before->size && !memcmp(now.bytes, before->bytes, now.size);
    free(now.bytes);
    return same;
}

/* Whether an instance is as it was, its outputs to be observed anew at the most: what they are observed by was made
   again. */
static int is_as_observed(fmi2Component c, const Serialised *before)
{
    const int32_t observed = 2; /* OBSERVED of unit.h */
    Serialised made = {malloc(before->size), before->size};
    int32_t stale;
    int same;
    memcpy(made.bytes, before->bytes, made.size);
    memcpy(&stale, made.bytes + STALE, sizeof stale);
    if (stale < observed) {
        memcpy(made.bytes + STALE, &observed, sizeof observed);
        write_checksum(&made);
    }
    same = is_as(c, before) || is_as(c, &made);
    free(made.bytes);
    return same;
}

/* Whether it also moves on as one that has met no forged state. */
static int goes_on_as(fmi2Component c, const Kind *kind, const Serialised *before)
{
    double outputs[2][OUTPUTS], time;
    fmi2Component other[2] = {c, instance(kind)};
    fmi2FMUstate state = NULL;
    int k, same;
    memcpy(&time, before->bytes + POINT, sizeof time);
    if (two.deserialise(other[1], (const fmi2Byte *)before->bytes, before->size, &state) ||
        two.restore(other[1], state)) {
        two.release(other[1]);
        return 0;
    }
    for (k = 0; k < 2; k++) {
        two.step(other[k], time, STEP, 1);
        read_outputs(other[k], kind, outputs[k]);
    }
    same = !memcmp(outputs[0], outputs[1], kind->outputs * sizeof(double));
    two.forget(other[1], &state);
    two.release(other[1]);
    return same;
}

/* An instance that was brought so far goes on as a new one that takes its state. */
static void check_twin(const Kind *kind, unsigned far, const Serialised *state)
{
    fmi2Component twin = instance(kind);
    bring(twin, kind, far);
    check(far < 2 || goes_on_as(twin, kind, state), "a state goes on in a new instance as where it was saved");
    two.release(twin);
}

/* Call all that may be called with a state that was accepted. */
static void use(fmi2Component c, const Kind *kind, double time)
{
    double outputs[OUTPUTS], value = 1.5, change;
    fmi2FMUstate state = NULL;
    int k;
    read_outputs(c, kind, outputs);
    for (k = 0; k < 3; k++) {
        if (two.step(c, time + k * STEP, STEP, 1)) {
            break;
        }
        two.set(c, &kind->first_input, 1, &value);
        read_outputs(c, kind, outputs);
    }
    two.derive(c, &kind->first_output, 1, &kind->first_input, 1, &value, &change);
    two.save(c, &state);
    two.restore(c, state);
    two.forget(c, &state);
    two.leave(c);
}

static void state_case(int number)
{
    Kind *kind = kinds + number % kind_count;
    fmi2Component c = instance(kind), live = c;
    Serialised forged, before;
    fmi2FMUstate state = NULL;
    double outputs[OUTPUTS], time;
    unsigned changes = 1 + (unsigned)(number / kind_count) % 2, far, k;
    begin_case(number);
    random_state = (uint64_t)number * 2 + 1;
    bring(c, kind, far = drawn(8));
    forged = serialised(c);
    if (drawn(2)) {
        live = instance(kind);
        bring(live, kind, far = drawn(8));
    }
    before = serialised(live);
    check_twin(kind, far, &before);
    for (k = 0; k < changes; k++) {
        forge(&forged, kind);
    }
    write_checksum(&forged);
    if (two.deserialise(live, (const fmi2Byte *)forged.bytes, forged.size, &state)) {
        refused++;
        check(!state && is_as(live, &before), "a refused state changes nothing");
    } else if (two.restore(live, state)) {
        refused_later++;
        check(is_as_observed(live, &before), "a failed restore leaves the instance as it was");
        check(goes_on_as(live, kind, &before), "an instance goes on behind a failed restore");
    } else {
        accepted++;
        memcpy(&time, forged.bytes + POINT, sizeof time);
        use(live, kind, time);
    }
    two.forget(live, &state);
    check(!two.reset(live), "an instance is reset");
    bring(live, kind, 4);
    read_outputs(live, kind, outputs);
    check(!memcmp(outputs, kind->first_run, kind->outputs * sizeof(double)), "a reset instance is as new");
    if (live != c) {
        two.release(live);
    }
    two.release(c);
    free(forged.bytes);
    free(before.bytes);
}

static void read_kinds(FILE *file)
{
    static char line[LINE];
    while (kind_count < MOST_KINDS && fgets(line, LINE, file)) {
        Kind *kind = kinds + kind_count++;
        fmi2Component c;
        kind->token = malloc(strlen(line) + 1);
        line[strcspn(line, "\n")] = 0;
        memcpy(kind->token, line, strlen(line) + 1);
        if (!fgets(line, LINE, file) || sscanf(line, "%u %u %u %u", &kind->first_input, &kind->first_output,
                                               &kind->outputs, &kind->references) != 4) {
            exit(2);
        }
        c = instance(kind);
        if (!c) {
            fprintf(stderr, "no instance of %s\n", kind->token);
            exit(2);
        }
        bring(c, kind, 4);
        read_outputs(c, kind, kind->first_run);
        two.release(c);
    }
}

/* -- compositions -------------------------------------------------------------------------------- */

static void composition_case(const char *text, int number)
{
    const fmi2Type type = number % 4 ? fmi2CoSimulation : fmi2ModelExchange;
    fmi2Component c;
    double value, states[2 * OUTPUTS];
    unsigned reference;
    int k;
    begin_case(number);
    c = two.instantiate("crafted", type, text, "", &QUIET, 0, 0);
    if (!c) {
        refused++;
        return;
    }
    if (two.enter(c) || two.leave(c)) {
        refused_later++;
    } else {
        fmi2EventInfo info;
        accepted++;
        for (k = 0; k < 5 && type == fmi2CoSimulation && !two.step(c, k * STEP, STEP, 1); k++) {
        }
        for (k = 0; k < 3 && type == fmi2ModelExchange; k++) {
            two.events(c, &info);
            two.derivatives(c, states, (size_t)k);
        }
    }
    for (reference = 0; reference < 3000; reference++) {
        two.get(c, &reference, 1, &value);
    }
    two.reset(c);
    two.release(c);
}

int main(int count, char **words)
{
    FILE *file;
    int first, end, k;
    if (count != 6) {
        return 2;
    }
    signal(SIGPROF, hangs);
    load(words[1]);
    file = fopen(words[3], "r");
    first = atoi(words[4]);
    end = first + atoi(words[5]);
    if (!file) {
        return 2;
    }
    if (!strcmp(words[2], "states")) {
        read_kinds(file);
        for (k = first; k < end; k++) {
            state_case(k);
        }
    } else {
        static char line[LINE];
        for (k = 0; k < end && fgets(line, LINE, file); k++) {
            line[strcspn(line, "\n")] = 0;
            if (k >= first) {
                composition_case(line, k);
            }
        }
    }
    fclose(file);
    for (k = 0; k < kind_count; k++) {
        free(kinds[k].token);
    }
    printf("refused %d, later %d, accepted %d, wrong %d\n", refused, refused_later, accepted, wrong);
    return wrong != 0;
}
