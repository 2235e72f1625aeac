#include "rotor/friction.h"

#include "base/elementary.h"

int slider_place(const Slider *slider)
{
    return 2 * slider->station + slider->axis;
}

double slider_share(const Slider *slider, int place)
{
    if (!slider->row) {
        return place == slider_place(slider) ? 1.0 : 0.0;
    }
    return place % 2 == slider->axis ? slider->row[place] : 0.0;
}

double slider_along(const Slider *slider, int n, const double *stations)
{
    double sum = 0.0;
    int i;
    if (!slider->row) {
        return stations[slider_place(slider)];
    }
    for (i = slider->axis; i < 2 * n; i += 2) {
        sum += slider->row[i] * stations[i];
    }
    return sum;
}

bool slider_is_rigid(const Slider *slider)
{
    return slider->stiffness == 0.0 && slider->limit > 0.0;
}

bool slider_is_loose(const Slider *slider, const double *state)
{
    return slider->stroke > 0.0 && state[SLIPS] == 0.0 && state[SIDE] == 0.0;
}

void friction_at_start(const Slider *sliders, int count, int n, const double *places, const double *rates,
                       double *slider_states)
{
    int j;
    for (j = 0; j < count; j++, slider_states += SLIDER_DOUBLES) {
        const double rate = slider_along(sliders + j, n, rates), stroke = sliders[j].stroke;
        const double off = slider_along(sliders + j, n, places) - sliders[j].centre;
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

