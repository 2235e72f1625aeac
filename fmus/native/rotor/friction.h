/* Dry friction in the supports. */
#ifndef AUTOBALANCER_FRICTION_H
#define AUTOBALANCER_FRICTION_H

#include <stdbool.h>

/* Dry friction at a station along one axis (0 is x, 1 is y), or across a row of the stations. */
typedef struct {
    int station, axis; /* from 0 */
    const double *row; /* (n, 2) displacement by that of the stations, of a spring; NULL: that of the station */
    int support;       /* number from 1 of the support, or foot behind them, that has it; 0: none */
    double limit;      /* force at which it slips [N]; 0: there is none */
    double stiffness;  /* of a spring in series [N/m]; 0: none, the slider is rigid */
    double stroke;     /* half of the free stroke on the way to that spring, and the displacement in its */
    double centre;     /* middle at the start, unless that lies outside [m] */
} Slider;

/* What friction remembers of each slider: the direction in which it slips, -1 or 1, 0 while it sticks; its
   force on the rotor [N]; and with a free stroke the side on which its spring is in contact, -1 or 1, 0
   while it is within the stroke, and the displacement from the middle of the stroke there [m]. */
enum { SLIPS, HOLDS, SIDE, PLAY, SLIDER_DOUBLES };

/* Where the displacement of a slider at a station is among those of the stations. */
int slider_place(const Slider *slider);
/* Part that a place among the displacements of the stations has in that of a slider. */
double slider_share(const Slider *slider, int place);
/* Displacement of a slider by those of n stations (n, 2), or its rate by theirs. */
double slider_along(const Slider *slider, int n, const double *stations);
bool slider_is_rigid(const Slider *slider);
/* Whether it sticks within its free stroke, without force. */
bool slider_is_loose(const Slider *slider, const double *slider_state);

/* Sliders with slack springs; rigid ones slip with the rotor where it moves.

   places, rates: displacements and velocities of n stations. */
void friction_at_start(const Slider *sliders, int count, int n, const double *places, const double *rates,
                       double *slider_states);

#endif
