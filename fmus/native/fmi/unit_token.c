#include "fmi/unit_token.h"

#include <string.h>

#include "fmi/unit.h"
#include "stamp.h"

enum { WORD_SIZE = 32, MOST_OF_ANYTHING = 100000, DIGITS = 16, SIGNATURE = 2 * DIGITS + 1 };

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

/* Where the size of this name stands, or NULL. */
static int *size_named(Sizes *sizes, const char *name)
{
    return text_equal(name, "stations")     ? &sizes->stations
           : text_equal(name, "planes")     ? &sizes->planes
           : text_equal(name, "unbalances") ? &sizes->unbalances
           : text_equal(name, "weights")    ? &sizes->weights
           : text_equal(name, "sliders")    ? &sizes->sliders
           : text_equal(name, "points")     ? &sizes->points
           : text_equal(name, "unequal")    ? &sizes->unequal
                                            : NULL;
}

/* The table of a unit's variables and its sizes by its token's options; why not, or NULL. */
static const char *read_options(const char *token, const Table **table, Sizes *sizes)
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
            int *size = size_named(sizes, key);
            uint64_t number;
            text_whole(value, 10, &number);
            if (!size || number < 1 || number > MOST_OF_ANYTHING) {
                return "has an option or a size that this library does not know";
            }
            *size = (int)number;
        }
    }
    *table = at ? table_of(unit, kind, shaft) : NULL;
    if (!*table) {
        return "names a unit that this library does not have";
    }
    if ((text_equal(kind, "planar") && sizes->stations != 1) ||
        (text_equal(kind, "two_support") && sizes->stations != 2) ||
        (text_equal(kind, "flexible") && sizes->stations < 2) || sizes->points < 2 ||
        layout_count(*table, sizes, MOST_REALS) > MOST_REALS) {
        return "has a size in which this unit does not exist";
    }
    return NULL;
}

int token_read(const char *token, const Table **table, Sizes *sizes, Text *reason)
{
    const Sizes none = {1, 1, 1, 1, 0, 2, 0, 0};
    const char *wrong;
    *sizes = none;
    text_format(reason, "identity '%s': ", token ? token : "");
    if (!token || strlen(token) >= TOKEN_SIZE) {
        text_put(reason, "must be that of the model description this library came with");
        return 1;
    }
    if (check_signature(token, reason)) {
        return 1;
    }
    wrong = read_options(token, table, sizes);
    text_put(reason, wrong ? wrong : "");
    return wrong != NULL;
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
