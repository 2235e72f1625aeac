/* What a GUID (FMI 2.0) or instantiation token (FMI 3.0) says: unit, sizes, sources.

       BallBalancer/frame=rotor/weights=3/<digest of all before it>-<stamp of the sources>

   One library serves every unit and size, and refuses a model description that is not its own: the
   stamp is a hash of the declared variables too.  A unit
   with start values of its own has these behind its token in a text among the FMU's resources:

       BallBalancer/...;start=0:3f847ae147ae147b,2:3ff0000000000000;flags=1

   Value references and the bits of what they start from; Booleans that are true.  The identity is then
   BallBalancer/<hash of the text>, which tools use as a name of files; so it is of a composite. */
#ifndef AUTOBALANCER_UNIT_TOKEN_H
#define AUTOBALANCER_UNIT_TOKEN_H

#include <stdbool.h>

#include "fmi/variables.h"

enum { TOKEN_SIZE = 192, MOST_REALS = 1000000 };

/* A whole number that a token or a composition states, and its limits. */
typedef struct {
    const char *key;
    int least, most;
} Count;

/* Read the digits up to the end of an entry, or up to `end`; where the text goes on behind them, or NULL and
   what is wrong added to `reason`. */
const char *token_count(const Count *count, const char *at, char end, int *value, Text *reason);

/* Check a unit's token and read it; 0, or 1 and what is wrong with it added to `reason`. */
int token_read(const char *token, const Table **table, Sizes *sizes, Text *reason);
/* Copy the text up to `end`, or to the end of its entry; where it goes on behind, NULL when it is too
   long. */
const char *token_word(const char *at, char end, char *word, size_t size);
/* Whether a token is the identity alone, and the identity that belongs to a text. */
bool token_abbreviated(const char *token);
void token_identity(const char *text, Text *identity);
/* Where the next entry of a text begins; its end where there is none. */
const char *token_next(const char *at);
/* Start values "3:<bits>,5:<bits>" into an array, and flags "0,2" into Booleans; 1 where they are none. */
int token_starts(const char *at, double *starts, size_t count);
int token_flags(const char *at, unsigned char *flags, size_t count);

#endif
