"""Equations and windows of a scene in ball arithmetic, for all machines within tolerances."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import combinations, product

from ...models.papers.window import LiquidWindow
from ...models.proof.arrays import Unproved
from ...models.proof.equations import Equations
from ...models.proof.lines import piece_around
from ...models.proof.slopes import ball
from ...models.proof.window import WindowBalls
from ..errors import SceneError, UserError
from ..scene import Scene
from ..scene.quantities import LARGEST
from ..scene.replace import in_full
from ..units import si_number
from .ball_tables import Change, Tables, liquid_mass

_FEW = 6  # bands: so many have 64 corners


def tolerances(text: str, scene: Scene) -> tuple[Change, ...]:
    """PATH=5%, PATH=0.2 N/m, several with commas: tolerances on both sides of the scene's values.

    Raises:
        UserError: it is not written like that, a path names no number of the machine, or a band
            reaches values that the scene does not allow.
    """
    changes, amounts, named = list[Change](), dict[str, str](), dict[str, str]()
    for item in text.split(","):
        path, _, amount = (part.strip() for part in item.partition("="))
        if not path or not amount:
            raise UserError(f"within {item!r}: must be PATH=5% or PATH=AMOUNT, as rotor.mass=2%")
        full = in_full(path, scene.body_names)
        for other, written in named.items():
            if f"{full}[".startswith(f"{other}[") or other.startswith(f"{full}["):
                also = "" if full == other else f", also by {written}"
                raise UserError(f"within {item!r}: {path} is given twice{also}; each value once")
        named[full] = path
        percent = amount.removesuffix("%")
        unit = "" if percent != amount else scene.unit_of(path)
        size = si_number(percent, unit, f"within {path}:")
        size = size / 100.0 if percent != amount else size
        if not 0.0 <= size < LARGEST:
            raise UserError(f"within {item!r}: {size:g} must be 0 or more")
        kind = "relative" if percent != amount else "added"
        count = len(Tables(scene).numbers(path))
        amounts[path] = amount
        changes += [Change(path, -size, size, kind, k) for k in range(count) if size]
    _refuse_beyond(scene, changes, amounts)
    return tuple(changes)


def _refuse_beyond(scene: Scene, changes: Sequence[Change], amounts: Mapping[str, str]) -> None:
    """Raise UserError where ends of bands, each alone or several together, are not allowed.

    Values can limit each other: the end of a band may be allowed beside the other's middle alone.
    All corners of a few bands are looked at, of more those of every two.
    """
    whole = [tuple(changes)] if 2 < len(changes) <= _FEW else []
    for some in [*combinations(changes, 1), *combinations(changes, 2), *whole]:
        for ends in product(*((one.low, one.high) for one in some)):
            tables = Tables(scene)
            tables.change([replace(c, low=e, high=e) for c, e in zip(some, ends, strict=True)])
            paths = dict.fromkeys(one.path for one in some)
            try:
                scene.replace({path: tables.value(path) for path in paths})
            except SceneError as error:
                named = ",".join(f"{path}={amounts[path]}" for path in paths)
                reach = " reaches" if len(some) == 1 else "s together reach"
                raise UserError(
                    f"within {named}: the band{reach} a value that the scene does not allow: "
                    f"{error}"
                ) from error


def refuse_unproved(scene: Scene) -> None:
    """Raise Unproved for what is no linear motion about balance."""
    for balancer in scene.balancer:
        if getattr(balancer, "kinematic", 0.0):
            raise Unproved(
                f"{balancer.label}.viscosity: waves that it damps are not proved; give "
                "wave_damping at the speed of interest instead"
            )
        if balancer.can_stick:
            raise Unproved(f"{balancer.label}.rolling_resistance: dry friction is not proved")
        if getattr(balancer, "unequal", False):
            raise Unproved(f"{balancer.label}: proofs are of equal weights, and these differ")
        if balancer.can_meet:
            raise Unproved(
                f"{balancer.label}.weight_radius: contacts of weights are not proved; leave it "
                "out for points that pass"
            )
    if scene.rotor.is_free:
        raise Unproved(
            f"rotor.on: nothing holds {scene.rotor.on!r}: a machine that drifts returns to no place"
        )
    if scene.rotor.slides_at_rest:
        raise Unproved("rotor.friction: dry friction in the supports is not proved")
    if scene.rotor.cubic_stiffness and scene.operation.gravity:
        raise Unproved("rotor.cubic_stiffness: the stiffness about the sag is not proved")
    for mounted in scene.assembly().weights:
        if getattr(mounted.device, "race", ()):
            raise Unproved(f"{mounted.name}.race: lobes are not proved; see method floquet")
        if mounted.offset:
            raise Unproved(f"{mounted.name}: its track is off centre, where no rotor rests")


def system(scene: Scene, changes: Sequence[Change] = (), speed: float | None = None) -> Equations:
    """The equations of a scene whose parameters take intervals.

    Args:
        speed: where bearings over the speed have the line that is taken [rad/s]; default: the
            speed of operation.

    Raises:
        Unproved: they have none, or a balanced motion is not proved to exist.
    """
    refuse_unproved(scene)
    speed = scene.profile().end if speed is None else speed
    piece = piece_around(scene.assembly().rotor, speed)
    tables = Tables(scene)
    tables.change([change.middle for change in changes])
    middle, weights = tables.matrices(speed)
    if all(change.low == change.high for change in changes):
        return Equations.of(middle, middle, weights, piece)
    tables = Tables(scene)
    tables.change(changes)
    return Equations.of(middle, *tables.matrices(speed), piece)


def window(scene: Scene, changes: Sequence[Change] = ()) -> WindowBalls | None:
    """Dubovik's window; None where it does not apply.

    Raises:
        Unproved: its limits are not proved to exist.
    """
    tables = Tables(scene)
    tables.change(changes)
    try:
        LiquidWindow.of(scene.assembly())
    except ValueError:
        return None
    rotor = tables.rotor
    pairs = [rotor["stiffness"], rotor["damping_ratio"] or rotor["damping"]]
    if any(x is not y for x, y in pairs):
        return None  # axes that tolerances make different
    tables.damp()
    (liquid,) = tables.balancers.values()
    springs, dampers = rotor["stiffness"][0], rotor["damping"][0]
    used = rotor["mass"], liquid_mass(liquid), springs, dampers, rotor["internal_damping"]
    return WindowBalls.of(*map(ball, used))
