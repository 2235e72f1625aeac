#include "fmi/token.h"

#include <string.h>

#include "stamp.h"

enum { WORD_SIZE = 32, MOST_OF_ANYTHING = 100000 };

/* The word up to `end`, and where the text goes on behind it; NULL when there is none. */
static const char *word_until(const char *at, char end, char *word)
{
    size_t length = 0;
    while (at[length] && at[length] != end) {
        if (length == WORD_SIZE - 1) {
            return NULL;
        }
        word[length] = at[length];
        length++;
    }
    word[length] = 0;
    return at[length] == end ? at + length + 1 : NULL;
}

/* A whole number of at least 1; 0 for anything else. */
static int whole_number(const char *word)
{
    int value = 0;
    for (; *word; word++) {
        if (*word < '0' || *word > '9' || value > MOST_OF_ANYTHING) {
            return 0;
        }
        value = 10 * value + (*word - '0');
    }
    return value <= MOST_OF_ANYTHING ? value : 0;
}

static int refuse_token(Text *reason, const char *token, const char *why)
{
    text_put(reason, "identity '");
    text_put(reason, token);
    text_put(reason, "': ");
    text_put(reason, why);
    return 1;
}

int token_read(const char *token, const Table **table, Sizes *sizes, Text *reason)
{
    char unit[WORD_SIZE], key[WORD_SIZE], value[WORD_SIZE], kind[WORD_SIZE], shaft[WORD_SIZE];
    const char *at;
    const Sizes none = {1, 1, 1, 1, 0, 2, 0, 3, 0};
    *sizes = none;
    kind[0] = shaft[0] = 0;
    at = token ? word_until(token, '/', unit) : NULL;
    if (!at) {
        return refuse_token(reason, token ? token : "",
                      "must be that of the model description this library came with");
    }
    for (;;) {
        const char *next = word_until(at, '=', key);
        char *kept = text_equal(key, "kind") ? kind : text_equal(key, "shaft") ? shaft : value;
        if (!next) {
            break;
        }
        at = word_until(next, '/', kept);
        if (!at) {
            return refuse_token(reason, token, "ends too early");
        }
        if (kept != value) {
            continue;
        }
        if (text_equal(key, "frame")) {
            sizes->fixed_frame = text_equal(value, "fixed");
        } else {
            int *size = text_equal(key, "stations")     ? &sizes->stations
                        : text_equal(key, "planes")     ? &sizes->planes
                        : text_equal(key, "unbalances") ? &sizes->unbalances
                        : text_equal(key, "weights")    ? &sizes->weights
                        : text_equal(key, "sliders")    ? &sizes->sliders
                        : text_equal(key, "points")     ? &sizes->points
                        : text_equal(key, "order")      ? &sizes->order
                        : text_equal(key, "unequal")    ? &sizes->unequal
                                                        : NULL;
            if (!size) {
                return refuse_token(reason, token, "has an option this library does not know");
            }
            *size = whole_number(value);
            if (*size < 1) {
                return refuse_token(reason, token, "has a size that is no whole number of at least 1");
            }
        }
    }
    *table = table_of(unit, kind, shaft, sizes->order);
    if (!*table) {
        return refuse_token(reason, token, "names a unit that this library does not have");
    }
    if ((text_equal(kind, "planar") && sizes->stations != 1) ||
        (text_equal(kind, "two_support") && sizes->stations != 2) ||
        (text_equal(kind, "flexible") && sizes->stations < 2) || sizes->points < 2 ||
        (sizes->order != 3 && sizes->sliders) ||
        layout_count(*table, sizes, MOST_REALS) > MOST_REALS) {
        return refuse_token(reason, token, "has a size in which this unit does not exist");
    }
    return 0;
}

static void put_option(Text *text, const char *key, const char *value)
{
    text_put(text, key);
    text_put(text, value);
    text_put(text, "/");
}

static void put_size(Text *text, const char *key, int value)
{
    text_put(text, key);
    text_integer(text, (unsigned long)value);
    text_put(text, "/");
}

/* The token up to its digest, as layout.py writes it. */
static void put_options(Text *text, const Layout *layout)
{
    const Table *table = layout->table;
    const Sizes *sizes = &layout->sizes;
    put_option(text, table->unit, "");
    put_option(text, "frame=", sizes->fixed_frame ? "fixed" : "rotor");
    if (table->kind[0]) {
        put_option(text, "kind=", table->kind);
    }
    if (sizes->order != 3) {
        put_size(text, "order=", sizes->order);
    }
    if (table->kind[0]) {
        put_size(text, "planes=", sizes->planes);
        if (table->shaft[0]) {
            put_option(text, "shaft=", table->shaft);
        }
        if (sizes->sliders) {
            put_size(text, "sliders=", sizes->sliders);
        }
        put_size(text, "stations=", sizes->stations);
        if (!text_equal(table->kind, "planar")) {
            put_size(text, "unbalances=", sizes->unbalances);
        }
    } else if (text_equal(table->unit, "BallBalancer")) {
        if (sizes->unequal) {
            put_size(text, "unequal=", sizes->unequal);
        }
        put_size(text, "weights=", sizes->weights);
    } else if (text_equal(table->unit, "Motor")) {
        put_size(text, "points=", sizes->points);
    }
}

/* Length of what two texts begin with alike. */
static size_t common(const char *a, const char *b)
{
    size_t length = 0;
    while (a[length] && a[length] == b[length]) {
        length++;
    }
    return length;
}

int token_check(const char *token, const Layout *layout, uint64_t digest, Text *reason)
{
    char expected[TOKEN_SIZE];
    Text text = text_in(expected, sizeof expected);
    size_t options, stamp, alike;
    put_options(&text, layout);
    options = text.length;
    text_hexadecimal(&text, digest);
    text_put(&text, "-");
    stamp = text.length;
    text_put(&text, STAMP);
    if (text_equal(token, expected)) {
        return 0;
    }
    alike = common(token, expected);
    refuse_token(reason, token,
           alike < options ? "its options are not written as this library writes them"
           : alike < stamp ? "its variables are not those of this library"
                           : "it was built from other sources than this library");
    text_put(reason, "; expected '");
    text_put(reason, expected);
    text_put(reason, "'");
    return 1;
}

/* -- start values ----------------------------------------------------------------------------- */

int token_abbreviated(const char *token)
{
    size_t name = 0, digits = 1;
    for (; token && token[name] && token[name] != '/'; name++) {
    }
    if (!token || !token[name]) {
        return 0;
    }
    for (; text_digit(token[name + digits]) < 16; digits++) {
    }
    return digits == 17 && !token[name + digits];
}

void token_identity(const char *text, Text *identity)
{
    size_t name = 0;
    for (; text[name] && text[name] != '/' && text[name] != ';'; name++) {
    }
    text_put_part(identity, text, name);
    text_put(identity, "/");
    text_hexadecimal(identity, hash_bytes(hash_start(), text, text_length(text)));
}

const char *token_next(const char *at)
{
    for (; *at && *at != ';'; at++) {
    }
    return *at ? at + 1 : NULL;
}

int token_starts(const char *at, double *starts, size_t count)
{
    for (;;) {
        uint64_t reference, bits;
        at = text_whole(at, 10, &reference);
        if (*at != ':' || reference >= count) {
            return 1;
        }
        at = text_whole(at + 1, 16, &bits);
        memcpy(starts + reference, &bits, sizeof bits);
        if (*at != ',') {
            return *at && *at != ';';
        }
        at++;
    }
}

int token_flags(const char *at, unsigned char *flags, size_t count)
{
    for (;;) {
        uint64_t flag;
        at = text_whole(at, 10, &flag);
        if (flag >= count) {
            return 1;
        }
        flags[flag] = 1;
        if (*at != ',') {
            return *at && *at != ';';
        }
        at++;
    }
}
