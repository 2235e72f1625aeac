"""The check of a ring of liquid: its closed form has every damping that the units have."""

from __future__ import annotations

import pytest

import autobalancer as ab


@pytest.mark.parametrize("inner", [0.0, 25.0])
def test_growth_rates_hold_with_damping_inside_the_shaft(inner):
    scene = ab.load("washing_machine_ring").replace({"rotor.internal_damping": inner})
    growth = next(row for row in scene.check().rows if row.quantity.startswith("growth rate"))
    assert growth.holds
    assert growth.error < 1e-8
