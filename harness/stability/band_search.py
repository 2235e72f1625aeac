"""A range of speeds divided into bands that certificates decide, and bands that none does.

An interval is halved, or the box of machines is, across what keeps the certificate from deciding
most: until everything is decided, or what is undecided is narrow.
"""

from __future__ import annotations

import functools
import itertools
from bisect import bisect_right
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...models.proof.arrays import Unproved
from ...models.proof.certificate import Certificate, State
from ...models.proof.equations import Equations
from ...models.proof.lines import row_speeds
from ..output.workers import Progress
from ..scene import Scene
from .ball_tables import Change
from .exact import system

_LEVELS = 6  # halvings of an interval by one certificate
_PLACE = 0.48  # of an interval: a certificate's speed; boundaries often lie in the middle
_LESS = 0.6  # of an interval: a narrower one gets certificates of its own
_STUCK = 3  # halvings in a row whose middles are undecided themselves
_MOST_BOXES = 64
_MOST_CERTIFICATES = 3000

Box = tuple[Change, ...]


@dataclass(frozen=True)
class Band:
    """Speeds [rad/s] and what is proved of all of them."""

    low: float
    high: float
    state: State

    def as_json(self) -> dict[str, Any]:
        """Plain numbers."""
        return {"from": self.low, "to": self.high, "state": self.state}


class Search:
    """The search for bands of a machine and of a box of others around it.

    Attributes:
        certificates: number of speeds about which modes were computed so far.
        most_boxes: largest number of boxes so far.
    """

    def __init__(self, scene: Scene, box: Box, narrowest: float, progress: Progress | None) -> None:
        self.scene, self.whole = scene, box
        self.narrowest, self.progress = narrowest, progress
        self.certificates, self.most_boxes = 0, 1
        self.rows = row_speeds(scene.assembly().rotor)
        self.system = functools.cache(functools.partial(system, scene))
        self.range = (0.0, 1.0)

    def bands(self, low: float, high: float) -> Iterator[Band]:
        """Bands of a range, ascending.

        Raises:
            Unproved: the machine in the middle of the box has no balanced motion.
        """
        self.range = low, high
        ends = [low, *(w for w in self.rows if low < w < high), high]
        self._system(_middle(self.whole), low)
        pieces = itertools.pairwise(ends)
        return itertools.chain.from_iterable(
            self._bands(begin, end, [self.whole], 0) for begin, end in pieces
        )

    def _system(self, box: Box, speed: float) -> Equations:
        """Of a box, with the lines that tables over the speed have at a speed [rad/s]."""
        row = bisect_right(self.rows, speed)
        return self.system(box, self.rows[row - 1] if row else speed)

    def _bands(self, low: float, high: float, boxes: list[Box], stuck: int) -> Iterator[Band]:
        """Bands of an interval; `stuck` counts what was divided in vain."""
        if self.progress:
            self.progress((low - self.range[0]) / (self.range[1] - self.range[0]))
        self.most_boxes = max(self.most_boxes, len(boxes))
        speed = low + _PLACE * (high - low)
        certificates = [self._certificate(box, speed) for box in boxes]
        for piece in merged(_pieces(certificates, low, high, _LEVELS)):
            width = piece.high - piece.low
            spent = self.certificates > _MOST_CERTIFICATES or not low < speed < high
            if piece.state != "undecided" or width <= self.narrowest or spent:
                yield piece
            else:
                again = stuck if width >= _LESS * (high - low) else None
                yield from self._divided(piece.low, piece.high, boxes, certificates, again)

    def _divided(
        self,
        low: float,
        high: float,
        boxes: list[Box],
        certificates: list[Certificate | None],
        stuck: int | None,
    ) -> Iterator[Band]:
        """Bands of an interval that certificates leave undecided, across what matters most.

        Args:
            stuck: None where the interval is short enough for certificates of its own.
        """
        found = zip(boxes, certificates, strict=True)
        parameters = [self._parameter(box, one, low, high) for box, one in found]
        if self.whole and any(k is not None for k in parameters):
            corners = self._corners(certificates)
            both = [self._contradicts(corners, low + f * (high - low)) for f in (0.1, 0.5, 0.9)]
            if all(both):
                yield Band(low, high, "undecided")
                return
            if not any(both) and len(boxes) < _MOST_BOXES:
                smaller = [
                    half for box, k in zip(boxes, parameters, strict=True)
                    for half in ([box] if k is None else _halves(box, k))
                ]  # fmt: skip
                yield from self._bands(low, high, smaller, stuck or 0)
                return
        if stuck is None:
            yield from self._bands(low, high, boxes, 0)
            return
        vain = stuck + any(
            c is None or c.state(c.speed, c.speed) == "undecided" for c in certificates
        )
        if vain > _STUCK:
            yield Band(low, high, "undecided")
            return
        middle = 0.5 * (low + high)
        yield from self._bands(low, middle, boxes, vain)
        yield from self._bands(middle, high, boxes, vain)

    def _certificate(self, box: Box, speed: float, degree: int | None = None) -> Certificate | None:
        self.certificates += 1
        try:
            return Certificate.of(self._system(box, speed), speed, degree)
        except Unproved:
            return None

    def _parameter(
        self, box: Box, found: Certificate | None, low: float, high: float
    ) -> int | None:
        """The parameter that keeps an interval from being decided; None where its width does."""
        if found is None:
            pairs = zip(box, self.whole, strict=True)
            widths = [(c.high - c.low) / (w.high - w.low) for c, w in pairs]
            return int(np.argmax(widths)) if widths else None
        if found.state(low, high) != "undecided":
            return None
        speed, *others = found.influences
        useful = found.state(found.speed, found.speed) != "undecided" or not others
        k = int(np.argmax([0.5 * (high - low) * speed * useful, *others]))
        return k - 1 if k else None

    def _corners(self, certificates: Sequence[Certificate | None]) -> list[Box]:
        """The machines within the tolerances that grow least and most, to first order."""
        slopes = next((c.growth_slopes for c in certificates if c), [1.0] * len(self.whole))
        up = [s > 0.0 for s in slopes]
        ends = [(replace(c, high=c.low), replace(c, low=c.high)) for c in self.whole]
        return [tuple(e[u == k] for e, u in zip(ends, up, strict=True)) for k in (True, False)]

    def _contradicts(self, corners: list[Box], speed: float) -> bool:
        """Whether one of these machines is stable and another one not."""
        states = {_state([self._certificate(c, speed, 0)], speed, speed) for c in corners}
        return states >= {"stable", "unstable"}


def _halves(box: Box, k: int) -> list[Box]:
    """A box in two, across a parameter."""
    return [(*box[:k], half, *box[k + 1 :]) for half in box[k].halves()]


def _middle(box: Box) -> Box:
    return tuple(change.middle for change in box)


def _state(certificates: Sequence[Certificate | None], low: float, high: float) -> State:
    """What all of them prove."""
    first: State = "undecided"
    for number, one in enumerate(certificates):
        state = "undecided" if one is None else one.state(low, high)
        if state == "undecided" or (number and state != first):
            return "undecided"
        first = state
    return first


def _pieces(
    certificates: Sequence[Certificate | None], low: float, high: float, levels: int
) -> Iterator[Band]:
    """An interval in pieces, as far as these certificates decide them."""
    state = _state(certificates, low, high)
    middle = 0.5 * (low + high)
    if state != "undecided" or not levels or not low < middle < high:
        yield Band(low, high, state)
        return
    yield from _pieces(certificates, low, middle, levels - 1)
    yield from _pieces(certificates, middle, high, levels - 1)


def merged(bands: Iterable[Band]) -> tuple[Band, ...]:
    """Neighbours of one state as one band."""
    return tuple(
        Band(group[0].low, group[-1].high, state)
        for state, members in itertools.groupby(bands, lambda band: band.state)
        for group in [list(members)]
    )
