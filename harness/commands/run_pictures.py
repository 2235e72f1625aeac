"""Pictures and movies of `autobalancer run`."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import UserError
from ..output.options import claim
from ..output.terminal import progress_bars, ready_to_write, say

if TYPE_CHECKING:
    from ..result.result import Result
    from ..scene import Scene


def check_movie(path: Path | None) -> Path | None:
    """Refuse a movie that cannot be made or written, before the run.

    Raises:
        UserError: so it is.
    """
    if path is not None:
        from ..result.movie import refuse_unwritable

        refuse_unwritable(path)
        ready_to_write(path)
        claim(path)
    return path


def refuse_pictures(scene: Scene, kinds: Collection[str]) -> None:
    """Refuse kinds of pictures that the scene's run cannot give, before it.

    Raises:
        UserError: so it is.
    """
    if not kinds:
        return  # to load what pictures are made from takes longer than a run
    from ..master.schedule import end_time
    from ..result.motion import with_weights
    from ..result.orders import SHORTEST, SYNCHRONOUS, refuse_few

    windows = {"waterfall": SHORTEST, "polar": SYNCHRONOUS}  # revolutions
    profile, end = scene.profile(), end_time(scene)
    part = profile.sweep if profile.changes else (0.0, end)
    begin, last = (profile.angle(min(time, end)) for time in part)
    for kind in kinds:
        try:
            if kind == "weights":
                with_weights(scene)
            elif kind in windows:
                refuse_few(last - begin, windows[kind])
        except UserError as error:
            raise UserError(f"--{kind}: {error}") from error


def record(scene: Scene) -> list[str]:
    """What the scene asks for, and what pictures are drawn from."""
    from ..master.recorder import recorded

    return list(dict.fromkeys([*recorded(scene), *recorded(scene.replace({"run.record": None}))]))


def draw(result: Result, pictures: Mapping[str, Path]) -> None:
    """Pictures by kind, each to its place.

    Raises:
        UserError: one cannot be drawn or written.
    """
    with progress_bars() as bars:
        for kind, path in pictures.items():
            task = bars.add_task(f"drawing {kind}", total=None)
            getattr(result, f"plot_{kind}")().save(path)
            bars.remove_task(task)
            say(f"Picture: {path}")
