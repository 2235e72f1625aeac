"""The kinds of checks, and their rows: each compares what the coupled units did with a theory."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from typing import Any

from ..errors import SceneError
from ..scene import Scene
from ..scene.check import AnyCheck, CriticalSpeedsCheck
from .row import Row

Work = Callable[..., Iterator[Row]]  # scene -> rows, with the options of one of the check's parts
# by module: the functions load SciPy, which a process that only distributes the work does without
CHECKS: dict[str, str | Work] = {
    "liquid_window": ".liquid_window:check_liquid_window",
    "ring_band": ".ring_band:check_ring_band",
    "critical_speeds": ".critical_speeds:check_critical_speeds",
    "capacity": ".capacity:check_capacity",
    "sommerfeld": ".sommerfeld:check_sommerfeld",
    "filimonikhina_table": ".filimonikhina:check_row",
    "goncharov_table": ".capacity:check_sizes",
    "goncharov_ranking": ".ranking:check_ranking",
    "slow_root": ".slow_root:check_slow_root",
    "largest_spread": ".largest_spread:check_largest_spread",
    "rig": ".rig:check_rig",
}


def work_of(kind: str) -> Work:
    """The function that does a kind of check."""
    found = CHECKS[kind]
    if isinstance(found, str):
        module, _, name = found.partition(":")
        found = getattr(import_module(module, __package__), name)
    return found


@dataclass(frozen=True)
class CheckPart:
    """Of a scene's checks, as much as is done in one piece."""

    scene: Scene
    kind: str
    options: Mapping[str, Any] = field(default_factory=dict)

    def rows(self) -> list[Row]:
        """Run the part, and give its rows."""
        return list(work_of(self.kind)(self.scene, **self.options))


def parts_of(scene: Scene) -> list[CheckPart]:
    """Everything that a scene asks to be checked, in order.

    Raises:
        SceneError: there is nothing to check, or gravity acts, which no theory of a check has.
    """
    if not scene.checks:
        raise SceneError(
            f"{scene.label}: nothing to check: add a [[check]] table, for example "
            'kind = "liquid_window"'
        )
    for number, check in enumerate(scene.checks, start=1):
        if scene.operation.gravity:
            raise SceneError(
                f'{scene.label}: check[{number}].kind = "{check.kind}": its theory has no '
                "gravity: remove operation.gravity"
            )
    return [
        CheckPart(scene, check.kind, options)
        for check in scene.checks
        for options in _options(check)
    ]


def _options(check: AnyCheck) -> list[dict[str, Any]]:
    """Options of every part of a check that can be done on its own."""
    if isinstance(check, CriticalSpeedsCheck):
        return [{"check": check}]
    if check.kind == "filimonikhina_table":
        from .filimonikhina import TABLES

        return [{"index": index} for index in range(len(TABLES))]
    if check.kind == "rig":
        from .rig import GROUPS

        return [{"rows_of": name} for name in GROUPS]
    return [{}]
