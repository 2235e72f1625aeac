#include "fmi/unit_token.h"

#include <string.h>

#include "fmi/unit.h"
#include "stamp.h"

enum { WORD_SIZE = 32, DIGITS = 16, SIGNATURE = 2 * DIGITS + 1 };

/* Sizes of a unit: products of four of them fit an int. */
enum { SIZE_COUNT = 14 };
static const Count SIZES[SIZE_COUNT] = {
    {"stations", 1, 1000}, {"planes", 1, 1000},  {"unbalances", 1, 10000}, {"weights", 1, 10000},
    {"sliders", 1, 1000},  {"points", 2, 10000}, {"unequal", 1, 1},       {"tables", 1, 1000},
    {"speeds", 2, 10000},  {"supports", 1, 2},   {"feet", 1, 1000},      {"cubics", 1, 1000},
    {"stops", 1, 1000},    {"lobes", 1, 1000}};

/* -- a unit and its sizes --------------------------------------------------------------------- */

const char *token_word(const char *at, char end, char *word, size_t size)
{
    size_t length = 0;
    for (; at[length] && at[length] != end && at[length] != ';'; length++) {
        if (length + 1 == size) {
            word[length] = 0;
            return NULL;
        }
        word[length] = at[length];
    }
    word[length] = 0;
    return at + length + (at[length] == end);
}

const char *token_count(const Count *count, const char *at, char end, int *value, Text *reason)
{
    uint64_t number;
    const char *behind = text_whole(at, 10, &number);
    if (behind == at || (*behind && *behind != end && *behind != ';') || number < (uint64_t)count->least ||
        number > (uint64_t)count->most) {
        text_format(reason, "%s: must be a whole number from %u to %u", count->key,
                    (unsigned long)count->least, (unsigned long)count->most);
        return NULL;
    }
    *value = (int)number;
    return behind + (*behind == end && end);
}

/* Where the digest at the end of a token begins. */
static const char *signature_of(const char *token)
{
    const size_t length = strlen(token);
    return token + (length > SIGNATURE ? length - SIGNATURE : 0);
}

/* Compare digest and stamp at the end of a token with what they must be; as token_read. */
static int check_signature(const char *token, Text *reason)
{
    const char *signature = signature_of(token);
    char expected[SIGNATURE + 1];
    Text words = text_in(expected, sizeof expected);
    text_hexadecimal(&words, hash_bytes(token, (size_t)(signature - token)));
    text_put(&words, "-");
    text_put(&words, STAMP);
    if (text_equal(signature, expected)) {
        return 0;
    }
    text_format(reason, "%s; expected at its end '%s'",
                strncmp(signature, expected, DIGITS)
                    ? "it is not as this library's model descriptions have it"
                    : "it was built from other sources than this library",
                expected);
    return 1;
}

/* Read a size; 1 with what is wrong. */
static int read_size(const char *key, const char *value, Sizes *sizes, Text *reason)
{
    int *const places[SIZE_COUNT] = {&sizes->stations, &sizes->planes, &sizes->unbalances, &sizes->weights,
                                     &sizes->sliders,  &sizes->points, &sizes->unequal,    &sizes->tables,
                                     &sizes->speeds,   &sizes->supports, &sizes->feet,     &sizes->cubics,
                                     &sizes->stops,    &sizes->lobes};
    int k;
    for (k = 0; k < SIZE_COUNT; k++) {
        if (text_equal(SIZES[k].key, key)) {
            return !token_count(SIZES + k, value, 0, places[k], reason);
        }
    }
    text_format(reason, "has an option that this library does not know, %s", key);
    return 1;
}

/* Whether the unit of a table exists in these sizes. */
static bool exists(const Table *table, const Sizes *sizes)
{
    const int n = sizes->stations;
    return !(text_equal(table->kind, "planar") && n != 1) &&
           !(text_equal(table->kind, "two_support") && n != 2) &&
           !(text_equal(table->kind, "flexible") && n < 2) &&
           layout_count(table, sizes, MOST_REALS) <= MOST_REALS;
}

/* The supports of a kind that has as many in every size; those of given matrices are an option. */
static void set_supports(const char *kind, Sizes *sizes)
{
    if (text_equal(kind, "planar")) {
        sizes->supports = 1;
    } else if (text_equal(kind, "two_support") || text_equal(kind, "flexible")) {
        sizes->supports = 2;
    }
}

/* The table of a unit's variables and its sizes by its token's options; 1 with what is wrong. */
static int read_options(const char *token, const Table **table, Sizes *sizes, Text *reason)
{
    char unit[WORD_SIZE], key[WORD_SIZE], value[WORD_SIZE];
    char kind[WORD_SIZE] = "", shaft[WORD_SIZE] = "";
    const char *end = signature_of(token), *at = token_word(token, '/', unit, sizeof unit);
    while (at && at < end) {
        char *word;
        at = token_word(at, '=', key, sizeof key);
        word = text_equal(key, "kind") ? kind : text_equal(key, "shaft") ? shaft : value;
        at = at ? token_word(at, '/', word, WORD_SIZE) : NULL;
        if (text_equal(key, "frame")) {
            sizes->fixed_frame = text_equal(value, "fixed");
        } else if (word == value) {
            if (!at) {
                break;
            }
            if (read_size(key, value, sizes, reason)) {
                return 1;
            }
        }
    }
    *table = at ? table_of(unit, kind, shaft) : NULL;
    set_supports(kind, sizes);
    if (!*table || !exists(*table, sizes)) {
        text_put(reason, *table ? "has a size in which this unit does not exist"
                                : "names a unit that this library does not have");
        return 1;
    }
    return 0;
}

int token_read(const char *token, const Table **table, Sizes *sizes, Text *reason)
{
    const Sizes none = {1, 1, 1, 1, 0, 2, 0, 2, 0, 0, 0, 0, 0, 0, 0};
    *sizes = none;
    text_format(reason, "identity '%s': ", token ? token : "");
    if (!token || strlen(token) >= TOKEN_SIZE) {
        text_put(reason, "must be that of the model description this library came with");
        return 1;
    }
    if (check_signature(token, reason)) {
        return 1;
    }
    return read_options(token, table, sizes, reason);
}

/* -- start values ----------------------------------------------------------------------------- */

bool token_abbreviated(const char *token)
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
    text_hexadecimal(identity, hash_bytes(text, strlen(text)));
}

const char *token_next(const char *at)
{
    for (; *at && *at != ';'; at++) {
    }
    return *at ? at + 1 : at;
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
