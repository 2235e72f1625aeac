"""Texts beside the points of a picture, each where it hides least."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.text import Annotation, Text
from matplotlib.transforms import Bbox

from ...models.arrays import Array

_ASIDE, _ABOVE = 5.0, 3.0  # points from a text's corner to its point
_OVER = 5.0  # points above or below the middle of a text
_SHARES = (0.0, 1.0, 0.5, 0.25, 0.75)  # of a text's width that stand left of its point
_FAR = 3.0  # times the usual distance; a thin line then leads to the point
# what a place costs, in pixels of lines that a text hides there
_TEXT, _OUTSIDE = 5.0, 20.0  # a pixel over another text, outside the axes
_LATER, _AWAY = 0.2, 3.0  # a later place in the list, a far one


class BesidePoint(Annotation):
    """A text right above its point until `place_texts` has moved it."""

    def __init__(self, text: str, point: Sequence[float], colour: str) -> None:
        line = {"arrowstyle": "-", "lw": 0.6, "color": colour, "shrinkA": 0.0, "shrinkB": 2.0}
        super().__init__(
            text, (point[0], point[1]), xytext=(_ASIDE, _ABOVE), textcoords="offset points",
            va="bottom", color=colour, fontsize="small", arrowprops=line,
        )  # fmt: skip
        self.move(_ASIDE, _ABOVE, is_far=False)

    def move(self, x: float, y: float, is_far: bool) -> None:
        """Put the lower left corner so many points from the point."""
        self.xyann = x, y
        assert self.arrow_patch is not None
        self.arrow_patch.set_visible(is_far)


def place_texts(figure: Figure) -> None:
    """Move each `BesidePoint` to where it hides least of lines, marks, and texts before it."""
    texts = {axes: [t for t in axes.texts if isinstance(t, BesidePoint)] for axes in figure.axes}
    if not any(texts.values()):
        return
    figure.draw_without_rendering()  # places are known only then
    for axes, own in texts.items():
        if own:
            drawn = _Drawn(axes)
            for text in own:
                if text.get_text():
                    _place(text, drawn)


def _place(text: BesidePoint, drawn: _Drawn) -> None:
    pixels = drawn.axes.figure.dpi / 72.0
    size = Text.get_window_extent(text)  # without the line
    point = drawn.axes.transData.transform(text.xy)
    found = []
    for number, (x, y, is_far) in enumerate(_places(size.width / pixels, size.height / pixels)):
        left, below = point + pixels * np.array([x, y])
        box = Bbox.from_bounds(left, below, size.width, size.height)
        cost = drawn.hidden_by(box) + _LATER * number + _AWAY * is_far
        found.append((cost, number, (x, y, is_far), box))
    _, _, place, box = min(found)
    text.move(*place)
    drawn.boxes.append(box)


def _places(width: float, height: float) -> list[tuple[float, float, bool]]:
    """Of a text's lower left corner from its point [points], the best first."""
    places = []
    for times in (1.0, _FAR):
        aside, above, over = times * _ASIDE, times * _ABOVE, times * _OVER
        for share in _SHARES:
            x = -share * width + aside * (1.0 - 2.0 * share)
            away = above if share in (0.0, 1.0) else over
            places += [(x, away, times > 1.0), (x, -away - height, times > 1.0)]
        places += [(x, -0.5 * height, times > 1.0) for x in (1.6 * aside, -1.6 * aside - width)]
    return places


class _Drawn:
    """What stands in axes, in pixels."""

    def __init__(self, axes: Any) -> None:
        self.axes = axes
        named = [*axes.get_xticklabels(), *axes.get_yticklabels(), axes.get_legend()]
        self.boxes = [one.get_window_extent() for one in named if one and one.get_visible()]
        frame = axes.patch.get_path().transformed(axes.patch.get_transform()).to_polygons()
        self.segments = [np.stack([outline[:-1], outline[1:]], axis=1) for outline in frame]
        self.marks: list[tuple[Array, float]] = []
        for line in axes.lines:
            points = line.get_transform().transform(line.get_xydata())
            if line.get_linestyle() not in ("None", "", " "):
                self.segments.append(np.stack([points[:-1], points[1:]], axis=1))
            if line.get_marker() not in ("None", "", " ", None):
                self.marks.append((points, 0.5 * line.get_markersize() * axes.figure.dpi / 72.0))

    def hidden_by(self, box: Bbox) -> float:
        """Pixels that a text in this box hides of lines, marks and texts, or is outside."""
        low, high = np.array([box.min, box.max])
        pixels = sum(_length_within(ends, low, high) for ends in self.segments)
        for points, radius in self.marks:
            inside = ((points > low - radius) & (points < high + radius)).all(axis=1)
            pixels += 2.0 * radius * np.count_nonzero(inside)
        for other in self.boxes:
            common = Bbox.intersection(box, other)
            pixels += _TEXT * max(common.size) if common else 0.0
        frame = self.axes.bbox
        outside = np.maximum(frame.min - low, 0.0) + np.maximum(high - frame.max, 0.0)
        return float(pixels + _OUTSIDE * outside.sum())


def _length_within(ends: Array, low: Array, high: Array) -> float:
    """Length of segments (k, 2 ends, 2) within a box."""
    begin, way = ends[:, 0], ends[:, 1] - ends[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        cuts = np.stack([(low - begin) / way, (high - begin) / way])
        enter, leave = cuts.min(axis=0).max(axis=1), cuts.max(axis=0).min(axis=1)
        share = np.clip(leave, 0.0, 1.0) - np.clip(enter, 0.0, 1.0)
        lengths = np.where(leave > enter, share, 0.0) * np.hypot(*way.T)
    return float(np.nansum(lengths))
