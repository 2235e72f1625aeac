"""Axes of a map: two parameters of a scene and the values that they take."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..errors import UserError
from ..output.outcome import Outcome
from ..output.table import Sheet
from ..scene import Scene
from ..scene.quantities import LARGEST
from ..scene.replace import SPEED, in_full
from ..units import si_number

MOST_POINTS = 2000  # along one axis: a slip of the keyboard


@dataclass(frozen=True)
class Axis:
    """A parameter of a scene and the values it takes.

    Attributes:
        path: as for `Scene.replace`, such as `weights.drag`.
        values: (N,) rising.
        log: spaced and drawn logarithmically.
    """

    path: str
    values: NDArray[np.float64]
    log: bool = False

    @classmethod
    def parse(cls, text: str, scene: Scene | None = None) -> Axis:
        """PATH=LOW:HIGH:N or PATH=LOW:HIGH:N:log; `speed` is short for operation.speed.

        Args:
            scene: whose path it is; needed where LOW and HIGH have units.

        Raises:
            UserError: it is not written like that, or the values are not rising.

        >>> ab.Axis.parse("speed=1:6:3").values.tolist()
        [1.0, 3.5, 6.0]
        """
        example = "must be PATH=LOW:HIGH:N[:log], such as speed=0.5:12:100"
        if not isinstance(text, str):
            raise UserError(f"axis {text!r}: {example}, as text or as Axis")
        path, _, span = (part.strip() for part in text.partition("="))
        parts = span.split(":")
        if not path or len(parts) not in (3, 4) or parts[3:] not in ([], ["log"]):
            raise UserError(f"{text}: {example}")
        try:
            count = int(parts[2])
        except ValueError as error:
            raise UserError(f"{text}: {example}") from error
        unit = scene.unit_of(path) if scene else ""
        low, high = (si_number(part, unit, f"{text}: {example}:") for part in parts[:2])
        log = len(parts) == 4
        if not -LARGEST <= low < high <= LARGEST:
            raise UserError(
                f"{text}: {low:g} to {high:g} must be finite and rising, within {LARGEST:g}"
            )
        if log and low <= 0.0:
            raise UserError(f"{text}: a logarithmic axis must begin above 0, not at {low:g}")
        if not 2 <= count <= MOST_POINTS:
            raise UserError(f"{text}: N = {count} must be 2 to {MOST_POINTS}")
        values = np.geomspace(low, high, count) if log else np.linspace(low, high, count)
        return cls(in_full(path), values, log)

    def label(self, scene: Scene) -> str:
        """Name and unit, such as `weights.drag [N s/m]`.

        >>> ab.Axis.parse("weights.drag=1:6:3").label(ab.load("two_balls"))
        'weights.drag [N s/m]'
        """
        unit = scene.unit_of(self.path)
        name = "speed" if self.path == SPEED else self.path
        return f"{name} [{unit}]" if unit else name


@dataclass(frozen=True, eq=False, repr=False)
class Map(Outcome):
    """What was found over two parameters of a scene; grids have the shape (len(y), len(x)).

    Attributes:
        scene: at whose other values.
        x, y: axes.
    """

    dimensions: ClassVar[int] = 2

    scene: Scene
    x: Axis
    y: Axis

    @property
    def title(self) -> str:
        """That of the scene."""
        return self.scene.heading

    @property
    def labels(self) -> tuple[str, str]:
        """Names and units of both axes."""
        return self.x.label(self.scene), self.y.label(self.scene)

    def _sheet(
        self, columns: Mapping[str, NDArray[Any]], failure: NDArray[np.object_] | None = None
    ) -> Sheet:
        """One line a point of the grid.

        Args:
            columns: the heading of each column -> its values on the grid.
            failure: why a point has failed, the last column; there the others are empty.
        """
        rows = []
        for j, i in np.ndindex(len(self.y.values), len(self.x.values)):
            failed = failure is not None and failure[j, i]
            cells = ["" if failed else _plain(grid[j, i]) for grid in columns.values()]
            cells += [] if failure is None else [failure[j, i]]
            rows.append((float(self.x.values[i]), float(self.y.values[j]), *cells))
        heads = (*self.labels, *columns, *(() if failure is None else ("failure",)))
        return Sheet(heads, rows, title=self.title)


def _plain(value: Any) -> Any:
    return value.item() if isinstance(value, np.generic) else value


def refuse_axes(x: Axis, y: Axis) -> None:
    """Refuse axes that make no map.

    Raises:
        UserError: both are the same, or a speed is not above 0.
    """
    if x.path == y.path:
        raise UserError(f"{x.path}: both axes are the same")
    for axis in (x, y):
        if axis.path == SPEED and not axis.values[0] > 0.0:
            raise UserError(f"speed = {axis.values[0]:g} rad/s: must be greater than 0")
