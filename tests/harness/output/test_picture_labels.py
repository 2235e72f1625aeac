"""Ticks of logarithmic axes, and texts beside points: they can be read."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text

from autobalancer.harness.output.panels import Line, Panel, Panels, PlotAxis
from autobalancer.harness.output.plot import as_png, drawn

SIDE = np.array([0.0, 1.0])


def plotted(*lines: Line, log: bool = False) -> Figure:
    axes = PlotAxis("speed", "m"), PlotAxis("size", log=log)
    return drawn(Panels("title", [Panel(axes, lines)]))


def labels(figure: Figure) -> list[str]:
    figure.draw_without_rendering()
    (axes,) = figure.axes
    low, high = axes.get_ylim()
    shown = [
        t for t in axes.get_yticklabels() if t.get_text() and low <= t.get_position()[1] <= high
    ]
    hidden = [t.get_text() for t in axes.yaxis.get_minorticklabels()]
    assert not any(hidden)
    return [text.get_text() for text in shown]


@pytest.mark.parametrize(
    ("low", "high", "expected"),
    [
        (0.028, 0.7, ["0.03", "0.05", "0.07", "0.1", "0.2", "0.3", "0.5"]),
        (20.0, 600.0, ["20", "30", "50", "70", "100", "200", "300", "500"]),
        (0.2, 4.9, ["0.2", "0.3", "0.5", "0.7", "1", "2", "3"]),
    ],
)
def test_a_logarithmic_axis_of_few_decades_has_numbers_that_are_read_at_once(low, high, expected):
    assert set(expected) <= set(labels(plotted(Line((SIDE, np.array([low, high]))), log=True)))


@pytest.mark.parametrize(("low", "high"), [(1.12, 1.31), (0.105, 0.118), (350.0, 480.0)])
def test_a_logarithmic_axis_within_a_step_has_ticks(low, high):
    found = [
        float(label) for label in labels(plotted(Line((SIDE, np.array([low, high]))), log=True))
    ]
    assert len(found) >= 3
    assert low * 0.9 < min(found) < max(found) < high * 1.1


def test_a_logarithmic_axis_of_many_decades_has_whole_ones():
    found = labels(plotted(Line((SIDE, np.array([1e-9, 1.0]))), log=True))
    assert 3 <= len(found) <= 12
    assert all("10^{" in label for label in found)


def test_small_numbers_within_a_decade_have_a_power_of_ten():
    found = labels(plotted(Line((SIDE, np.array([2e-7, 9e-7]))), log=True))
    assert r"$3 \times 10^{-7}$" in found


def boxes(figure: Figure) -> list[tuple[np.ndarray, np.ndarray]]:
    as_png(figure)
    figure.draw_without_rendering()
    (axes,) = figure.axes
    sizes = [Text.get_window_extent(text) for text in axes.texts if text.get_text()]
    return [(box.min, box.max) for box in sizes]


def apart(one: tuple[np.ndarray, np.ndarray], other: tuple[np.ndarray, np.ndarray]) -> bool:
    return bool(np.any(one[0] >= other[1]) or np.any(other[0] >= one[1]))


def test_texts_of_points_that_lie_close_together_do_not_overlap():
    x = np.array([0.0, 0.5, 0.505, 0.51, 1.0])
    y = np.array([0.0, 0.5, 0.51, 0.50, 1.0])
    found = boxes(plotted(Line((x, y), style="marks", texts=("", "one", "two", "three", ""))))
    assert len(found) == 3
    assert all(apart(a, b) for k, a in enumerate(found) for b in found[:k])


def test_a_text_stands_clear_of_a_line_that_would_cross_it():
    point = Line((np.array([0.0, 0.1, 1.0]), np.array([0.0, 0.5, 1.0])), "", "#000000", "marks",
                 texts=("", "tolerance", ""))  # fmt: skip
    ((low, high),) = boxes(plotted(point, Line((np.array([0.18, 0.18]), np.array([0.2, 0.9])))))
    figure = plotted(point)
    ((_, alone),) = boxes(figure)
    (axes,) = figure.axes
    at = axes.transData.transform((0.18, 0.5))[0]
    assert low[0] < alone[0]  # it has moved
    assert high[0] < at or at < low[0]


def test_a_text_with_room_stands_right_above_its_point():
    figure = plotted(Line((SIDE, SIDE[::-1])), Line((SIDE, SIDE), style="marks", texts=("a", "")))
    ((low, _),) = boxes(figure)
    point = figure.axes[0].transData.transform((0.0, 0.0))
    assert np.all(low > point)
    assert np.all(low < point + 10.0)


def test_panels_below_each_other_name_their_common_axis_once():
    across, upward = PlotAxis("speed", "rpm", limits=(0.0, 1.0)), PlotAxis("size")
    figure = drawn(Panels("", [Panel((across, upward), [Line((SIDE, SIDE))])] * 6, columns=2))
    figure.draw_without_rendering()
    assert [axes.get_xlabel() for axes in figure.axes] == [""] * 4 + ["speed [rpm]"] * 2
    ticked = [any(t.get_text() for t in axes.get_xticklabels()) for axes in figure.axes]
    assert ticked == [False] * 4 + [True] * 2


def test_panels_of_their_own_limits_keep_them():
    panels = [Panel((PlotAxis("x"), PlotAxis("y")), [Line((k * SIDE, SIDE))]) for k in (1.0, 9.0)]
    figure = drawn(Panels("", panels * 2, columns=2))
    assert [axes.get_xlabel() for axes in figure.axes] == ["x"] * 4
    assert figure.axes[0].get_xlim()[1] < 2.0 < figure.axes[1].get_xlim()[1]


def test_no_number_stands_on_the_rim_of_a_polar_panel():
    line = Line((np.array([0.0, 1.0]), np.array([0.0, 4.95])), style="marks")
    figure = drawn(Panels("", [Panel((PlotAxis("a"), PlotAxis("r")), [line], kind="polar")]))
    figure.draw_without_rendering()
    (axes,) = figure.axes
    assert len(axes.get_yticks()) >= 3
    assert max(axes.get_yticks()) < 0.95 * axes.get_rmax()
