#include "rotor/friction.h"

#include "base/elementary.h"

int slider_place(const Slider *slider)
{
    return 2 * slider->station + slider->axis;
}

bool slider_is_rigid(const Slider *slider)
{
    return slider->stiffness == 0.0 && slider->limit > 0.0;
}

bool slider_is_loose(const Slider *slider, const double *state)
{
    return slider->stroke > 0.0 && state[SLIPS] == 0.0 && state[SIDE] == 0.0;
}

void friction_at_start(const Slider *sliders, int count, const double *places, const double *rates,
                       double *slider_states)
{
    int j;
    for (j = 0; j < count; j++, slider_states += SLIDER_DOUBLES) {
        const double rate = rates[slider_place(sliders + j)], stroke = sliders[j].stroke;
        const double off = places[slider_place(sliders + j)] - sliders[j].centre;
        slider_states[SLIPS] = slider_states[HOLDS] = slider_states[SIDE] = 0.0;
        slider_states[PLAY] = larger(-stroke, smaller(off, stroke));
        if (sliders[j].limit == 0.0) {
            slider_states[SLIPS] = 1.0; /* and never sticks */
        } else if (slider_is_rigid(sliders + j) && rate != 0.0) {
            slider_states[SLIPS] = copy_sign(1.0, rate);
            slider_states[HOLDS] = -slider_states[SLIPS] * sliders[j].limit;
        }
    }
}

