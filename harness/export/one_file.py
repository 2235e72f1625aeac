"""A scene's units and their coupling written as one FMU."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from ...fmus.composite.build import build_composite
from ...models.harmonic_balance import NoResponse
from ..master.one_file import composition, model_name
from ..master.schedule import end_time
from ..output.workers import Progress
from ..result.verdict import BALANCED, vibration_alone
from ..scene import Scene
from .reference_files import reference_files


def _limit(scene: Scene) -> float:
    """Vibration below which a run of the scene counts as balanced [m]; 0 where it is not known."""
    try:
        return BALANCED * vibration_alone(scene, scene.profile().end, end_time(scene))
    except NoResponse:
        return 0.0


def build_one_file(
    scene: Scene,
    path: Path,
    fmi: int = 2,
    platforms: Iterable[str] | None = None,
    *,
    plain: bool = False,
    flat: bool = False,
    reference: bool = False,
    progress: Progress | None = None,
) -> Path:
    """Build a scene's composite FMU; its model is named after the scene.

    Args:
        fmi, platforms: as `build_composite`.
        plain, flat: as `Composition`.
        reference: with `reference_files`.
        progress: told the finished fraction of these.

    Raises:
        SceneError: as `composition`.
        SimulationError: as `reference_files`.
        ValueError, NotCompiled, OSError: as `build_composite`.
    """
    made = composition(scene)
    made = replace(
        made,
        start={**made.start, "vibration_limit": _limit(scene)},
        title=scene.heading,
        source=scene.source,
        plain=plain,
        flat=flat,
    )
    extra = None
    if reference:
        extra = reference_files(scene, made.described(scene.name).label, progress)
    return build_composite(
        made, path, name=model_name(scene), fmi=fmi, platforms=platforms, extra=extra
    )
