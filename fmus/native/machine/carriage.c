/* How a station that is carried along moves. */
#include "machine/machine.h"

double machine_carry(Machine *m, const Carried *start, double time)
{
    Carried *now = m->carried;
    double turned = 0.0;
    int i, j;
    *now = *start;
    for (j = SIGNAL_ORDERS; j >= 0; j--) {
        turned = (turned + start->speed[j] * m->per[j + 1]) * time;
    }
    for (i = 0; i < SIGNAL_ORDERS && time != 0.0; i++) { /* about the new start, by Horner's rule */
        for (j = SIGNAL_ORDERS - 1; j >= i; j--) {
            now->speed[j] += time * now->speed[j + 1];
        }
        for (j = SIGNAL_ORDERS - 2; j >= i; j--) {
            now->signal[j] = pair_add_scaled(now->signal[j], now->signal[j + 1], time);
        }
    }
    for (j = 0; j <= SIGNAL_ORDERS; j++) {
        m->speed[j] = now->speed[j];
    }
    return turned;
}
