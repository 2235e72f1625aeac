/* A host in plain C that runs one unit and writes its outputs as their bits.

   It leaves out the C run-time library, so that it is made for any platform in a second: the few
   functions it needs come from system_*.c beside it.  Lines of its standard input:

       LIBRARY
       TOKEN
       FIRST COUNT    value references of the Reals that are written
       TIME STEP      a step from a time, both as bits in hexadecimal; as often as wanted */
#include <stddef.h>
#include <stdint.h>

#include "system.h"

enum { REALS = 4096, LINE = 8192 };

typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
    void *environment;
} Callbacks;

typedef struct {
    void *(*instantiate)(const char *, int, const char *, const char *, const Callbacks *, int, int);
    int (*setup)(void *, int, double, double, int, double);
    int (*enter)(void *);
    int (*leave)(void *);
    int (*get_real)(void *, const unsigned *, size_t, double *);
    int (*step)(void *, double, double, int);
} Library;

static Library library;
static void *unit;
static double reals[REALS];
static unsigned references[REALS];
static char line[LINE];
static char *rest;

static void write_text(const char *text)
{
    size_t length = 0;
    while (text[length])
        length++;
    system_write(text, length);
}

static void fail(const char *why, const char *what)
{
    write_text("failed: ");
    write_text(why);
    write_text(" ");
    write_text(what);
    write_text("\n");
    system_exit(1);
}

static void logger(void *environment, const char *name, int status, const char *category,
                   const char *message, ...)
{
    (void)environment;
    (void)name;
    (void)status;
    (void)category;
    write_text("message: ");
    write_text(message);
    write_text("\n");
}

/* Read a line without its end; 0 at the end of the input. */
static int read_line(void)
{
    static char buffer[65536];
    static size_t used, filled;
    size_t length = 0;
    for (;;) {
        if (used == filled) {
            filled = system_read(buffer, sizeof buffer);
            used = 0;
            if (filled == 0)
                return 0;
        }
        line[length] = buffer[used++];
        if (line[length] == '\n')
            break;
        if (++length == LINE)
            fail("line too long", "");
    }
    line[length] = 0;
    rest = line;
    return 1;
}

/* The next word of the line. */
static char *word(void)
{
    char *start = rest;
    while (*rest && *rest != ' ')
        rest++;
    if (*rest)
        *rest++ = 0;
    return start;
}

static unsigned number(void)
{
    unsigned value = 0;
    const char *digits = word();
    for (; *digits; digits++)
        value = 10 * value + (unsigned)(*digits - '0');
    return value;
}

typedef union {
    uint64_t bits;
    double value;
} Real;

static double real(void)
{
    Real real;
    const char *digits = word();
    real.bits = 0;
    for (; *digits; digits++)
        real.bits = real.bits << 4 | (uint64_t)(*digits <= '9' ? *digits - '0' : *digits - 'a' + 10);
    return real.value;
}

static void write_real(double value)
{
    char digits[17];
    Real real;
    int k;
    real.value = value;
    for (k = 0; k < 16; k++)
        digits[k] = "0123456789abcdef"[real.bits >> (60 - 4 * k) & 15];
    digits[16] = ' ';
    system_write(digits, 17);
}

static void expect_ok(int status, const char *order)
{
    if (status != 0)
        fail("status not OK from", order);
}

static void open_library(const char *path)
{
    void *handle = system_open(path);
    if (handle == NULL)
        fail("cannot load", path);
#define FIND(member, name) *(void **)&library.member = system_symbol(handle, name)
    FIND(instantiate, "fmi2Instantiate");
    FIND(setup, "fmi2SetupExperiment");
    FIND(enter, "fmi2EnterInitializationMode");
    FIND(leave, "fmi2ExitInitializationMode");
    FIND(get_real, "fmi2GetReal");
    FIND(step, "fmi2DoStep");
#undef FIND
}

static void begin(const char *token)
{
    static const Callbacks callbacks = {logger, NULL, NULL, NULL, NULL};
    unit = library.instantiate("unit", 1, token, "file:///none", &callbacks, 0, 1);
    if (unit == NULL)
        fail("refused", token);
    expect_ok(library.setup(unit, 0, 0.0, 0.0, 0, 0.0), "fmi2SetupExperiment");
    expect_ok(library.enter(unit), "fmi2EnterInitializationMode");
    expect_ok(library.leave(unit), "fmi2ExitInitializationMode");
}

void run(void)
{
    size_t count, k;
    unsigned first;
    read_line();
    open_library(line);
    read_line();
    begin(line);
    read_line();
    first = number();
    count = number();
    if (count > REALS)
        fail("too many values", "");
    for (k = 0; k < count; k++)
        references[k] = first + (unsigned)k;
    while (read_line()) {
        const double time = real();
        expect_ok(library.step(unit, time, real(), 1), "fmi2DoStep");
        expect_ok(library.get_real(unit, references, count, reals), "fmi2GetReal");
        for (k = 0; k < count; k++)
            write_real(reals[k]);
        write_text("\n");
    }
    system_exit(0);
}
