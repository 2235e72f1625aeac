"""Stretches of a run: plateaus, on which the speed stays, and passages between them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ....models.arrays import Array
from ...scene import Scene

SHORTEST = 10.0  # revolutions at one speed of a profile that are judged
SLOW = 0.005  # of the speed: what it may change by in as many revolutions at the end of a run
STEADY_SPEED = 0.01  # of the speed of a motor: what its mean may change by between two windows
_NEAR_SPEED = 0.03  # of it: how far the speed may swing on a plateau
_WINDOW = 10.0  # revolutions over which a motor's mean speed is taken


@dataclass(frozen=True)
class Stretch:
    """A part of a run at one speed, or from one speed to another.

    Attributes:
        begin, end: [s].
        start, speed: of the rotor at both ends [rad/s].
    """

    begin: float
    end: float
    start: float
    speed: float

    @property
    def steady(self) -> bool:
        """Whether the speed stays."""
        return self.start == self.speed

    @property
    def revolutions(self) -> float:
        """Turned in it."""
        return (self.end - self.begin) * (self.start + self.speed) / (2.0 * math.tau)


def prescribed(scene: Scene, end: float) -> list[Stretch]:
    """Stretches of a speed profile up to the end of the run [s]; neighbours of one speed joined."""
    profile = scene.profile()
    times = [t for t in profile.times if t < end] + [end]
    times = times if times[0] == 0.0 else [0.0, *times]
    found: list[Stretch] = []
    for begin, stop in pairwise(times):
        if stop - begin <= 1e-12 * end:
            continue
        low, high = profile.speed(begin), profile.speed(stop)
        if profile.acceleration(begin) == 0.0:
            high = low
        if found and found[-1].steady and low == high == found[-1].speed:
            found[-1] = Stretch(found[-1].begin, stop, low, high)
        else:
            found.append(Stretch(begin, stop, low, high))
    return [*found[:-1], *_kept_at_end(found[-1])] if found else []


def _kept_at_end(last: Stretch) -> list[Stretch]:
    """The last stretch, its end as a plateau where the speed changes so slowly that it is one."""
    rate = abs(last.speed - last.start) / (last.end - last.begin)
    if last.steady or rate * SHORTEST * math.tau > SLOW * last.speed**2:
        return [last]
    begin = max(last.begin, last.end - 2.0 * SLOW * last.speed / rate)
    share = (begin - last.begin) / (last.end - last.begin)
    there = last.start + share * (last.speed - last.start)
    plateau = Stretch(begin, last.end, last.speed, last.speed)
    return [Stretch(last.begin, begin, last.start, there), plateau] if share > 0.0 else [plateau]


def motor_angle(time: Array, speed: Array) -> Array:
    """Angle turned since the start (T,) [rad] by a recorded speed (T,) [rad/s]."""
    if len(time) < 2:
        return time
    from scipy.interpolate import CubicSpline  # of motors alone

    return np.asarray(CubicSpline(time, speed).antiderivative()(time))


def driven(time: Array, speed: Array) -> list[Stretch]:
    """Stretches of a motor's run: at its end a plateau where the speed keeps its mean."""
    angle = motor_angle(time, speed)
    turned = (angle - angle[0]) / math.tau
    window = min(_WINDOW, turned[-1] / 3.0)
    means = []
    for first in (2.0, 1.0):
        low, high = turned[-1] - first * window, turned[-1] - (first - 1.0) * window
        begin, stop = np.interp([low, high], turned, time)
        means.append(math.tau * window / (stop - begin) if stop > begin else float(speed[-1]))
    before, mean = means
    if window <= 0.0 or abs(mean - before) > STEADY_SPEED * abs(mean):
        return [Stretch(float(time[0]), float(time[-1]), float(speed[0]), float(speed[-1]))]
    last = turned >= turned[-1] - window
    swing = max(_NEAR_SPEED * abs(mean), 1.5 * float(np.abs(speed[last] - mean).max()))
    away = np.flatnonzero(np.abs(speed - mean) > swing)
    begin = float(time[away[-1] + 1]) if len(away) and away[-1] + 1 < len(time) else float(time[0])
    rise = [Stretch(float(time[0]), begin, float(speed[0]), mean)] if begin > time[0] else []
    return [*rise, Stretch(begin, float(time[-1]), mean, mean)]
