"""The kinds of checks, and their rows: each compares what the coupled units did with a theory."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from ..errors import SceneError
from ..scene import Scene
from ..scene.check import AnyCheck, CriticalSpeedsCheck
from .capacity import check_capacity, check_sizes
from .critical_speeds import check_critical_speeds
from .filimonikhina import TABLES, check_row
from .largest_spread import check_largest_spread
from .liquid_window import check_liquid_window
from .ranking import check_ranking
from .rig import GROUPS, check_rig
from .row import Row
from .slow_root import check_slow_root
from .sommerfeld import check_sommerfeld

# scene -> rows, with the options of one of the check's parts
CHECKS: dict[str, Callable[..., Iterator[Row]]] = {
    "liquid_window": check_liquid_window,
    "critical_speeds": check_critical_speeds,
    "capacity": check_capacity,
    "sommerfeld": check_sommerfeld,
    "filimonikhina_table": check_row,
    "goncharov_table": check_sizes,
    "goncharov_ranking": check_ranking,
    "slow_root": check_slow_root,
    "largest_spread": check_largest_spread,
    "rig": check_rig,
}
# options of every part that can be done on its own
SPLIT: dict[str, list[dict[str, Any]]] = {
    "filimonikhina_table": [{"index": index} for index in range(len(TABLES))],
    "rig": [{"rows_of": name} for name in GROUPS],
}


@dataclass(frozen=True)
class CheckPart:
    """Of a scene's checks, as much as is done in one piece."""

    scene: Scene
    kind: str
    options: Mapping[str, Any] = field(default_factory=dict)

    def rows(self) -> list[Row]:
        """Run the part, and give its rows."""
        return list(CHECKS[self.kind](self.scene, **self.options))


def parts_of(scene: Scene) -> list[CheckPart]:
    """Everything that a scene asks to be checked, in order.

    Raises:
        SceneError: there is nothing to check, or gravity acts, which no theory of a check has.
    """
    if not scene.checks:
        raise SceneError(
            f"{scene.path or scene.name}: nothing to check: add a [[check]] table, for example "
            'kind = "liquid_window"'
        )
    for number, check in enumerate(scene.checks, start=1):
        if scene.operation.gravity:
            raise SceneError(
                f'{scene.name}: check[{number}].kind = "{check.kind}": its theory has no '
                "gravity: remove operation.gravity"
            )
    return [
        CheckPart(scene, check.kind, options)
        for check in scene.checks
        for options in _options(check)
    ]


def _options(check: AnyCheck) -> list[dict[str, Any]]:
    if isinstance(check, CriticalSpeedsCheck):
        return [{"check": check}]
    return SPLIT.get(check.kind, [{}])
