"""What is free in a fit: values of a scene by their paths, where they start, and their limits."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from numbers import Real
from typing import Any

from ..errors import SMALLEST_SCATTER, SceneError, UserError, texts_of
from ..result.alike import refuse_unvaried
from ..scene import Scene
from ..scene.replace import in_full
from ..units import si_number

SCATTER = 0.1  # of a measured difference, where nobody says
FARTHEST = 1e6  # times the start: as good as no limit
_LIMIT_HALVINGS = 60  # of the way to a value that the scene refuses
_COMMA = re.compile(r",(?![^\[\]]*\])")  # outside of brackets


@dataclass(frozen=True)
class Parameter:
    """One number that is free.

    Attributes:
        paths: of the scene, all given the same value.
        start: the scene's.
        limits: between which the scene takes it while the others keep their start, and no farther
            than was asked for.
        pull: of its prior, on a difference: that of a value twice its start.
    """

    paths: tuple[str, ...]
    start: float
    limits: tuple[float, float]
    pull: float = 0.0

    @property
    def label(self) -> str:
        """The path as the user wrote it."""
        return "=".join(self.paths)

    @property
    def is_angle(self) -> bool:
        """Whether the value is an angle [rad], which has no lower or upper end."""
        return self.paths[0].rpartition(".")[2].partition("[")[0].endswith("angle")

    def changes(self, value: float) -> dict[str, float]:
        """For `Scene.replace`."""
        return dict.fromkeys(self.paths, value)


def parse_free(
    texts: Sequence[str],
    scene: Any,
    limits: Sequence[str] = (),
    priors: Sequence[str] = (),
    scatter: float = SCATTER,
    make: Callable[[tuple[str, ...], Any], Parameter] | None = None,
) -> list[Parameter]:
    """PATH,PATH,...: each a number of the scene; PATH=PATH is one number for both.

    Args:
        scene: or a system of units, which needs a `make` of its own.
        limits: PATH=LOW:HIGH,..., of those that are free; either may be left out.
        priors: PATH=DEVIATION,..., of those that are free: how far off the start may be, as a
            standard deviation. It counts as one more measurement.
        scatter: standard deviation of a measured difference, against which priors are weighed.
        make: the parameter of some paths; default: of a scene.

    Raises:
        UserError: nothing is free, a path is unknown, twice there, no number or 0; a limit or a
            prior is of what is not free, or no number; a limit leaves the start outside.
    """
    _refuse_scatter(scatter)
    asked = texts_of(texts, "free", "'rotor.stiffness[1],balls.drag'")
    groups = [tuple(path.strip() for path in one.split("=")) for one in _separated(asked)]
    paths = [path for group in groups for path in group]
    if not paths:
        raise UserError("--free: nothing is free; give paths such as rotor.stiffness[1],balls.drag")
    if repeated := {path for path in paths if paths.count(path) > 1}:
        raise UserError(f"--free {', '.join(sorted(repeated))}: given twice")
    found = [(make or _parameter)(group, scene) for group in groups]
    for text in _separated(texts_of(limits, "limits", "'balls.drag=0.1:1'")):
        found = _limited(found, text, scene)
    for text in _separated(texts_of(priors, "priors", "'balls.drag=0.1'")):
        found = _with_prior(found, text, scatter, scene)
    return found


def _refuse_scatter(scatter: Any) -> None:
    is_number = isinstance(scatter, Real) and not isinstance(scatter, bool)
    if not is_number or not SMALLEST_SCATTER <= scatter < math.inf:
        raise UserError(f"scatter = {scatter!r}: must be a number, {SMALLEST_SCATTER:g} or more")


def _separated(texts: Sequence[str]) -> list[str]:
    """What commas separate; those of an index, as in `m.k[1,2]`, do not."""
    return [one.strip() for some in texts for one in _COMMA.split(some) if one.strip()]


def _index_of(parameters: list[Parameter], path: str, said: str) -> int:
    for k, one in enumerate(parameters):
        if path in one.paths:
            return k
    raise UserError(f"{said}: {path} is not free; must be of --free")


def _with_prior(
    parameters: list[Parameter], text: str, scatter: float, scene: Any
) -> list[Parameter]:
    path, _, deviation = text.partition("=")
    k = _index_of(parameters, path, f"--prior {text}")
    size = si_number(deviation, scene.unit_of(path), f"--prior {text}: must be PATH=DEVIATION:")
    if not 0.0 < size < math.inf:
        raise UserError(f"--prior {text}: must be PATH=DEVIATION, a number above 0")
    parameters[k] = replace(parameters[k], pull=scatter * abs(parameters[k].start) / size)
    return parameters


def _limited(parameters: list[Parameter], text: str, scene: Any) -> list[Parameter]:
    path, _, ends = text.partition("=")
    k = _index_of(parameters, path, f"--limit {text}")
    one, example = parameters[k], f"--limit {text}: must be PATH=LOW:HIGH, numbers or nothing"
    if ends.count(":") != 1:
        raise UserError(example)
    low, high = (
        si_number(end, scene.unit_of(path), f"{example}:") if end else far
        for end, far in zip(ends.split(":"), (-math.inf, math.inf), strict=True)
    )
    if not low < high:
        raise UserError(f"{example}; LOW must be below HIGH")
    if not low <= one.start <= high:
        raise UserError(f"--limit {text}: starts at {one.start:g}, outside: --set it")
    parameters[k] = replace(one, limits=(max(low, one.limits[0]), min(high, one.limits[1])))
    return parameters


def _parameter(paths: tuple[str, ...], scene: Scene) -> Parameter:
    for path in paths:
        if in_full(path) == "operation.speed":
            raise UserError("--free speed: every row of the measurements has its own: it is known")
        refuse_unvaried(scene, path)
    units = {scene.unit_of(path) for path in paths}
    if len(units) > 1:
        raise UserError(
            f"--free {'='.join(paths)}: one value in {' and '.join(sorted(units))}: must be of one "
            "quantity; free them apart, with a comma"
        )
    start = value_at(scene, paths[0])
    if start == 0.0:
        raise UserError(f"--free {paths[0]}: starts at 0, from where nothing has a size: set it")

    def is_accepted(ratio: float) -> bool:
        try:
            scene.replace(dict.fromkeys(paths, ratio * start))
        except SceneError:
            return False
        return True

    scene.replace(dict.fromkeys(paths, start))  # a path that is wrong says so
    ends = sorted(start * _farthest(is_accepted, end) for end in (-FARTHEST, FARTHEST))
    return Parameter(paths, start, (ends[0], ends[1]))


def _farthest(is_accepted: Callable[[float], bool], end: float) -> float:
    """The value next to `end` that is taken, on the way from 1; infinite where `end` is."""
    if is_accepted(end):
        return math.copysign(math.inf, end)
    inside, outside = 1.0, 0.0 if not is_accepted(0.0) and end < 0.0 else end
    for _ in range(_LIMIT_HALVINGS):
        middle = 0.5 * (inside + outside)
        inside, outside = (middle, outside) if is_accepted(middle) else (inside, middle)
    return inside


def value_at(scene: Scene, path: str) -> float:
    """The number that stands at a path of a scene, such as `rotor.stiffness[2]`.

    Raises:
        UserError: there is none.
    """
    first, *parts = in_full(path, scene.body_names).split(".")
    holders = {"rotor": scene.rotor, "run": scene.run, **{b.label: b for b in scene.balancer}}
    found: Any = holders.get(first)
    try:
        for part in parts:
            found = getattr(found, part.partition("[")[0])
            for number in re.findall(r"\[(\d+)\]", part):
                found = found[int(number) - 1]
    except (AttributeError, IndexError, TypeError):
        scene.replace({path: 1.0})  # refuses an unknown key with those that there are
        raise UserError(f"{path}: the scene has no such value") from None
    if isinstance(found, tuple) and found and all(one == found[0] for one in found):
        found = found[0]  # one number for both axes
    if isinstance(found, tuple) and found:
        raise UserError(
            f"{path}: has {len(found)} values that differ: name one of them, {path}[1] to "
            f"{path}[{len(found)}]"
        )
    if not isinstance(found, float):
        raise UserError(
            f"{path}: must be a number with a unit or a share, not a whole number or text; the "
            f"scene has {found!r} there"
        )
    return found
