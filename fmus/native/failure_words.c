#include "failure_words.h"

#include "elementary.h"

static void put_refused(Text *text, const Failure *failure, const char *must)
{
    text_put(text, failure->name);
    text_put(text, " = ");
    text_number(text, failure->value[0]);
    text_put(text, must);
}

static void put_rounded(Text *text, const char *before, double value, int digits,
                        const char *after)
{
    text_put(text, before);
    text_rounded(text, value, digits);
    text_put(text, after);
}

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

void failure_words(Text *text, const Failure *failure, const double *values, size_t count)
{
    const double *value = failure->value;
    switch (failure->code) {
    case FAILURE_NOT_POSITIVE:
        put_refused(text, failure, ": must be a positive finite number");
        break;
    case FAILURE_NEGATIVE:
        put_refused(text, failure, ": must be a finite number, 0 or more");
        break;
    case FAILURE_NOT_FINITE:
        put_refused(text, failure, ": must be a finite number");
        break;
    case FAILURE_COUNT:
        put_refused(text, failure, ": must be at least 1");
        break;
    case FAILURE_KAPPA:
        put_refused(text, failure, ": must be a finite number, 1 or more");
        break;
    case FAILURE_FLOAT_RADIUS:
        text_put(text, "float_radius = ");
        text_number(text, value[0]);
        text_put(text, " m: must be smaller than chamber_radius = ");
        text_number(text, value[1]);
        text_put(text, " m");
        break;
    case FAILURE_POLAR_INERTIA:
        text_put(text, "polar_inertia = ");
        text_number(text, value[0]);
        put_rounded(text, " kg m^2: must be 0 to 2 inertia = ", value[1], 6, "");
        break;
    case FAILURE_STATIONS:
        text_put(text, "stations = ");
        text_list(text, values, count);
        text_put(text, ": must be at least two, each beyond the last [m]");
        break;
    case FAILURE_STATION_MASS:
        text_put(text, "masses = ");
        text_number(text, value[0]);
        text_put(text, " at station ");
        text_integer(text, (unsigned long)failure->where);
        text_put(text, ": must be a positive finite number [kg]");
        break;
    case FAILURE_SUPPORTS:
        text_put(text, "supports = [");
        text_rounded(text, value[0], 17);
        text_put(text, ", ");
        text_rounded(text, value[1], 17);
        text_put(text, "]: must be two different stations, 1 to ");
        text_integer(text, (unsigned long)failure->where);
        break;
    case FAILURE_UNBALANCE_PLACE:
        text_put(text, "unbalances: position = ");
        text_number(text, value[0]);
        text_put(text, " m: must be a disc's, one of ");
        text_list(text, values, count);
        text_put(text, ", or between them on a uniform shaft");
        break;
    case FAILURE_COMPLIANCE:
        text_put(text, "compliance: must be finite and symmetric (Maxwell's reciprocity)");
        break;
    case FAILURE_NOT_ELASTIC:
        put_compliance(text, values, count);
        break;
    case FAILURE_CANNOT_BEND:
        text_put(text, "internal_damping: a shaft with discs at its supports only cannot bend");
        break;
    case FAILURE_SPIN:
        text_put(text, "der(acceleration) = ");
        text_number(text, value[0]);
        text_put(text, " rad/s3: must be 0 for weights that touch or stick, as all its derivatives");
        break;
    case FAILURE_QUINTIC_SPIN:
        text_put(text, "acceleration: must be 0, as its derivatives, with signals of order = 5");
        break;
    case FAILURE_QUINTIC_WEIGHTS:
        text_put(text, "order = 5: only point weights on a centred track have such signals; "
                       "weight_radius, rolling_resistance and track_offset must be 0");
        break;
    case FAILURE_CHARACTERISTIC:
        text_put(text, "point[");
        text_integer(text, (unsigned long)failure->where);
        text_put(text, "].speed = ");
        text_number(text, value[0]);
        text_put(text, " rad/s: speeds must ascend");
        break;
    case FAILURE_MOTOR:
        text_put(text, "the motor's speed ");
        text_number(text, value[0]);
        text_put(text, " rad/s or the torque is not finite");
        break;
    case FAILURE_CROSSINGS:
        text_put(text, "the motor's speed crosses ");
        text_rounded(text, value[1], 6);
        text_put(text, " rad/s again and again within a step of ");
        text_rounded(text, value[0], 6);
        text_put(text, " s");
        break;
    case FAILURE_NOT_CARRIED:
        text_put(text, "gravity: supports without stiffness cannot carry the rotor's weight");
        break;
    case FAILURE_ADDED_MASS:
        text_put(text, "added_mass = ");
        text_number(text, value[0]);
        text_put(text, " kg: must be a finite number, at least 0 kg");
        break;
    case FAILURE_WEIGHT_RADIUS:
        text_put(text, "weight_radius = ");
        text_number(text, value[0]);
        text_put(text, " m: ");
        text_integer(text, (unsigned long)failure->where);
        text_put(text, " weights do not fit on a track of radius ");
        text_number(text, value[1]);
        put_rounded(text, " m, the largest that fit have ", value[2], 6, " m");
        break;
    case FAILURE_RESTITUTION:
        text_put(text, "restitution = ");
        text_number(text, value[0]);
        text_put(text, ": must be within 0 to 1");
        break;
    case FAILURE_RIGID_SLIDERS:
        text_put(text, "sliders: two rigid ones at one support and axis are one with the sum of "
                       "their limits; give that, or a stiffness");
        break;
    case FAILURE_STRETCHES:
        text_put(text, "more than ");
        text_integer(text, (unsigned long)failure->where);
        put_rounded(text, " stretches and events of the sliders in ", value[0], 6, " s, ");
        put_rounded(text, "", value[1], 6, " s reached: use smaller communication steps");
        break;
    case FAILURE_OVERLAP:
        put_rounded(text, "weights overlap by ", value[0], 3, " rad: neighbours need ");
        put_rounded(text, "", value[1], 6, " rad");
        break;
    case FAILURE_MATRICES:
        text_put(text, "the rotor's matrices are not finite");
        break;
    case FAILURE_SINGULAR:
        text_put(text, "Singular matrix");
        break;
    case FAILURE_FAST_VIBRATION:
        put_rounded(text, "the rotor vibrates too fast for a step of ", value[0], 6,
                    " s at changing speed: ");
        text_integer(text, (unsigned long)failure->where);
        put_rounded(text, " parts of it still err by ", value[1], 6,
                    " m; use smaller communication steps");
        break;
    case FAILURE_ANGLES:
        text_put(text, "the weights' angles ");
        text_list(text, values, count);
        text_put(text, " are not finite");
        break;
    case FAILURE_SUBSTEPS:
        put_rounded(text, "the weights would need ", value[0], 3, " substeps in ");
        put_rounded(text, "", value[1], 6, " s: acceleration ");
        put_rounded(text, "", value[2], 6, " m/s^2, rate ");
        put_rounded(text, "", value[3], 6, " rad/s");
        break;
    case FAILURE_NOT_CONVERGED:
        put_rounded(text, "the weights' step of ", value[0], 6, " s did not converge (angle ");
        put_rounded(text, "", value[1], 6, " rad, rate ");
        put_rounded(text, "", value[2], 6, " rad/s, acceleration ");
        put_rounded(text, "", value[3], 6, " m/s^2): use smaller communication steps");
        break;
    case FAILURE_SLIDE:
        put_rounded(text, "the sliding weights' step of ", value[0], 6,
                    " s did not converge (angle ");
        put_rounded(text, "", value[1], 6, " rad, rate ");
        put_rounded(text, "", value[2], 6, " rad/s, acceleration ");
        put_rounded(text, "", value[3], 6, " m/s^2): use smaller steps");
        break;
    case FAILURE_EVENTS:
        text_put(text, "more than ");
        text_integer(text, (unsigned long)failure->where);
        put_rounded(text, " substeps and events of the weights in ", value[0], 6, " s, ");
        put_rounded(text, "", value[1], 6, " s reached: use smaller communication steps");
        break;
    default:
        text_put(text, "unknown failure");
    }
}
