/* What a GUID (FMI 2.0) or instantiation token (FMI 3.0) says: unit, sizes, layout, sources.

       BallBalancer/frame=rotor/weights=3/<digest of the layout>-<stamp of the sources>

   One library serves every unit and size, and refuses a model description that is not its own. */
#ifndef AUTOBALANCER_TOKEN_H
#define AUTOBALANCER_TOKEN_H

#include "fmi/variables.h"

enum { TOKEN_SIZE = 192, MOST_REALS = 1000000 };

/* Read a token's unit and sizes; 0, or 1 and what is wrong with it added to `reason`. */
int token_read(const char *token, const Table **table, Sizes *sizes, Text *reason);
/* Compare a token with what it must be for this layout and library; as token_read. */
int token_check(const char *token, const Layout *layout, uint64_t digest, Text *reason);

#endif
