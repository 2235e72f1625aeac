/* Dry friction in the supports. */
#ifndef AUTOBALANCER_FRICTION_H
#define AUTOBALANCER_FRICTION_H

#include <stdbool.h>

/* Dry friction at a station along one axis (0 is x, 1 is y). */
typedef struct {
    int station, axis; /* from 0 */
    double limit;      /* force at which it slips [N]; 0: there is none */
    double stiffness;  /* of a spring in series [N/m]; 0: none, the slider is rigid */
} Slider;

/* What friction remembers of each slider, in pairs: the direction in which it slips, -1 or 1, 0 while
   it sticks; and its force on the rotor [N]. */
enum { SLIPS, HOLDS };

/* Where a slider's displacement is among those of the stations. */
int slider_place(const Slider *slider);
bool slider_is_rigid(const Slider *slider);

/* Sliders with slack springs; rigid ones slip with the rotor where it moves.

   rates: velocities of the stations. */
void friction_at_start(const Slider *sliders, int count, const double *rates, double *slider_states);


#endif
