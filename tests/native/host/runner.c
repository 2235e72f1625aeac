/* One run of a scene's one file in FMI 2.0, or a batch of runs, written as bits: a line of hexadecimal numbers
   a step, or a run.

   It is a host without a C library, like the units, and so made for any platform in a second: the few
   functions it needs come from system_*.c beside it.  Lines of its standard input:

       LIBRARY
       TOKEN
       FIRST COUNT STEPS LENGTH    value references of the Reals that are written, and the steps;
                                   in hexadecimal, the length by its bits

   For a batch the last line is

       FIRST COUNT STEPS LENGTH REFERENCE SIDE RUNS VALUE VALUE ...

   with the variable that differs, how many machines go on side by side, and the values by their bits. */
#include <stdint.h>

#include "coupling/batch.h"
#include "fmi/fmi2.h"
#include "system.h"

enum { REALS = 4096, INPUT = 16384, RUNS = 16 };

typedef union {
    uint64_t bits;
    double value;
} Number;

static struct {
    fmi2Component (*instantiate)(fmi2String, fmi2Type, fmi2String, fmi2String,
                                 const fmi2CallbackFunctions *, fmi2Boolean, fmi2Boolean);
    fmi2Status (*enter)(fmi2Component), (*leave)(fmi2Component);
    fmi2Status (*get)(fmi2Component, const fmi2ValueReference *, size_t, fmi2Real *);
    fmi2Status (*step)(fmi2Component, fmi2Real, fmi2Real, fmi2Boolean);
    size_t (*runs)(const char *, const Batch *, size_t, const double *, const double *, double *, double *, char *);
} library;

static double reals[REALS];
static fmi2ValueReference references[REALS];
static char input[INPUT];
static char *rest = input;

static void write_text(const char *text)
{
    size_t length = 0;
    while (text[length])
        length++;
    system_write(text, length);
}

static void refuse_failed(int failed, const char *what)
{
    if (failed) {
        write_text("failed: ");
        write_text(what);
        write_text("\n");
        system_exit(1);
    }
}

static void log_message(fmi2ComponentEnvironment environment, fmi2String instance,
                        fmi2Status status, fmi2String category, fmi2String message, ...)
{
    (void)environment, (void)instance, (void)status, (void)category;
    write_text("message: ");
    write_text(message);
    write_text("\n");
}

static void read_input(void)
{
    size_t length = 0, read;
    while ((read = system_read(input + length, INPUT - 1 - length)) > 0)
        length += read;
}

/* The input up to a character, without it. */
static char *until(char end)
{
    char *start = rest;
    while (*rest && *rest != end)
        rest++;
    if (*rest)
        *rest++ = 0;
    return start;
}

/* The number up to a space or the end of the line. */
static Number next_number(void)
{
    Number number;
    number.bits = 0;
    for (; *rest && *rest != ' ' && *rest != '\n'; rest++)
        number.bits = number.bits << 4 | (uint64_t)(*rest <= '9' ? *rest - '0' : *rest - 'a' + 10);
    rest += *rest != 0;
    return number;
}

static void write_real(double value)
{
    char digits[17];
    Number number;
    int k;
    number.value = value;
    for (k = 0; k < 16; k++)
        digits[k] = "0123456789abcdef"[number.bits >> (60 - 4 * k) & 15];
    digits[16] = ' ';
    system_write(digits, 17);
}

static void bind(void *handle, const char *name, void *pointer)
{
    *(void **)pointer = system_symbol(handle, name);
    refuse_failed(*(void **)pointer == NULL, name);
}

/* A batch; the rest of the line says what differs. */
static void run_batch(const char *token, size_t count, size_t steps, double length)
{
    static double values[RUNS], ends[RUNS];
    static char reasons[RUNS * BATCH_REASON];
    static unsigned reference;
    const size_t row = (steps + 1) * count;
    Batch batch = {1, &reference, count, references, 0, NULL, steps, 0, 0};
    size_t runs, k, j;
    reference = (unsigned)next_number().bits;
    batch.side_by_side = (int)next_number().bits;
    runs = (size_t)next_number().bits;
    refuse_failed(runs > RUNS || runs * row > REALS, "too many runs");
    for (k = 0; k < runs; k++) {
        values[k] = next_number().value;
        ends[k] = length * (double)steps;
    }
    refuse_failed(library.runs(token, &batch, runs, values, ends, reals, NULL, reasons) != 0, reasons);
    for (k = 0; k < runs; k++) {
        for (j = 0; j < row; j++)
            write_real(reals[k * row + j]);
        write_text("\n");
    }
    system_exit(0);
}

void run(void)
{
    static const fmi2CallbackFunctions callbacks = {log_message, NULL, NULL, NULL, NULL};
    void *handle;
    fmi2Component unit;
    uint64_t first, count, steps, j, k;
    double length;
    const char *token;
    read_input();
    handle = system_open(until('\n'));
    refuse_failed(handle == NULL, "the library is not loaded");
    bind(handle, "fmi2Instantiate", &library.instantiate);
    bind(handle, "fmi2EnterInitializationMode", &library.enter);
    bind(handle, "fmi2ExitInitializationMode", &library.leave);
    bind(handle, "fmi2GetReal", &library.get);
    bind(handle, "fmi2DoStep", &library.step);
    bind(handle, "autobalancer_runs", &library.runs);
    token = until('\n');
    first = next_number().bits;
    count = next_number().bits;
    steps = next_number().bits;
    length = next_number().value;
    refuse_failed(count > REALS, "too many values");
    for (k = 0; k < count; k++)
        references[k] = (fmi2ValueReference)(first + k);
    if (*rest)
        run_batch(token, (size_t)count, (size_t)steps, length);
    unit = library.instantiate("unit", fmi2CoSimulation, token, "file:///none", &callbacks, 0, 1);
    refuse_failed(unit == NULL || library.enter(unit) || library.leave(unit), "no instance begins");
    for (j = 0; j < steps; j++) {
        refuse_failed(library.step(unit, (double)j * length, length, 1), "fmi2DoStep");
        refuse_failed(library.get(unit, references, (size_t)count, reals), "fmi2GetReal");
        for (k = 0; k < count; k++)
            write_real(reals[k]);
        write_text("\n");
    }
    system_exit(0);
}
