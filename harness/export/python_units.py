"""What Python units cannot do of a scene, before any is built."""

from __future__ import annotations

from ...fmus.catalogue import sized_unit
from ...fmus.composite.composition import SET_BY_COUPLING
from ..errors import SceneError
from ..master.plan import plan
from ..scene import Scene


def refuse_native_only(scene: Scene) -> None:
    """Raise SceneError, a line each, for what the native units alone have."""
    lines = []
    if scene.operation.unbalance_changes:
        lines.append("operation.unbalance_changes: the unbalance of a Python unit is fixed")
    for unit in plan(scene).units:
        sized = sized_unit(unit.model, **unit.sizes)
        try:
            _ = sized.in_python
        except ValueError as error:
            lines.append(f"{unit.name}: {error}")
        start = {k: v for k, v in unit.start.items() if k not in SET_BY_COUPLING}
        lines += [f"{unit.name}.{problem}" for problem in sized.python_problems(start)]
    if lines:
        named = "\n".join(f"{scene.label}: {line}" for line in lines)
        raise SceneError(f"{named}\n{scene.label}: leave out --python: the native units have it")
