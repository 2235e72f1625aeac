"""Whole scenes: what the master couples is the same whichever units it couples."""

from __future__ import annotations

import itertools
import math
import os
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from autobalancer.harness import Result, Scene, bundled_scenes, cosimulate, load_scene
from autobalancer.harness.errors import SimulationError, UserError
from autobalancer.harness.scene.file import find, read

pytestmark = pytest.mark.slow

# AUTOBALANCER_RANDOM_SCENES=300 draws as many
RANDOM_SCENES = int(os.environ.get("AUTOBALANCER_RANDOM_SCENES", "20"))
SENSITIVE = 216  # pendulums that turn over: a rounding grows three thousand times
PLACES = ("position", "stations", "at", "supports", "count", "kind", "compliance", "steps_per_rev")


def compared(scene: Scene) -> None:
    """Run a scene on both kinds of units: the same signals, or the same reason for the end.

    Signals agree to 1e-12 of their range.  A motion that amplifies roundings may differ by twice
    what one rounding more or less in its masses does to the run on Python units.
    """
    scene = scene.replace({"coupling.order": 3})  # Python units have no other
    results: list[Result | str] = []
    for runtime in ("python", "native"):
        try:
            results.append(cosimulate(scene.replace({"coupling.units": runtime}), separate=True))
        except SimulationError as error:
            results.append(str(error))
    expected, found = results
    if isinstance(expected, str) or isinstance(found, str):
        assert found == expected
        return
    assert np.array_equal(found.time, expected.time)
    away = {name: d for name, d in differences(found, expected).items() if d > 1e-12}
    rounded = roundings(scene, expected)
    while away:
        rounding = next(rounded, None)
        assert rounding, away
        away = {name: d for name, d in away.items() if d > 2 * rounding[name]}


def roundings(scene: Scene, expected: Result) -> Iterator[dict[str, float]]:
    """What one rounding more or less in every mass, and in a shaft, does to the Python units."""
    paths = ["rotor.masses" if hasattr(scene.rotor, "masses") else "rotor.mass"]
    paths += [f"{b.name}.{'mass' if hasattr(b, 'mass') else 'density'}" for b in scene.balancer]
    parts: list[Any] = [scene.rotor, *scene.balancer]
    if hasattr(scene.rotor, "bending_stiffness"):
        paths, parts = [*paths, "rotor.bending_stiffness"], [*parts, scene.rotor]
    values = [getattr(part, path.split(".")[1]) for part, path in zip(parts, paths, strict=True)]
    for ends in itertools.product((-math.inf, math.inf), repeat=len(paths)):
        changed = [
            np.nextafter(value, end).tolist() for value, end in zip(values, ends, strict=True)
        ]
        python = {
            "coupling.units": "python",
            "coupling.order": 3,
            **dict(zip(paths, changed, strict=True)),
        }
        yield differences(cosimulate(scene.replace(python)), expected)


def differences(one: Result, other: Result) -> dict[str, float]:
    """Largest difference of each signal, in parts of its range."""
    return {
        name: np.abs(one[name] - values).max() / max(np.ptp(values), 1e-3 * np.abs(values).max())
        for name, values in other.signals.items()
    }


SHARED = [name for name in bundled_scenes() if not load_scene(name).native_alone]


@pytest.mark.parametrize("name", SHARED)
def test_a_scene_moves_alike_on_native_and_python_units(name):
    """Over 20 revolutions."""
    compared(load_scene(name).replace({"run.revolutions": 20}))


def shaken(rng: np.random.Generator, value: Any, key: str = "") -> Any:
    """A part of a scene's document with its numbers changed by up to a sixth, places left."""
    if isinstance(value, dict):
        return {k: v if k in PLACES else shaken(rng, v, k) for k, v in value.items()}
    if isinstance(value, list):
        factor = None if key in ("angles", "speeds") else float(rng.uniform(0.85, 1.17))
        return [v * factor if factor and isinstance(v, float) else shaken(rng, v) for v in value]
    if isinstance(value, float):
        return value * float(rng.uniform(0.85, 1.17))
    return value


def random_scene(seed: int) -> Scene:
    """A bundled scene with other masses, stiffnesses, angles and speeds, for 20 revolutions."""
    rng = np.random.default_rng(seed)
    while True:
        name = str(rng.choice(SHARED))
        document = read(find(name))
        for part in ("rotor", "balancer", "operation"):
            if part in document:
                document[part] = shaken(rng, document[part])
        document.pop("check", None)
        document.setdefault("run", {})["revolutions"] = 20
        try:
            return Scene.from_document(document, path=None, label=f"{name}, seed {seed}")
        except UserError:
            continue  # what does not fit together, such as weights too large for their track


@pytest.mark.parametrize("seed", sorted({*range(RANDOM_SCENES), SENSITIVE}))
def test_random_scenes_move_alike(seed):
    compared(random_scene(seed))
