"""The compiled reference of colliding weights against the one by SciPy, and against itself."""

from __future__ import annotations

import numpy as np
import pytest

from autobalancer.harness import Scene
from autobalancer.harness.scene.begin import motion_at_start
from autobalancer.models.monolith import simulate
from autobalancer.models.reference.trajectory import differences
from tests.studies.truth import compiled
from tests.studies.truth.draw import draw


def described(family: str, number: int):
    scene = Scene.from_document(draw(family, 1, number))
    return scene.assembly(), scene.operation.drive(), motion_at_start(scene)


@pytest.mark.parametrize(
    ("family", "number"),
    [("impacts", 0), ("impacts", 1), ("harsh", 1), ("changing", 1), ("unequal", 8)],
)
def test_the_compiled_reference_agrees_with_the_one_by_scipy(family, number):
    assembly, drive, start = described(family, number)
    assert compiled.covers(assembly, drive)
    turn = 2.0 * np.pi / drive.top
    times = np.linspace(0.0, 3.0 * turn, 50)
    slow = simulate(assembly, drive, times, initial=start, method="DOP853", rtol=1e-11)
    for method in compiled.METHODS:
        fast = compiled.simulate(assembly, drive, times, initial=start, method=method)
        apart = differences(slow, fast)
        # which bounce is the last differs, and with it rates at that moment
        assert max(apart[n] for n in apart if n.endswith((".x", ".y", ".angle"))) < 1e-7


@pytest.mark.parametrize("number", [1, 6, 9, 20])
def test_its_two_methods_agree_over_many_impacts(number):
    assembly, drive, start = described("harsh", number)
    times = np.linspace(0.0, 20.0 * 2.0 * np.pi / drive.top, 200)
    _, own = compiled.reference(assembly, drive, times, initial=start)
    assert own < 1e-7


def test_it_keeps_to_machines_whose_weights_collide():
    for family, number in (("planar", 0), ("motor", 0), ("sticking", 0)):
        scene = Scene.from_document(draw(family, 1, number))
        assert not compiled.covers(scene.assembly(), scene.operation.drive())
