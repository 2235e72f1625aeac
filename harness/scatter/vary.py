"""What varies, and how: a value of the scene and its distribution, as a user writes them."""

from __future__ import annotations

import inspect
import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError, UserError, refuse_count, refuse_seed, texts_of
from ..result.alike import refuse_unvaried
from ..scene import Scene
from ..scene.balancer import WeightBalancer
from ..scene.replace import in_full
from ..units import si_number

EXAMPLE = "PATH=NAME(NUMBER,...), such as balls.drag=normal(0.2,10%)"
_MANY = 1_000_000  # machines: fewer fit in any memory
_SHARE = re.compile(r"(?:\+-|±)?\s*(\d+(?:\.\d+)?)\s*%")
_TEXT = re.compile(r"(?P<path>[^=]+)=\s*(?P<name>\w+)\s*\((?P<arguments>[^()]*)\)\s*")


@dataclass(frozen=True)
class Variation:
    """A value of the scene that scatters.

    Attributes:
        path: as for `Scene.replace`.
        text: as it was written.
        distribution: of SciPy, with its parameters.
    """

    path: str
    text: str
    distribution: Any

    @classmethod
    def parse(cls, text: str, scene: Scene | None = None) -> Variation:
        """PATH=NAME(NUMBER,...), where parameters can also be given as KEY=NUMBER.

        `normal(mean, deviation, low, high)`, cut off at low and high if they are given,
        `uniform(low, high)`, or `lognormal(median, deviation)` with the deviation of the logarithm.
        Numbers may have units.  Percentages in `normal` are of the mean.

        Args:
            scene: whose path it is; needed where numbers have units.

        Raises:
            UserError: it is not written like that, or the path is none of the scene; what is
                allowed is said.
        """
        match = _TEXT.fullmatch(text.strip())
        if match is None:
            raise UserError(f"{text}: must be {EXAMPLE}{_meant(text)}")
        path = match["path"].strip()
        make = _MAKERS.get(match["name"])
        if make is None:
            raise UserError(f"{text}: {match['name']!r}: must be one of {', '.join(_MAKERS)}")
        if scene:
            refuse_unvaried(scene, path)
        numbers = _numbers(text, match["arguments"], make, scene.unit_of(path) if scene else "")
        try:
            distribution = make(**numbers)
        except ValueError as error:
            raise UserError(f"{text}: {error}") from None
        return cls(in_full(path), text.strip(), distribution)

    @classmethod
    def parse_each(cls, text: str, scene: Scene) -> list[Variation]:
        """As `parse`; `[*]` in the path stands for every weight, each of which has its own draw.

        Raises:
            UserError: as `parse`, or the path is not one of weights.
        """
        before, star, after = text.partition("[*]")
        if not star:
            return [cls.parse(text, scene)]
        counts = {b.label: b.count for b in scene.balancer if isinstance(b, WeightBalancer)}
        label = before.strip().partition(".")[0]
        if label not in counts:
            raise UserError(
                f"{text}: [*] stands for every weight of a balancer; must begin with one of: "
                f"{', '.join(counts) or 'none, as the scene has no weights'}"
            )
        return [cls.parse(f"{before}[{k}]{after}", scene) for k in range(1, counts[label] + 1)]

    @property
    def typical(self) -> float:
        """The median."""
        return float(self.distribution.ppf(0.5))


def _meant(text: str) -> str:
    """How to write a deviation that stands alone, such as rotor.mass=5%."""
    path, _, deviation = (part.strip() for part in text.partition("="))
    share = _SHARE.fullmatch(deviation)
    return (
        f"; for a deviation of {share[1]} % write {path}=normal(MEAN,{share[1]}%)" if share else ""
    )


def variations(vary: Mapping[str, Any] | Iterable[str], scene: Scene) -> list[Variation]:
    """What varies, of texts `PATH=NAME(...)` or of distributions, in words or SciPy's, by path.

    Raises:
        UserError: as `Variation.parse_each`.
    """
    if not isinstance(vary, Mapping):
        texts = texts_of(vary, "vary", '["balls.drag=normal(0.2,10%)"]')
        return [one for text in texts for one in Variation.parse_each(text, scene)]
    return [
        each
        for path, one in vary.items()
        for each in (
            Variation.parse_each(f"{path}={one}", scene)
            if isinstance(one, str)
            else [frozen(path, one)]
        )
    ]


def frozen(path: str, distribution: Any) -> Variation:
    """A distribution of SciPy's at a path of the scene.

    Raises:
        UserError: it is none.
    """
    if not hasattr(distribution, "dist"):
        raise UserError(
            f"{path} = {distribution!r}: must be a text such as 'normal(0.2,10%)', or a frozen "
            "distribution of scipy.stats"
        )
    said = f"{path}={distribution.dist.name}{distribution.args or distribution.kwds}"
    return Variation(in_full(path), said, distribution)


def drawn(variations: Sequence[Variation], count: int, seed: int) -> NDArray[np.float64]:
    """(count, variations) values; each variation has a stream of its own."""
    refuse_seed(seed)
    refuse_count(count, "n")
    streams = np.random.default_rng(seed).spawn(len(variations))
    try:
        values = [
            one.distribution.rvs(size=count, random_state=stream)
            for one, stream in zip(variations, streams, strict=True)
        ]
    except (MemoryError, ValueError) as error:  # a distribution has been checked: of the size
        if count < _MANY:
            raise
        raise UserError(f"n = {count}: so many do not fit in the memory; take fewer") from error
    return np.array(values, float).T


def refuse_wrong(scene: Scene, variations: Sequence[Variation]) -> Scene:
    """The typical machine, with every value at its median.

    Raises:
        UserError: nothing varies, a path twice, one that cannot be, or medians that are wrong.
    """
    if not variations:
        raise UserError(f"--vary: nothing varies; give at least one {EXAMPLE}")
    paths = [one.path for one in variations]
    for path in paths:
        refuse_unvaried(scene, path)
        if paths.count(path) > 1:
            raise UserError(f"--vary {path}: given {paths.count(path)} times")
    return scene.replace({one.path: one.typical for one in variations if not _is_start(one)})


def refuse_drawn(
    typical: Scene, variations: Sequence[Variation], values: NDArray[np.float64]
) -> None:
    """Refuse a distribution whose least or largest drawn value the scene does not allow.

    Raises:
        UserError: it has one; the message says how to cut it off.
    """
    for one, column in zip(variations, values.T, strict=True):
        if _is_start(one):
            continue
        for value in (float(column.min()), float(column.max())):
            try:
                typical.replace({one.path: value})
            except SceneError as error:
                raise UserError(
                    f"--vary {one.text}: draws {value:.6g}, which is not allowed: {error}; "
                    "cut the distribution off, such as by normal(mean,deviation,low,high)"
                ) from None


def _is_start(one: Variation) -> bool:
    """Whether it is a start angle: weights overlap in single machines, not at its ends."""
    return ".angles[" in one.path


def _numbers(text: str, arguments: str, make: Callable[..., Any], unit: str) -> dict[str, float]:
    """Numbers by the parameters' names, in SI units."""
    signature, plain, named = inspect.signature(make), list[str](), dict[str, str]()
    for part in arguments.split(",") if arguments.strip() else ():
        key, _, number = (piece.strip() for piece in part.rpartition("="))
        if key in named:
            raise UserError(f"{text}: {key}: given twice")
        if key:
            named[key] = number
        else:
            plain.append(number)
    try:
        given = signature.bind(*plain, **named).arguments
    except TypeError as error:
        raise UserError(f"{text}: {error}; allowed: {', '.join(signature.parameters)}") from None
    found: dict[str, float] = {}
    for key, number in given.items():
        is_share = number.endswith("%") and "mean" in found
        is_ratio = is_share or (make, key) == (_lognormal, "deviation")
        found[key] = si_number(number, "" if is_ratio else unit, f"{text}: {key} =")
        if is_share:
            found[key] *= abs(found["mean"]) if key == "deviation" else found["mean"]
        if not math.isfinite(found[key]):
            raise UserError(f"{text}: {number!r}: must be finite")
    return found


def _normal(mean: float, deviation: float, low: float = -math.inf, high: float = math.inf) -> Any:
    from scipy.stats import norm, truncnorm

    if not deviation > 0.0:
        raise ValueError(f"deviation = {deviation:g}: must be above 0")
    if not low < high:
        raise ValueError(f"low = {low:g}: must be below high = {high:g}")
    if low == -math.inf and high == math.inf:
        return norm(mean, deviation)
    return truncnorm((low - mean) / deviation, (high - mean) / deviation, mean, deviation)


def _uniform(low: float, high: float) -> Any:
    from scipy.stats import uniform

    if not low < high:
        raise ValueError(f"low = {low:g}: must be below high = {high:g}")
    return uniform(low, high - low)


def _lognormal(median: float, deviation: float) -> Any:
    from scipy.stats import lognorm

    if not (median > 0.0 and deviation > 0.0):
        raise ValueError(f"median = {median:g}, deviation = {deviation:g}: must be above 0")
    return lognorm(deviation, scale=median)


_MAKERS: dict[str, Callable[..., Any]] = {
    "normal": _normal,
    "uniform": _uniform,
    "lognormal": _lognormal,
}
