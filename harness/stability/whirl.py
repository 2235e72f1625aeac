"""The vibration that remains where weights do not balance fully, as runs of the scene leave it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import UserError
from ..master.names import station_residuals, weight
from ..output.words import kinds_of
from ..result.many import cosimulate_many
from ..scene import Scene
from ..scene.replace import SPEED

SPEEDS = 7  # evenly over the range, its ends included
FIRST, MOST = 150, 1200  # revolutions of a run; doubled until all runs have settled
CANNOT, IN_PART = "The weights cannot balance", "The weights do not balance fully"
UNKNOWN = "It is not known where the weights come to rest"
STAYS = 1e-3  # of the largest amplitude: what a settled one may change by in half of a run


@dataclass(frozen=True)
class WhirlAt:
    """What a run leaves at one speed.

    Attributes:
        speed: [rad/s].
        stable: whether the run settled: a run of half its length leaves the same amplitudes.
        amplitude: largest distance of each station from its middle in the last revolution [m]; NaN
            where the run failed.
        angles: mean angles of the weights in the rotor over that revolution [rad].
        failure: why the run failed; else empty.
    """

    speed: float
    stable: bool
    amplitude: tuple[float, ...]
    angles: tuple[float, ...]
    failure: str = ""

    def as_json(self) -> dict[str, Any]:
        """Plain lists and numbers; null where the run failed."""
        found = None if self.failure else list(self.amplitude)
        angles = None if self.failure else list(self.angles)
        return {"speed": self.speed, "stable": self.stable, "amplitude": found, "angles": angles}


@dataclass(frozen=True)
class Whirls:
    """What remains of the vibration over a range of speeds.

    Attributes:
        why: the weights do not balance fully.
        at: what runs leave at speeds of the range, ascending.
        refused: why the scene cannot be run in C; else empty.
        finding: what `why` is the reason of: `CANNOT`, `IN_PART` or `UNKNOWN`.
    """

    why: str
    at: tuple[WhirlAt, ...]
    refused: str = ""
    finding: str = CANNOT

    def as_json(self) -> dict[str, Any]:
        """Plain lists and numbers."""
        at = [one.as_json() for one in self.at]
        return {"finding": self.finding, "why": self.why, "at": at}

    def lines(self) -> Iterator[str]:
        """The same in words."""
        yield f"{self.finding}: {self.why}."
        if self.refused:
            yield f"The vibration that remains is not known: {self.refused}"
        settled = [one for one in self.at if one.stable]
        if self.at:
            yield f"{len(settled)} of {len(self.at)} runs settled within {MOST} revolutions."
        if settled:
            ends = (pick(settled, key=lambda one: max(one.amplitude)) for pick in (min, max))
            sizes = [
                f"{1e3 * max(one.amplitude):.4g} mm (at {one.speed:.4g} rad/s)" for one in ends
            ]
            yield f"They leave a vibration of {sizes[0]} to {sizes[1]}."
        for count, reason in kinds_of([one.failure for one in self.at if one.failure])[:3]:
            yield f"{count} failed, such as: {reason}"


def whirls(scene: Scene, span: tuple[float, float], why: str, finding: str = CANNOT) -> Whirls:
    """Run a scene from its start at speeds of a range [rad/s], until the vibration stays.

    Args:
        why, finding: as of `Whirls`.
    """
    speeds, revolutions = np.linspace(*span, SPEEDS), FIRST
    try:
        now = _run(scene, speeds, revolutions)
        stays = np.zeros(SPEEDS, bool)
        while not stays.all() and revolutions < MOST:
            revolutions, before = 2 * revolutions, now
            now = _run(scene, speeds, revolutions)
            change = np.abs(now.amplitude - before.amplitude)
            stays = (change <= STAYS * now.amplitude.max(axis=1, keepdims=True)).all(axis=1)
    except UserError as error:
        return Whirls(why, (), str(error), finding)
    rows = zip(speeds.tolist(), stays.tolist(), now.amplitude, now.angles, now.failure, strict=True)
    return Whirls(
        why,
        tuple(
            WhirlAt(speed, still, tuple(amplitude.tolist()), tuple(angles.tolist()), failure)
            for speed, still, amplitude, angles, failure in rows
        ),
        finding=finding,
    )


class _Runs(NamedTuple):
    """Amplitudes (s, stations) [m], mean angles (s, weights) [rad], and why runs failed (s,)."""

    amplitude: NDArray[np.float64]
    angles: NDArray[np.float64]
    failure: list[str]


def _run(scene: Scene, speeds: NDArray[np.float64], revolutions: int) -> _Runs:
    scene = scene.replace({SPEED: float(speeds[0]), "run.revolutions": revolutions})
    amplitudes = station_residuals(len(scene.rotor.points))
    angles = [
        f"{mounted.name}.{weight(k, 'mean_angle')}"
        for mounted in scene.assembly().weights
        for k in range(1, len(mounted.angles) + 1)
    ]
    outcomes = cosimulate_many(scene, {"speed": speeds}, results=[*amplitudes, *angles])
    turned = np.array([outcomes[name] for name in angles]).reshape(len(angles), len(speeds)).T
    return _Runs(
        np.array([outcomes[name] for name in amplitudes]).T,
        np.angle(np.exp(1j * turned)),
        outcomes["failure"].tolist(),
    )
