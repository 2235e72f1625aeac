"""Stability from the co-simulated units against exact roots, linearised models, and time runs."""

from __future__ import annotations

import math

import numpy as np
import pytest

from autobalancer.harness import load_scene
from autobalancer.harness.stability.revolution import Revolution
from autobalancer.models.papers.window import LiquidWindow
from tests.floquet import multipliers, units_multipliers

pytestmark = pytest.mark.slow

BALANCED = [2.0 * math.pi / 3.0, 4.0 * math.pi / 3.0]


def balls(**coupling):
    """The two-ball scene at rest where it balances, its loop converged."""
    keys = {f"coupling.{key}": value for key, value in {"corrections": None, **coupling}.items()}
    return load_scene("two_balls").replace({"weights.angles": BALANCED, **keys})


def same_spectrum(found, expected, tolerance: float) -> None:
    """Every expected multiplier is found once, to an absolute tolerance."""
    remaining = list(found)
    assert len(remaining) == len(expected)
    for value in expected:
        nearest = min(remaining, key=lambda f: abs(f - value))
        assert abs(nearest - value) <= tolerance, (value, found)
        remaining.remove(nearest)


@pytest.mark.parametrize("fraction", [0.5, 0.97, 1.0, 1.1])
@pytest.mark.parametrize(
    ("name", "steps", "tolerance"),
    [("liquid_disc", 40, 1e-9), ("liquid_closed", 4, 1e-9), ("liquid_heavy_force", 80, 1e-5)],
)
def test_multipliers_of_a_liquid_are_those_of_the_exact_roots(name, steps, tolerance, fraction):
    scene = load_scene(name)
    window = LiquidWindow.of(scene.assembly())
    speed = fraction * window.upper
    roots = np.array(window.roots(speed))
    roots = np.concatenate([roots, roots.conj()])  # of z, and of its conjugate
    with Revolution(scene, steps=steps) as revolution:
        found = units_multipliers(revolution, speed, np.zeros(len(revolution.states)))
    same_spectrum(found, np.exp(roots * 2.0 * math.pi / speed), tolerance)


def test_multipliers_of_separate_fmus_converge_with_order_4():
    scene = balls()
    expected = np.abs(multipliers(scene.assembly(), [6.0])[0]).max()
    errors = []
    for steps in (20, 40, 80):
        with Revolution(scene, steps=steps, separate=True) as revolution:
            found = units_multipliers(revolution, 6.0, revolution.first)
        errors.append(abs(np.abs(found[0]) - expected))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.6)
    assert errors[2] < 1e-6


@pytest.mark.parametrize(
    "changes",
    [
        {"operation.run_up": {"from": 1.0, "to": 6.0, "seconds": 10.0}},
        {"coupling.tolerance": 1e-3},
    ],
    ids=["run-up", "tolerance"],
)
def test_the_map_is_of_constant_speed_and_whole_revolutions_whatever_the_scene_runs(changes):
    scene = balls()
    spectra = []
    for each in (scene, scene.replace(changes)):
        with Revolution(each, steps=20) as revolution:
            spectra.append(units_multipliers(revolution, 6.0, revolution.first))
    assert spectra[0] == pytest.approx(spectra[1], abs=1e-12)


@pytest.mark.parametrize("name", ["two_balls", "three_mass_shaft", "liquid_heavy_force"])
def test_one_file_has_the_map_of_separate_fmus(name):
    scene = load_scene(name)
    speed = scene.profile().end
    maps = []
    for separate in (False, True):
        with Revolution(scene, steps=320, separate=separate) as revolution:
            maps.append(revolution.monodromy(revolution.first, speed))
    np.testing.assert_allclose(*maps, rtol=0.0, atol=1e-6 * np.abs(maps[0]).max())
