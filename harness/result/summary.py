"""What a run comes to, in words: balanced or not and why, vibration, capacity, unbalance left."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...models.arrays import Array
from ...models.harmonic_balance import NoResponse, unbalance_response
from ..master.merged import SHORT
from ..master.names import stations, weight
from ..scene import Scene
from ..scene.balancer import WeightBalancer
from ..scene.grade import GRADES, moments, residual_unbalance
from ..units import brief, in_both, readable_unbalance
from .velocity import VELOCITY, revolutions_at

if TYPE_CHECKING:
    from .result import Result

BALANCED = 0.05  # of the vibration without balancers: a rotor that vibrates less is balanced
STUCK = 1e-6  # rad that weights which stick may have turned by in the last revolution
TRANSIENT_TIME_CONSTANTS = 10.0  # time constants after which nothing is left of how a run began


@dataclass(frozen=True)
class Summary:
    """What a run comes to; as text a few sentences.

    Attributes:
        balancers: what they are called: balls, rollers, pendulums, weights, liquid or balancers;
            empty where there are none.
        vibration: largest distance of a station from the middle in the last revolution [m].
        velocity: vibration velocity of the last revolution [m/s rms], the larger of x and y.
        alone: vibration of the rotor without balancers at this speed [m].
        after: time from which on the vibration is less than `BALANCED` of it [s].
        reason: why it is not; why that is not known.
        used: by balancer, share of the capacity that its weights use, and the capacity [kg m].
        left: unbalance that is left at a support [kg m], and the grade that permits it [mm/s].
    """

    balancers: str
    vibration: float | None = None
    velocity: float | None = None
    alone: float | None = None
    after: float | None = None
    reason: str = ""
    used: tuple[tuple[str, float, float], ...] = ()
    left: tuple[float, float] | None = None

    @property
    def balanced(self) -> bool | None:
        """Whether balancers balance the rotor; None where it is not known, there are none, or a
        liquid alone lowers the vibration."""
        if self.after is not None:
            return True
        return False if self.balancers and self.alone and self.reason else None

    def __str__(self) -> str:
        return " ".join(self._sentences())

    def _sentences(self) -> Iterator[str]:
        if self.vibration is None:
            yield f"Not judged: {self.reason}."
            return
        said = f"ibration {brief(1e3 * self.vibration)} mm"
        said += "" if self.velocity is None else f" ({brief(1e3 * self.velocity)} mm/s rms)"
        if self.balancers and self.alone:
            share = brief(100.0 * self.vibration / self.alone)
            said += f", {share} % of {1e3 * self.alone:.3g} mm without {self.balancers}"
        if self.balanced:
            yield f"Balanced after {brief(self.after or 0.0, 3)} s: v{said}."
        elif self.balanced is False:
            yield f"Not balanced: {self.reason}. V{said}."
        else:
            yield f"V{said}{f'; not judged: {self.reason}' if self.reason else ''}."
        if len(self.used) == 1:
            used, most = self.used[0][1:]
            yield (
                f"{self.balancers.capitalize()} use {100.0 * used:.0f} % of their capacity "
                f"({readable_unbalance(most)})."
            )
        elif self.used:
            parts = (
                f"{name} {100.0 * u:.0f} % of {readable_unbalance(c)}" for name, u, c in self.used
            )
            yield f"Capacity in use: {', '.join(parts)}."
        if self.left is not None:
            word = "left" if self.balancers else "of the rotor"
            yield f"Unbalance {word} {readable_unbalance(self.left[0])}: {_grade(self.left[1])}."


def summarise(result: Result, scene: Scene) -> Summary:
    """The summary of a scene's run."""
    kinds = {balancer.kind for balancer in scene.balancer}
    several = "weights" if "liquid" not in kinds else "balancers"
    called = kinds.pop() if len(kinds) == 1 else several if kinds else ""
    prefixes = [f"rotor.{prefix}" for prefix in stations(len(scene.rotor.stations))]
    missing = [f"{p}{axis}" for p in prefixes for axis in "xy" if f"{p}{axis}" not in result]
    if missing:
        return Summary(called, reason=f"{', '.join(missing)} not recorded")
    turned = revolutions_at(scene, result.time)
    last = turned >= turned[-1] - 1.0
    size = _distance(result, prefixes, last, bool(scene.operation.gravity))
    named = [f"{p}{VELOCITY}" for p in prefixes]
    speed = _speed_at_end(result, scene)
    alone, reason = None, ""
    try:
        alone = vibration_alone(scene, speed, float(result.time[-1]))
        still = "the rotor stands still at the end" if not speed else "the rotor has no unbalance"
        reason = "" if alone or not called else still
    except NoResponse as error:
        reason = str(error)
    vibration, after = float(size[last].max()), None
    if alone and called and (scene.assembly().weights or vibration > alone):
        beyond = np.flatnonzero(size > BALANCED * alone)
        first = int(beyond[-1]) + 1 if len(beyond) else 0
        after = float(result.time[first]) if vibration <= BALANCED * alone else None
        reason = "" if after is not None else _reason(result, scene, speed, last, vibration / alone)
    held = _weight_moments(result, scene)
    return Summary(
        called,
        vibration,
        max(float(result[name][-1]) for name in named) if named[0] in result else None,
        alone,
        after,
        reason,
        _used(scene, held) if held else (),
        residual_unbalance(scene, held, float(result.time[-1])) if held is not None else None,
    )


def _distance(result: Result, prefixes: list[str], last: Array, about_mean: bool) -> Array:
    """Largest distance of a station from the middle at every time (T,) [m]; a sag is none."""
    motion = np.array([result[f"{p}x"] + 1j * result[f"{p}y"] for p in prefixes])
    if about_mean:
        motion -= motion[:, last].mean(axis=1, keepdims=True)
    return np.abs(motion).max(axis=0)


def _speed_at_end(result: Result, scene: Scene) -> float:
    if scene.operation.motor and "motor.speed" in result:
        return abs(float(result["motor.speed"][-1]))
    return scene.profile().speed(float(result.time[-1]))


def vibration_alone(scene: Scene, speed: float, end: float) -> float:
    """Largest distance of a station of the rotor without balancers from the middle [m]."""
    x, y = unbalance_response(scene.assembly().at(end).rotor, [speed])[0]
    squares = 0.5 * (np.abs(x) ** 2 + np.abs(y) ** 2 + np.abs(x**2 + y**2))  # longer half axis
    return math.sqrt(float(squares.max()))


def _weight_moments(result: Result, scene: Scene) -> dict[str, float] | None:
    """What the weights hold at the end, by its signals [kg m]; None where it is not known."""
    names = moments(scene)
    if names is None or any(name not in result for name in names):
        return None
    return {name: float(result[name][-1]) for name in names}


def _used(scene: Scene, held: dict[str, float]) -> tuple[tuple[str, float, float], ...]:
    used = []
    for one in scene.balancer:
        assert isinstance(one, WeightBalancer)
        moment = math.hypot(*(held[f"{one.label}.moment_{axis}"] for axis in ("xi", "eta")))
        used.append((one.label, moment / one.capacity, one.capacity))
    return tuple(used)


def _reason(result: Result, scene: Scene, speed: float, last: Array, share: float) -> str:
    """Why the rotor is not balanced at the end of a run."""
    from ...models.linear.balanced import CannotBalance
    from ...models.stability import growth_rates  # loads SciPy

    profile, end = scene.profile(), float(result.time[-1])
    assembly = scene.assembly().at(end)
    critical = float(np.abs(assembly.loaded_rotor.free_rates(0.0)).min())
    if speed < critical:
        return f"below the critical speed, {in_both(critical, 'rad/s')}"
    if profile.acceleration(end):
        way = "rises" if profile.acceleration(end) > 0.0 else "falls"
        return f"the speed still {way} at the end of the run"
    if stuck := _stuck(result, scene, last):
        return f"{stuck} stuck: rolling resistance holds them"
    if scene.operation.gravity and assembly.weights:
        return "gravity swings the weights in every revolution"
    if any(SHORT in event for event in result.events):
        return "identical weights share one angle, and this run cannot part them"
    try:
        growth = float(growth_rates(assembly, speed)[0])
    except CannotBalance as error:
        if error.needed <= error.capacity:
            return str(error)
        return (
            f"capacity exceeded: {readable_unbalance(error.needed)} to balance, the weights hold "
            f"at most {readable_unbalance(error.capacity)}"
        )
    except (ValueError, ArithmeticError) as error:
        return str(error)
    if growth >= 0.0:
        return f"unstable at this speed, {in_both(speed, 'rad/s')}: see `autobalancer speeds`"
    if end > -TRANSIENT_TIME_CONSTANTS / growth:
        return "another steady motion than the balanced one: see `autobalancer speeds`"
    longer = end + math.log(share / BALANCED) / -growth
    return (
        f"not settled yet, time constant {brief(-1.0 / growth)} s: set run.revolutions = "
        f"{math.ceil(1.2 * scene.run.revolutions * longer / end)}"
    )


def _stuck(result: Result, scene: Scene, last: Array) -> str:
    """Names of the weights that stick, where their angles were recorded."""
    names = []
    for one in scene.balancer:
        if isinstance(one, WeightBalancer) and one.can_stick:
            angles = [f"{one.label}.{weight(k, 'angle')}" for k in range(1, one.count + 1)]
            if all(a in result and np.ptp(result[a][last]) <= STUCK for a in angles):
                names.append(one.label)
    return ", ".join(names)


def _grade(value: float) -> str:
    """The smallest grade of ISO 21940-11 that permits it."""
    name = next((f"G{grade:g}" for grade in GRADES if value <= grade), "")
    return name or f"above G{GRADES[-1]:g}"
