"""Pictures of maps show what matters: no decades of rounding, ticks at powers of ten."""

from __future__ import annotations

import numpy as np
import pytest

import autobalancer as ab
from autobalancer.harness.stability.axis import Axis
from autobalancer.harness.stability.plot import FLOOR, plot_run_map


class Machine:
    """What a picture asks of a map of runs."""

    x = Axis.parse("speed=1:3:3")
    y = Axis.parse("speed=1:2:2")
    labels, title = ("speed", "speed"), "map"

    def __init__(self, residual):
        self.residual = np.array(residual)
        self.settled = np.ones_like(self.residual)


@pytest.mark.parametrize("smallest", [1e-16, 0.0])
def test_residuals_that_are_rounding_span_no_decades_of_colour(smallest):
    field = (
        plot_run_map(Machine([[smallest, 1e-3, np.nan], [0.1, 0.2, 0.05]]), None).panels[0].field
    )
    low, high = field.quantity.limits
    assert low == pytest.approx(FLOOR * high)
    assert field.values[0, 0] == low
    assert np.isnan(field.values[0, 2])  # a run that failed stays grey
    assert "at most 0.002" in field.quantity.name


def test_residuals_alike_and_none_at_all_are_drawn(tmp_path):
    for residual in (np.full((2, 3), 1e-3), np.zeros((2, 3)), np.full((2, 3), np.nan)):
        assert plot_run_map(Machine(residual), tmp_path / "map.png").stat().st_size > 0


def test_a_map_on_which_nothing_grows_or_decays_is_drawn(tmp_path):
    """A rotor without damping: every growth rate is 0 to the last digit."""
    rotor = ab.Planar(mass=1.0, stiffness=100.0, unbalance=1e-3)
    found = ab.Scene(rotor=rotor, speed=20.0).map("speed=5:20:4", "rotor.mass=1:2:3")
    assert not found.growth.any()
    assert found.plot(tmp_path / "map.png").stat().st_size > 0
