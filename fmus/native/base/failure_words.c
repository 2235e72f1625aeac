#include "base/failure_words.h"

#include "base/elementary.h"

/* In braces: w where, l all values; 0 to 3 a value as Python's repr writes it, or
   rounded to the digits behind the point. */
static const char *const WORDS[FAILURE_CROSSINGS + 1] = {
    [FAILURE_FLOAT_RADIUS] = "float_radius = {0} m: must be smaller than chamber_radius = {1} m",
    [FAILURE_POLAR_INERTIA] = "polar_inertia = {0} kg m^2: must be 0 to 2 inertia = {1.6}",
    [FAILURE_STATIONS] = "stations = {l}: must be at least two, each beyond the last [m]",
    [FAILURE_SUPPORTS] = "supports = [{0.12}, {1.12}]: must be two different stations, 1 to {w}",
    [FAILURE_UNBALANCE_PLACE] = "unbalances: position = {0} m: must be a disc's, one of {l}, or "
                                "between them on a uniform shaft",
    [FAILURE_COMPLIANCE] = "compliance: must be finite and symmetric (Maxwell's reciprocity)",
    [FAILURE_CANNOT_BEND] =
        "internal_damping: a shaft with discs at its supports only cannot bend",
    [FAILURE_NOT_CARRIED] =
        "gravity: supports without stiffness cannot carry the rotor's weight",
    [FAILURE_WEIGHT_RADIUS] = "weight_radius = {0} m: {w} weights do not fit on a track of radius "
                              "{1} m, the largest that fit have {2.6} m",
    [FAILURE_RESTITUTION] = "restitution = {0}: must be within 0 to 1",
    [FAILURE_MOBILITY] = "track_mobility = {0} 1/kg: must be 0 or more and less than {1.6} 1/kg, "
                         "one over the mass of all weights",
    [FAILURE_NO_ROOM] = "weight_radius: {w} weights of unequal radii need {0.6} rad of a track of radius "
                        "{1} m, must be less than a turn",
    [FAILURE_RIGID_SLIDERS] = "sliders: two rigid ones at one support and axis are one with the "
                              "sum of their limits; give that, or a stiffness",
    [FAILURE_SPIN] = "der(acceleration) = {0} rad/s3: must be 0 for weights that touch or stick, "
                     "as all its derivatives",
    [FAILURE_CHARACTERISTIC] = "point[{w}].speed = {0} rad/s: speeds must ascend",
    [FAILURE_OVERLAP] = "weights overlap by {0.3} rad: neighbours need {1.6} rad",
    [FAILURE_MATRICES] = "the rotor's matrices are not finite",
    [FAILURE_SINGULAR] = "Singular matrix",
    [FAILURE_STRETCHES] = "the rotor vibrates too fast, or its sliders change too often, for a step "
                          "of {0.6} s: {1.6} s reached in {w} stretches; use smaller communication "
                          "steps",
    [FAILURE_ANGLES] = "the weights' angles {l} are not finite",
    [FAILURE_SUBSTEPS] = "the weights would need {0.3} substeps in {1.6} s: acceleration {2.6} "
                         "m/s^2, rate {3.6} rad/s",
    [FAILURE_NOT_CONVERGED] = "the weights' step of {0.6} s did not converge (angle {1.6} rad, "
                              "rate {2.6} rad/s, acceleration {3.6} m/s^2): use smaller "
                              "communication steps",
    [FAILURE_SLIDE] = "the sliding weights' step of {0.6} s did not converge (angle {1.6} rad, "
                      "rate {2.6} rad/s, acceleration {3.6} m/s^2): use smaller steps",
    [FAILURE_IMPACT] = "no solution was found for an impact of {w} pairs of weights, which close at "
                       "{0.6} rad/s",
    [FAILURE_EVENTS] = "more than {w} substeps and events of the weights in {0.6} s, {1.6} s "
                       "reached: use smaller communication steps",
    [FAILURE_MOTOR] = "the motor's speed {0} rad/s or the torque is not finite",
    [FAILURE_CROSSINGS] = "the motor's speed crosses {1.6} rad/s again and again within a step of "
                          "{0.6} s",
};

static void put_compliance(Text *text, const double *values, size_t count)
{
    size_t n = 0, k;
    while (n * n < count) {
        n++;
    }
    text_put(text, "compliance = [");
    for (k = 0; k < n; k++) {
        text_put(text, k ? ", " : "");
        text_list(text, values + k * n, n);
    }
    text_put(text, "] m/N: must be positive definite: every load bends the shaft its own way (are "
                   "two stations almost at one place?)");
}

/* `format`: what stands behind the value's number. */
static void put_value(Text *text, double value, const char *format)
{
    int digits = 0;
    if (*format == '.') {
        while (*++format != '}') {
            digits = 10 * digits + (*format - '0');
        }
        text_rounded(text, value, digits);
    } else {
        text_number(text, value);
    }
}

void failure_words(Text *text, const Failure *failure, const double *values, size_t count)
{
    const char *words;
    if (failure->code == FAILURE_NOT_ELASTIC) {
        put_compliance(text, values, count);
        return;
    }
    words = WORDS[failure->code] ? WORDS[failure->code] : "unknown failure";
    for (; *words; words++) {
        size_t plain = 0;
        while (words[plain] && words[plain] != '{') {
            plain++;
        }
        text_put_part(text, words, plain);
        words += plain;
        if (!*words) {
            return;
        }
        switch (*++words) {
        case 'w':
            text_integer(text, (unsigned long)failure->where);
            break;
        case 'l':
            text_list(text, values, count);
            break;
        default:
            put_value(text, failure->value[*words - '0'], words + 1);
        }
        while (*words != '}') {
            words++;
        }
    }
}
