/* Copies of the recurrence of machine/ for plain machines. */
#ifndef AUTOBALANCER_COPIES_H
#define AUTOBALANCER_COPIES_H

#include "machine/machine.h"

/* expand_simple and go_through_copy of machine/orders_copies.h. */
void copies_expand_simple(Machine *machine, double angle, int order);
void copies_go_through(const Machine *machine, int order, bool is_beside);
/* machine_reach_end of a step by series. */
void copies_reach_end(Machine *machine, int order, double time);

#endif
