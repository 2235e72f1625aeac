/* What is made for a speed and the masses that the planes carry, and how it is laid out. */
#include <string.h>

#include "units/rotor.h"

static const double *added_masses(const Unit *unit)
{
    return unit->real + unit->layout.inputs.first;
}

double *rotor_drive(Unit *unit)
{
    return unit->real + unit->layout.inputs.first + ((const Rotor *)unit->own)->planes;
}

int rotor_is_of(const Unit *unit, const MadeFor *of, double speed)
{
    const size_t size = (size_t)((const Rotor *)unit->own)->planes * sizeof(double);
    return of->made && of->speed == speed && !memcmp(of->added_mass, added_masses(unit), size);
}

LinearRotor rotor_anew(Unit *unit, MadeFor *of)
{
    Rotor *own = unit->own;
    of->made = 0;
    return linear_rotor_with_added_mass(&own->rotor, added_masses(unit), own->loaded_mass);
}

void rotor_made(const Unit *unit, MadeFor *of, double speed)
{
    const size_t size = (size_t)((const Rotor *)unit->own)->planes * sizeof(double);
    memcpy(of->added_mass, added_masses(unit), size);
    of->speed = speed;
    of->made = 1;
}

/* Where the k-th element of blocks with x and y alternating stands when every block is
   (x..., y...); `ends` are where the blocks end, in pairs. */
static int alternating(const int *ends, int k)
{
    int block = 0, first, size;
    while (k / 2 >= ends[block]) {
        block++;
    }
    first = block ? ends[block - 1] : 0;
    size = ends[block] - first;
    return 2 * first + (k / 2 - first) + (k % 2) * size;
}

int rotor_column(const Rotor *own, int k)
{
    const int n = own->stations, p = own->planes, f = 2 * n;
    int ends[QUINTIC_ORDERS + 3] = {n, f}, j;
    for (j = 1; j <= own->orders; j++) {
        ends[1 + j] = f + j * p;
    }
    ends[1 + j] = f + own->orders * p + 1;
    return alternating(ends, k);
}

void rotor_vectors_at(const double *rows, int count, int n, const double *vectors, double *result)
{
    int i, j;
    for (i = 0; i < count; i++, result += 2) {
        result[0] = result[1] = 0.0;
        for (j = 0; j < n; j++) {
            result[0] += rows[i * n + j] * vectors[2 * j];
            result[1] += rows[i * n + j] * vectors[2 * j + 1];
        }
    }
}
