#include "rotor/motor.h"

#include "base/elementary.h"
#include "base/roots.h"

#define MOST_CROSSINGS 1000 /* of points of the characteristic, in a step */
#define LOOKS 8 /* in a step, for a speed that leaves its line and comes back */
#define BRACKET 1e-15       /* of a step: where a point is crossed */

/* One line of the characteristic from the present time on. */
typedef struct {
    Motor *motor;
    int piece, beyond;
    double speed, bound;
    double torque[4];
} Line;

static double speed_at(const Motor *motor, int point)
{
    return motor->points[2 * point];
}

static double torque_at(const Motor *motor, int point)
{
    return motor->points[2 * point + 1];
}

int motor_check(const Motor *motor, Failure *failure)
{
    int k;
    for (k = 1; k < motor->count; k++) {
        if (!(speed_at(motor, k) > speed_at(motor, k - 1))) {
            return fail(failure, "point[%u].speed = %v rad/s: speeds must ascend",
                        (unsigned long)k + 1, speed_at(motor, k));
        }
    }
    return FINE;
}

int motor_line(const Motor *motor, double speed)
{
    int piece = 0;
    while (piece < motor->count - 2 && speed >= speed_at(motor, piece + 1)) {
        piece++;
    }
    return piece;
}

static double slope_of(const Motor *motor, int piece)
{
    return (torque_at(motor, piece + 1) - torque_at(motor, piece)) /
           (speed_at(motor, piece + 1) - speed_at(motor, piece));
}

double motor_torque(const Motor *motor, double speed)
{
    const int piece = motor_line(motor, speed);
    return torque_at(motor, piece) + slope_of(motor, piece) * (speed - speed_at(motor, piece));
}

double motor_slope(const Motor *motor, double speed)
{
    return slope_of(motor, motor_line(motor, speed));
}

void motor_acceleration(const Motor *motor, double speed, const double *torque, double *rates)
{
    rates[0] = (motor_torque(motor, speed) + torque[0]) / motor->inertia;
    rates[1] = (motor_slope(motor, speed) * rates[0] + torque[1]) / motor->inertia;
}

/* Speed and angle turned after `time`, all of it on one line: exact. */
static void on_line(const Line *line, double time, double *speed, double *angle)
{
    Motor *motor = line->motor;
    const double rate = slope_of(motor, line->piece) / motor->inertia;
    const double *s = quadrature(&motor->quadrature, -rate, time), *t = s + 5;
    const double g0 = (torque_at(motor, line->piece) + line->torque[0]) / motor->inertia -
                      rate * speed_at(motor, line->piece);
    const double g1 = line->torque[1] / motor->inertia, g2 = line->torque[2] / motor->inertia;
    const double g3 = line->torque[3] / motor->inertia, start = line->speed;
    *speed = s[0] * start + s[1] * g0 + s[2] * g1 + s[3] * g2 + s[4] * g3;
    *angle = t[0] * start + t[1] * g0 + t[2] * g1 + t[3] * g2 + t[4] * g3;
}

static double short_of(void *context, double time)
{
    const Line *line = context;
    double speed, angle;
    on_line(line, time, &speed, &angle);
    return line->beyond * (line->bound - speed);
}

int motor_advance(Motor *motor, double *speed, double *angle, const double *torque, double step,
                  Failure *failure)
{
    const double sum = *speed + torque[0] + torque[1] + torque[2] + torque[3];
    double begin = 0.0;
    const int looks = motor->count > 2 ? LOOKS : 1;
    Line line;
    int k;
    if (!is_finite(sum)) {
        return fail(failure, "the motor's speed %v rad/s or the torque is not finite", *speed);
    }
    line.motor = motor;
    line.piece = motor_line(motor, *speed);
    line.speed = *speed;
    *angle = 0.0;
    for (k = 0; k < MOST_CROSSINGS; k++) {
        const double left = step - begin;
        double end = 0.0, turned = 0.0, until = left, part;
        int look;
        line.torque[0] = torque[0] + begin * (torque[1] + begin * (torque[2] / 2.0 +
                                                                   begin * torque[3] / 6.0));
        line.torque[1] = torque[1] + begin * (torque[2] + begin * torque[3] / 2.0);
        line.torque[2] = torque[2] + begin * torque[3];
        line.torque[3] = torque[3];
        line.beyond = 0;
        for (look = 1; look <= looks && !line.beyond; look++) {
            until = left * look / looks;
            on_line(&line, until, &end, &turned);
            line.beyond =
                line.piece < motor->count - 2 && end > speed_at(motor, line.piece + 1) ? 1
                : line.piece > 0 && end < speed_at(motor, line.piece)                  ? -1
                                                                                      : 0;
        }
        if (!line.beyond) {
            *speed = end;
            *angle += turned;
            return FINE;
        }
        line.bound = speed_at(motor, line.piece + (line.beyond > 0));
        part = find_crossing(short_of, &line, larger(0.0, line.beyond * (line.bound - line.speed)),
                             until, BRACKET * until);
        on_line(&line, part, &end, &turned);
        *angle += turned;
        begin += part;
        line.speed = line.bound;
        line.piece += line.beyond;
    }
    return fail(failure, "the motor's speed crosses %6 rad/s again and again within a step of %6 s",
                line.bound, step);
}
