#include "machine/race_series.h"

#include "base/elementary.h"

struct SeriesRace *series_race_allocate(Unit *unit, int lobes)
{
    struct SeriesRace *race = unit_allocate(unit, 1, sizeof *race);
    Pair **const pairs[] = {&race->slope, &race->place, &race->moved, &race->tangent, &race->drawn, &race->felt};
    Number **const numbers[] = {&race->turning, &race->stretch, &race->run, &race->rolled};
    size_t k;
    int missing = !race;
    if (missing) {
        return NULL;
    }
    race->waves = unit_allocate(unit, (size_t)lobes * SERIES_LENGTH, sizeof(Pair));
    missing |= !race->waves;
    for (k = 0; k < sizeof pairs / sizeof *pairs; k++) {
        *pairs[k] = unit_allocate(unit, SERIES_LENGTH, sizeof(Pair));
        missing |= !*pairs[k];
    }
    for (k = 0; k < sizeof numbers / sizeof *numbers; k++) {
        *numbers[k] = unit_allocate(unit, SERIES_LENGTH, sizeof(Number));
        missing |= !*numbers[k];
    }
    return missing ? NULL : race;
}

void series_race_take(SeriesWeight *weight, const Weights *one, const Number *lobe, double per_rate)
{
    struct SeriesRace *race = weight->race;
    race->lobes = one->lobes;
    race->lobe = lobe;
    race->mass = number_of(one->mass);
    race->kappa = number_of(one->kappa);
    race->radius = number_of(one->track_radius);
    race->body = number_of(one->radius);
    race->slowing = number_of(one->drag / one->mass * per_rate);
}

/* Coefficient k of the product of two series, from that of order `from` of the first on. */
static Number product(const Number *a, const Number *b, int from, int k)
{
    Number sum = number_of(0.0);
    int j;
    for (j = from; j <= k; j++) {
        sum += a[j] * b[k - j];
    }
    return sum;
}

static Pair product_of_pairs(const Pair *a, const Pair *b, int from, int k)
{
    Pair sum = pair_zero();
    int j;
    for (j = from; j <= k; j++) {
        sum = pair_sum(sum, pair_product(a[j], b[k - j]));
    }
    return sum;
}

static Pair scaled_product(const Pair *a, const Number *b, int from, int k)
{
    Pair sum = pair_zero();
    int j;
    for (j = from; j <= k; j++) {
        sum = pair_add_scaled(sum, a[j], b[k - j]);
    }
    return sum;
}

/* Re(a* b) */
static Number along(Pair a, Pair b)
{
    const Pair both = pair_times(a, b);
    return pair_x(both) + pair_y(both);
}

static Number along_series(const Pair *a, const Pair *b, int from, int k)
{
    Pair sum = pair_zero();
    int j;
    for (j = from; j <= k; j++) {
        sum = pair_add_times(sum, a[j], b[k - j]);
    }
    return pair_x(sum) + pair_y(sum);
}

/* What all waves are together: rho' and rho of order k. */
static void add_waves(struct SeriesRace *race, int k)
{
    Number rho = k ? number_of(0.0) : race->radius, slope = number_of(0.0);
    int n;
    for (n = 0; n < race->lobes; n++) {
        const Pair wave = race->waves[n * SERIES_LENGTH + k];
        rho += pair_x(wave);
        slope -= race->lobe[n * LOBE_NUMBERS] * pair_y(wave);
    }
    race->slope[k] = pair_of(slope, rho);
}

void series_race_start(SeriesWeight *weight, Number angle, Number speed, Number rotor_speed)
{
    struct SeriesRace *race = weight->race;
    const Pair p = weight->unit[0];
    Number length, square;
    int n;
    for (n = 0; n < race->lobes; n++) {
        const Number *lobe = race->lobe + n * LOBE_NUMBERS;
        race->waves[n * SERIES_LENGTH] = pair_scaled(pair_direction(lobe[0] * (angle - lobe[2])), lobe[1]);
    }
    add_waves(race, 0);
    race->tangent[0] = pair_product(race->slope[0], p);
    race->drawn[0] = pair_scaled(p, pair_x(race->slope[0]));
    race->place[0] = pair_scaled(p, pair_y(race->slope[0]));
    race->moved[0] = pair_add_scaled(pair_scaled(race->tangent[0], speed), pair_turned(race->place[0]), rotor_speed);
    square = along(race->slope[0], race->slope[0]);
    length = number_root(square);
    race->stretch[0] = length;
    square = square / (race->radius * race->radius);
    weight->share = race->mass / race->kappa * square;
    weight->moment = race->mass * race->radius * square;
    weight->along = pair_scaled(pair_turned_back(race->tangent[0]), 1.0 / (race->radius * square));
    weight->roll = (race->kappa - 1.0) * (race->radius / length) * (length + race->body) +
                   pair_x(race->slope[0]) * pair_crossed(weight->along, p);
}

/* Everything of order k + 1 that follows from phi' of order k; k = 0 beside what is known at the start. */
static void extend(SeriesWeight *weight, int k, Number speed)
{
    struct SeriesRace *race = weight->race;
    const Number per = number_of(1.0 / (k + 1));
    Number square = number_of(0.0);
    int n, j;
    race->turning[k] = speed;
    for (n = 0; n < race->lobes; n++) {
        Pair *wave = race->waves + n * SERIES_LENGTH;
        const Pair turned = pair_turned(scaled_product(wave, race->turning, 0, k));
        wave[k + 1] = pair_scaled(turned, race->lobe[n * LOBE_NUMBERS] * per);
    }
    add_waves(race, k + 1);
    race->place[k + 1] = pair_scaled(race->moved[k], per);
    race->tangent[k + 1] = product_of_pairs(race->slope, weight->unit, 0, k + 1);
    race->drawn[k + 1] = pair_zero();
    for (j = 0; j <= k + 1; j++) {
        race->drawn[k + 1] = pair_add_scaled(race->drawn[k + 1], weight->unit[k + 1 - j], pair_x(race->slope[j]));
        square += along(race->slope[j], race->slope[k + 1 - j]);
    }
    for (j = 1; j <= k; j++) {
        square -= race->stretch[j] * race->stretch[k + 1 - j];
    }
    race->stretch[k + 1] = 0.5 * square / race->stretch[0];
    race->run[k] = product(race->stretch, race->turning, 0, k);
}

void series_race_advance(SeriesWeight *weight, int k, Pair known, Number speed, Number carried, Turning rotor)
{
    struct SeriesRace *race = weight->race;
    const Number next = number_of(k + 1);
    const int first = rotor.order < k + 1 ? k + 1 - rotor.order : 0; /* below, the speed has nothing */
    Pair swept = pair_zero(), turned = pair_zero();
    Number left, rolled;
    int j;
    extend(weight, k, speed);
    for (j = 0; j <= k; j++) {
        turned = pair_add_times(turned, weight->unit[k + 1 - j], weight->rate[j]);
    }
    weight->turned = pair_scaled(turned, next);
    for (j = first; j <= k + 1; j++) {
        swept = pair_add_scaled(swept, race->place[j], rotor.speed[k + 1 - j]);
    }
    race->carried = carried;
    race->moved[k + 1] = pair_sum(scaled_product(race->tangent, race->turning, 1, k + 1), pair_turned(swept));
    race->rolled[k] = next * product(race->stretch, race->turning, 1, k + 1) - race->body * carried;
    rolled = race->stretch[0] * race->rolled[k] + product(race->stretch, race->rolled, 1, k);
    left = along(race->tangent[0], pair_add_scaled(known, race->moved[k + 1], next)) +
           along_series(race->tangent, race->felt, 1, k) + (race->kappa - 1.0) * rolled +
           race->slowing * product(race->stretch, race->run, 0, k);
    weight->free = carried - left / (race->kappa * race->stretch[0] * race->stretch[0]);
}

Pair series_race_known(const SeriesWeight *weight, int k)
{
    const struct SeriesRace *race = weight->race;
    const Pair known = pair_scaled(race->moved[k + 1], number_of(k + 1));
    return pair_add_scaled(known, race->tangent[0], weight->free - race->carried);
}

void series_race_finish(SeriesWeight *weight, int k, Number acceleration, Number spun, Number spun_late, Pair pull)
{
    struct SeriesRace *race = weight->race;
    const Number second = acceleration - spun;
    Pair beside = pair_add_scaled(pair_scaled(race->moved[k + 1], number_of(k + 1)), race->tangent[0], second);
    beside = pair_add_scaled(beside, pair_turned(race->place[0]), spun_late);
    race->moved[k + 1] = pair_scaled(beside, number_of(1.0 / (k + 1)));
    race->rolled[k] += race->stretch[0] * second - race->body * spun_late;
    race->felt[k] = pair_sum(pair_turned(pull), beside);
}

Number series_race_torque(const SeriesWeight *weight, int k, const Pair *spin, Pair offset, Pair known)
{
    const struct SeriesRace *race = weight->race;
    const Pair beside = series_race_known(weight, k);
    const Number rolled = race->rolled[k] + race->stretch[0] * weight->free;
    Number sum = along(race->drawn[0], pair_sum(known, beside)) - pair_crossed(pair_product(offset, spin[0]), beside) +
                 race->slowing * product(race->stretch, race->run, 0, k) +
                 (race->kappa - 1.0) * ((race->stretch[0] + race->body) * rolled + product(race->stretch, race->rolled, 1, k));
    int j;
    for (j = 1; j <= k; j++) {
        const Pair second = pair_scaled(race->moved[k - j + 1], number_of(k - j + 1));
        sum += along(race->drawn[j], race->felt[k - j]) - pair_crossed(pair_product(offset, spin[j]), second);
    }
    return race->mass * sum;
}

Number series_race_inertia(const SeriesWeight *weight, Pair centre)
{
    const struct SeriesRace *race = weight->race;
    const Pair swept = pair_difference(pair_turned(centre), race->drawn[0]);
    const Number turned = race->stretch[0] + race->body;
    return race->mass * (along(swept, swept) - along(centre, centre) + (race->kappa - 1.0) * turned * turned);
}

Pair series_race_swept(const SeriesWeight *weight)
{
    return pair_scaled(weight->race->drawn[0], -weight->race->mass);
}

Pair series_race_push(const SeriesWeight *weight, int k)
{
    const struct SeriesRace *race = weight->race;
    return pair_scaled(race->moved[k + 1], number_of(k + 1) * -race->mass);
}

Number series_race_turning(const SeriesWeight *weight, int k, const Pair *spin, Pair offset)
{
    const struct SeriesRace *race = weight->race;
    Number sum = (race->kappa - 1.0) * race->body * race->rolled[k];
    int j;
    for (j = 0; j <= k; j++) {
        const Pair place = pair_sum(pair_product(offset, spin[j]), race->place[j]);
        sum -= pair_crossed(place, race->felt[k - j]);
    }
    return race->mass * sum;
}

Number series_race_blow(const SeriesWeight *weight, Number jump, Pair place, Pair blow)
{
    const struct SeriesRace *race = weight->race;
    return pair_crossed(place, blow) + race->mass * (race->kappa - 1.0) * race->body * race->stretch[0] * jump;
}
