"""The coupled units of a scene as one FMU."""

from __future__ import annotations

import re

from ...fmus.composite.composition import Composition, Part
from ..errors import SceneError
from ..scene import Scene
from .plan import ROTOR, plan
from .runtime import runtime
from .schedule import end_time, in_one_piece, step_size


def composition(scene: Scene) -> Composition:
    """What a scene's composite FMU is made from, with the tolerance that a run takes.

    Nothing is run again for the error of the whole run.  What the scene says of the coupling of
    separate FMUs has no meaning here.

    Raises:
        SceneError: the scene has parts that a composite does not have.
    """
    return scene.once(_composition)


def _composition(scene: Scene) -> Composition:
    scene.refuse_guests("one file")
    found = plan(scene)
    exchanging = {c.source.unit for c in found.of_kind("signal")}
    following = {c.target.unit for c in found.of_kind("value")}
    start = {
        "coupling.tolerance": in_one_piece(scene).coupling.tolerance or 0.0,
        **drive(scene),
    }
    parts = [
        Part(
            unit.name,
            unit.model,
            unit.sizes,
            unit.start,
            found.planes.get(unit.name, 0),
            unit.name in exchanging and unit.name != ROTOR,
            unit.name in following,
        )
        for unit in found.units
    ]
    try:
        return Composition(
            tuple(parts),
            start,
            end_time(scene),
            step_size(scene),
            max(0, len(scene.profile().times) - 2),
            len(scene.operation.unbalance_changes),
        )
    except ValueError as error:
        raise SceneError(f"{scene.label}: {error}") from None


def why_separate(scene: Scene) -> str:
    """Why a scene's units cannot run in C as one composite; empty where they can."""
    try:
        composition_in_c(scene)
    except SceneError as error:
        return str(error)
    return ""


def composition_in_c(scene: Scene) -> Composition:
    """`composition` of a scene whose units can run in C.

    Raises:
        SceneError: they cannot, or as `composition`.
    """
    units = runtime(scene.coupling.units)
    if units.backend == "python":
        raise SceneError(
            units.note or f'{scene.label}: coupling.units = "python": one file is in C'
        )
    return composition(scene)


def model_name(scene: Scene) -> str:
    """Of a scene's composite FMU, and of its file."""
    return re.sub(r"^(?=\d)|\W", "_", scene.name, flags=re.ASCII)


def drive(scene: Scene) -> dict[str, float]:
    """Start values of a composite's drive; under a motor the top speed alone, which steps go by."""
    profile = scene.profile()
    if scene.operation.motor:
        return {"coupling.top_speed": profile.end}
    corners = zip(profile.times[2:], profile.speeds[2:], strict=True)
    own = {
        f"corner[{k}].{key}": value
        for k, corner in enumerate(corners, start=1)
        for key, value in zip(("time", "speed"), corner, strict=True)
    }
    own |= {
        f"unbalance_change[{k}].{key}": float(value)
        for k, change in enumerate(scene.operation.unbalance_changes, start=1)
        for key, value in change
    }
    return {
        "rise_time": profile.times[1] if profile.changes else 0.0,
        "speed": profile.speed(0.0),
        "acceleration": profile.acceleration(0.0),
        **own,
    }
