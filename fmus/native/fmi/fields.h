/* What the doubles of a state may be: its table of fields.

   Each file that keeps something in a state declares it in one function, in the order in which it
   lies there: name, place, kind and limits.

       static void declare_drive(Fields *fields, const Composite *c)
       {
           const DriveSignal *drive = fields_here(fields);
           fields_number(fields, "drive.speed", &drive->speed, 1);
           fields_whole(fields, "drive.passed", &drive->passed, 1, 0.0, c->corner_count);
       }

   A state that was read from bytes is compared with all of this before anything is taken over.  So
   every count, index, flag and bound of a loop must be declared as whole, with the limits that the
   memory has. A place that does not follow the one before, or a table that ends too early, is an
   error of the table: every state is refused then. */
#ifndef AUTOBALANCER_FIELDS_H
#define AUTOBALANCER_FIELDS_H

#include <stddef.h>

#include "base/text.h"

#define MOST_COUNTED 9e15 /* of what only counts: whole numbers are exact up to there */

typedef struct {
    const double *next, *end; /* the double that is declared next, and the end of the state */
    const double *real;       /* values of all variables in the same state */
    const char *owner;        /* part that has the fields, NULL: the unit itself */
    int wrong;
    Text *reason;             /* what is wrong first */
} Fields;

/* Table of the doubles at `memory`, which belong to these variables. */
Fields fields_of(const double *memory, size_t count, const double *real, Text *reason);
/* Where the next field lies, as the struct that stands there. */
const void *fields_here(const Fields *fields);

/* `count` doubles from `place` on, which are computed with and no more: finite; */
void fields_number(Fields *fields, const char *name, const double *place, size_t count);
/* the same between limits; */
void fields_within(Fields *fields, const char *name, const double *place, size_t count, double least,
                   double most);
/* whole numbers between limits: counts, indices, bounds of loops; */
void fields_whole(Fields *fields, const char *name, const double *place, size_t count, double least,
                  double most);
/* true or false, as 1 or 0; */
void fields_flag(Fields *fields, const char *name, const double *place);
/* equal to others of the same state; */
void fields_same(Fields *fields, const char *name, const double *place, size_t count,
                 const double *others);
/* anything, where nothing reads it before it is written or checked. */
void fields_any(Fields *fields, const double *place, size_t count);

/* 0, or 1 with the reason: a field is not allowed, or the table does not end with the state. */
int fields_wrong(Fields *fields);

#endif
