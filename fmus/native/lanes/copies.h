/* Copies of the recurrence of machine/ for plain machines. */
#ifndef AUTOBALANCER_COPIES_H
#define AUTOBALANCER_COPIES_H

#include "machine/machine.h"

/* Expand a plain machine that has been started, as machine_expand does; false where there is no copy for it. */
bool copies_go_through(const Machine *machine, int order, bool is_beside);
/* machine_reach_end of a step by series. */
void copies_reach_end(Machine *machine, int order, double time);

#endif
