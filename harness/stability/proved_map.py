"""Stability proved over two parameters: every cell of a map is a box of machines and speeds."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import ClassVar

import flint
import numpy as np
from numpy.typing import NDArray

from ...models.proof.arrays import Unproved
from ...models.proof.certificate import Certificate, State
from ...models.proof.lines import row_speeds
from ..output.table import Sheet
from ..output.workers import Progress, Workers, in_order
from ..scene import Scene
from ..scene.replace import SPEED
from .axis import Axis, Map, refuse_axes
from .ball_tables import Change, Tables
from .exact import refuse_unproved, system
from .proved import PRECISION

PARTS = 4  # of a cell's side: smaller boxes are left undecided
STATES: tuple[State, ...] = ("undecided", "stable", "unstable")
_BLOCK = 16  # parts of a side, to which one set of modes belongs at first
_LEVELS = 2  # divisions of a box before its pieces may get modes of their own
_ROUNDING = 1e-12  # of a box's half side: of places in it
Raster = NDArray[np.int8]
Box = tuple[int, int, int, int]  # parts from, to along x, from, to along y


@dataclass(frozen=True, eq=False, repr=False)
class ProvedMap(Map):
    """What is proved over two parameters; N values of an axis stand for N cells between its ends.

    Attributes:
        parts: (PARTS N_y, PARTS N_x) places in `STATES` of the parts of the cells.
        certificates: number of places about which modes were computed.
    """

    drawn_by: ClassVar[str] = "..stability.plot:plot_proved_map"

    parts: Raster
    certificates: int

    @property
    def cells(self) -> Raster:
        """(N_y, N_x): of cells whose parts are all alike; the others are undecided."""
        blocks = self.parts.reshape(len(self.y.values), PARTS, len(self.x.values), PARTS)
        alike = blocks.min(axis=(1, 3)) == blocks.max(axis=(1, 3))
        return np.where(alike, blocks[:, 0, :, 0], 0).astype(np.int8)

    def lines(self) -> Iterator[str]:
        """What is proved, in words."""
        cells = self.cells
        counts = ", ".join(f"{int((cells == k).sum())} {s}" for k, s in enumerate(STATES))
        share = 100.0 * float((self.parts == 0).mean())
        yield (
            f"{cells.size} cells: {counts}; {share:.3g} % of the map's area undecided, "
            f"{self.certificates} certificates"
        )

    def table(self) -> Sheet:
        """One line a cell."""
        x, y = (edges(axis, 1).tolist() for axis in (self.x, self.y))
        rows = [
            (x[i], x[i + 1], y[j], y[j + 1], STATES[state])
            for (j, i), state in np.ndenumerate(self.cells)
        ]
        heads = [f"{label} {end}" for label in self.labels for end in ("from", "to")]
        return Sheet((*heads, "proved"), rows, title=self.title)


def edges(axis: Axis, parts: int = PARTS) -> NDArray[np.float64]:
    """Edges of the cells' parts along an axis."""
    low, high = axis.values[[0, -1]]
    space = np.geomspace if axis.log else np.linspace
    return np.asarray(space(low, high, parts * len(axis.values) + 1))


def proved_map(
    scene: Scene, x: Axis, y: Axis, *, workers: Workers = 1, progress: Progress | None = None
) -> ProvedMap:
    """Prove stability or instability in every cell.

    Raises:
        UserError: a path is unknown or names no number, or both axes are the same.
        Unproved: nothing can be proved of such a scene.
    """
    refuse_axes(x, y)
    refuse_unproved(scene)
    for axis in (x, y):
        if axis.path != SPEED:
            Tables(scene.replace({axis.path: float(axis.values[0])})).numbers(axis.path)
    cuts = [[*range(0, PARTS * len(a.values), _BLOCK), PARTS * len(a.values)] for a in (x, y)]
    boxes = [(*i, *j) for i in pairwise(cuts[0]) for j in pairwise(cuts[1])]
    found = in_order(_block, [(scene, x, y, box) for box in boxes], workers, progress)
    parts = np.zeros((cuts[1][-1], cuts[0][-1]), np.int8)
    for (a, b, c, d), (block, _) in zip(boxes, found, strict=True):
        parts[c:d, a:b] = block
    return ProvedMap(scene, x, y, parts, sum(count for _, count in found))


def _block(job: tuple[Scene, Axis, Axis, Box]) -> tuple[Raster, int]:
    """Parts of a block, and how many certificates they took."""
    scene, x, y, whole = job
    out = np.zeros((whole[3] - whole[2], whole[1] - whole[0]), np.int8)
    waiting, count = [whole], 0
    with flint.ctx.workprec(PRECISION):
        while waiting:
            box = waiting.pop()
            count += 1
            try:
                modes = _Modes(scene, (x, y), box)
            except Unproved:
                waiting += _quarters(box) if _side(box) > PARTS else ()
                continue
            for (a, b, c, d), state in modes.pieces(box, _LEVELS):
                out[c - whole[2] : d - whole[2], a - whole[0] : b - whole[0]] = STATES.index(state)
                if state == "undecided" and _side((a, b, c, d)) > 1:
                    waiting.append((a, b, c, d))
    return out, count


class _Modes:
    """What modes about the middle of a box prove of its parts."""

    def __init__(self, scene: Scene, axes: tuple[Axis, Axis], box: Box) -> None:
        self.edges = [edges(axis) for axis in axes]
        changes = [
            Change(axis.path, float(at[box[2 * k]]), float(at[box[2 * k + 1]]))
            for k, (axis, at) in enumerate(zip(axes, self.edges, strict=True))
        ]
        middle = scene.replace({change.path: change.middle.low for change in changes})
        self.speed = middle.profile().end
        self.along = [None if c.path == SPEED else c for c in changes]
        others = [change for change in self.along if change]
        low, high = next(((c.low, c.high) for c in changes if c.path == SPEED), (self.speed,) * 2)
        ends = [w for w in row_speeds(middle.assembly().rotor) if low < w < high]
        middles = [0.5 * (a + b) for a, b in pairwise([low, *ends, high])] if ends else [self.speed]
        self.ends = [-math.inf, *ends, math.inf]
        self.certificates = [Certificate.of(system(middle, others, w), w) for w in middles]

    def pieces(self, box: Box, levels: int) -> Iterator[tuple[Box, State]]:
        """The box in pieces as far as they are decided, or worth modes of their own."""
        state, small = self._state(box), _side(box) == 1
        if state != "undecided" or small or (levels < 1 and self._state(box, 0.0) == "undecided"):
            yield box, state
            return
        for quarter in _quarters(box):
            yield from self.pieces(quarter, levels - 1)

    def _state(self, box: Box, share: float = 1.0) -> State:
        """Of a box, or of its middle with a share of 0."""
        speeds, parts = (self.speed, self.speed), []
        for k, (places, change) in enumerate(zip(self.edges, self.along, strict=True)):
            low, high = places[box[2 * k]], places[box[2 * k + 1]]
            middle, half = 0.5 * (low + high), 0.5 * (high - low) * share
            if change is None:
                speeds = float(middle - half), float(middle + half)
            else:
                about = change.middle.low
                scale = max(change.high - about, about - change.low)
                ends = ((middle - half - about) / scale, (middle + half - about) / scale)
                parts.append((ends[0] - _ROUNDING, ends[1] + _ROUNDING))
        low, high = speeds
        states = {
            one.state(max(low, begin), min(high, end), parts)
            for one, (begin, end) in zip(self.certificates, pairwise(self.ends), strict=True)
            if begin <= high and low <= end
        }
        return states.pop() if len(states) == 1 else "undecided"


def _side(box: Box) -> int:
    return max(box[1] - box[0], box[3] - box[2])


def _quarters(box: Box) -> list[Box]:
    """A box halved along each side that has more than one part."""
    cuts = [sorted({a, (a + b + 1) // 2, b}) for a, b in (box[:2], box[2:])]
    return [(*i, *j) for i in pairwise(cuts[0]) for j in pairwise(cuts[1])]
