#include "machine/blocks.h"

#include "machine/machine.h"

static NumberBlock *add_block(NumberBlock *next, const void *first, size_t count)
{
    next->first = (double *)first;
    next->count = count;
    return next + 1;
}

void machine_shape(const Machine *m, int *shape)
{
    int k;
    *shape++ = m->stations;
    *shape++ = m->weight_count;
    *shape++ = m->track_count;
    *shape++ = m->width;
    *shape++ = m->unknowns;
    *shape++ = m->turns;
    *shape++ = m->crossed;
    *shape++ = !number_is_zero(m->speed[1]);
    for (k = 0; k < m->track_count; k++) {
        *shape++ = m->tracks[k].first;
        *shape++ = m->tracks[k].end;
        *shape++ = m->tracks[k].is_off;
        *shape++ = m->tracks[k].lobes;
    }
}

void machine_reshape(Machine *m, const int *shape)
{
    int k, w;
    m->stations = shape[0];
    m->weight_count = shape[1];
    m->track_count = shape[2];
    m->width = shape[3];
    m->unknowns = shape[4];
    m->turns = shape[5];
    m->crossed = shape[6];
    shape += SHAPE_SIZE;
    for (k = 0; k < m->track_count; k++) {
        m->tracks[k].first = *shape++;
        m->tracks[k].end = *shape++;
        m->tracks[k].is_off = *shape++;
        m->tracks[k].lobes = *shape++;
        for (w = m->tracks[k].first; w < m->tracks[k].end; w++) {
            struct SeriesRace *race = m->tracks[k].lobes ? m->races[w] : NULL;
            m->weights[w].race = race;
            if (race) {
                race->lobes = m->tracks[k].lobes;
                race->lobe = m->tracks[k].lobe;
            }
        }
    }
}

int machine_constants(const Machine *m, NumberBlock *blocks)
{
    const size_t n = (size_t)m->stations, square = n * n;
    NumberBlock *next = blocks;
    int k;
    next = add_block(next, m->mass, square);
    next = add_block(next, m->stiffness, 2 * square);
    next = add_block(next, m->damping, 2 * square);
    next = add_block(next, m->cross_stiffness, 2 * square);
    next = add_block(next, m->cross_damping, 2 * square);
    next = add_block(next, m->internal_damping, square);
    next = add_block(next, m->gyroscopic, square);
    next = add_block(next, m->unbalance, 2 * n);
    next = add_block(next, &m->gravity, 2);
    next = add_block(next, &m->drive.inertia, 1);
    for (k = 0; k < m->track_count; k++) {
        next = add_block(next, m->tracks[k].row, n);
        next = add_block(next, &m->tracks[k].offset, 2);
        next = add_block(next, &m->tracks[k].mass, 1);
        next = add_block(next, m->tracks[k].lobe, LOBE_NUMBERS * (size_t)m->tracks[k].lobes);
    }
    for (k = 0; k < m->weight_count; k++) {
        const struct SeriesRace *race = m->weights[k].race;
        next = add_block(next, &m->weights[k].moment, WEIGHT_NUMBERS);
        next = add_block(next, race ? &race->mass : NULL, race ? RACE_NUMBERS : 0);
    }
    return (int)(next - blocks);
}

int machine_state(const Machine *m, NumberBlock *blocks)
{
    const size_t width = (size_t)m->width;
    NumberBlock *next = blocks;
    next = add_block(next, m->push, 2 * SIGNAL_ORDERS * (size_t)m->stations);
    next = add_block(next, m->motion, 2 * width);
    next = add_block(next, m->velocity, 2 * width);
    next = add_block(next, m->speed, 2);
    next = add_block(next, &m->drive.torque, 2);
    return (int)(next - blocks);
}

int machine_results(const Machine *m, int order, NumberBlock *blocks)
{
    const size_t width = (size_t)m->width, last = (size_t)order;
    NumberBlock *next = blocks;
    next = add_block(next, m->motion + width, 2 * width * last);
    next = add_block(next, m->velocity + width, 2 * width * (last - 1));
    if (m->drive.motor) {
        next = add_block(next, m->speed + 1, last - 1);
    }
    return (int)(next - blocks);
}
