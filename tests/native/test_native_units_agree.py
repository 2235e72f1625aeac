"""Native and Python units: the same variables, the same start values, the same motion."""

from __future__ import annotations

import math
import re
from functools import partial
from itertools import product
from typing import Any

import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave

from autobalancer.fmus.native.build.tokens import signed

pytestmark = pytest.mark.slow

CASES: list[tuple[str, dict[str, Any]]] = [
    ("LiquidBalancer", {}),
    ("LiquidBalancer", {"frame": "fixed"}),
    ("RingBalancer", {}),
    ("RingBalancer", {"frame": "fixed"}),
    ("BallBalancer", {"weights": 1}),
    ("BallBalancer", {"weights": 2}),
    ("BallBalancer", {"weights": 7, "frame": "fixed"}),
    ("RotorOnSupports", {"planes": 1}),
    ("RotorOnSupports", {"planes": 3, "frame": "fixed"}),
    ("RotorOnSupports", {"kind": "two_support", "stations": 2, "planes": 2, "unbalances": 2}),
    ("RotorOnSupports", {"kind": "two_support", "stations": 2, "planes": 1, "frame": "fixed"}),
    ("RotorOnSupports", {"kind": "flexible", "stations": 4, "planes": 2, "unbalances": 2}),
    (
        "RotorOnSupports",
        {"kind": "flexible", "stations": 5, "planes": 2, "shaft": "compliance", "frame": "fixed"},
    ),
    ("RotorOnSupports", {"kind": "matrices", "stations": 2, "planes": 3, "unbalances": 2}),
    ("RotorOnSupports", {"kind": "matrices", "stations": 3, "supports": 2, "feet": 3}),
]
NATIVE: list[tuple[str, dict[str, Any]]] = [  # without a Python unit
    ("Motor", {"points": 4}),
    ("RotorOnSupports", {"planes": 2, "sliders": 3}),
    ("RotorOnSupports", {"kind": "two_support", "stations": 2, "planes": 2, "sliders": 3}),
    (
        "RotorOnSupports",
        {"kind": "flexible", "stations": 4, "planes": 1, "sliders": 3, "frame": "fixed"},
    ),
]
STEPS, CONSTANT_SPEED = 45, 30  # in all, and the first of them


def ids(case: tuple[str, dict]) -> str:
    return "-".join([case[0], *map(str, case[1].values())])


def drawn(rng, name: str, k: int) -> float:
    """A value for an input in step k: every input moves, the drive runs up at the end."""
    value = float(rng.normal())
    if "added_mass" in name:
        return 0.2 + 0.05 * (k // 20)
    if name == "speed":
        return 300.0 + value
    if name == "acceleration":
        return 20.0 * value * (k >= CONSTANT_SPEED and k % 4 == 1)
    if name.startswith("der(acceleration"):  # Python units know a constant one alone
        return 0.0
    if name in ("x", "y"):
        return 1e-4 * value
    return value * 10.0 ** name.count("der")


def parameters(rng, layout, anisotropic: bool) -> dict[str, float | bool]:
    """Start values a little changed, places on the shaft left."""
    values: dict[str, float | bool] = {}
    for v in layout.reals[layout.parameters]:
        if "position" in v.name or v.name.endswith(".z") or "compliance" in v.name:
            continue
        if v.native or v.name == "com":
            continue
        start = float(v.start)
        factor = 1.0 + 0.2 * float(rng.random()) * (
            anisotropic or not v.name.endswith(("_x", "_y"))
        )
        zero = {"m": 1e-5, "m/s": 1e-3, "m/s2": 9.0, "rad": 0.3, "rad/s": 5.0, "N.s/m": 0.3}
        size = zero.get(v.unit, 0.0)
        values[v.name] = start * factor if start else size * float(rng.random())
    return values


def motion(packaging, path, layout, seed: int) -> np.ndarray:
    """Outputs that both have before and after every step of a run of random inputs."""
    rng = np.random.default_rng(seed)
    host = packaging.Host(path)
    values = parameters(rng, layout, seed % 2 == 0)
    if layout.booleans:
        values["inertia_as_force"] = seed % 3 == 0
    host.begin(values)
    names = [v.name for v in layout.reals[layout.inputs]]
    shared = [v.name for v in layout.reals[layout.computed.start :] if not v.native]
    seen = [host.get(*shared)]
    for k in range(STEPS):
        host.set({name: drawn(rng, name, k) for name in names})
        seen.append(host.get(*shared))
        host.step(1e-3 * (1 + k % 3))
        seen.append(host.get(*shared))
    host.free()
    return np.array(seen)


@pytest.mark.parametrize("case", [CASES[k] for k in (1, 4, 6, 7, -1)], ids=ids)
@pytest.mark.parametrize("seed", [2, 3])
def test_the_same_motion_to_1e_12_of_a_signals_range(fmus, packaging, case, seed):
    """At changing speed the errors of Python's rotor show, and those of Python's weights.

    Shafts, whose jerk rounding moves by more: `tests/fmus/test_rotor.py`, against SciPy.
    """
    unit, options = case
    layout = fmus.layout(unit, **options)
    expected, found = (
        motion(packaging, path, layout, seed)
        for path in (fmus.python(unit, **options), fmus.native(unit, **options))
    )
    # a signal that hardly moves has the rounding of its size
    size = np.maximum(np.ptp(expected, axis=0), 1e-3 * np.abs(expected).max(axis=0))
    away, first = np.abs(found - expected), 2 * CONSTANT_SPEED + 1
    rule = 1e-4 if unit == "BallBalancer" else 1e-12  # of order 4, see below
    assert np.all(away[:first] <= rule * size)
    assert np.all(away <= (1e-7 if unit == "RotorOnSupports" else rule) * size)


@pytest.mark.parametrize("drag", [0.05, 5.0])
def test_pythons_weights_come_nearer_to_the_native_ones_at_order_four(fmus, packaging, drag):
    """The unit in C is right to rounding; Python's has a rule of order 4."""
    sizes, time = {"weights": 2}, 0.02
    start = {"drag": drag, "weight[1].speed0": 5.0, "weight[2].speed0": -3.0}
    drive = {"speed": 300.0, "acceleration": 40.0, "a_xi": 30.0, "a_eta": -20.0, "der(a_xi)": 5e3}
    names = [f"weight[{k}].{name}" for k in (1, 2) for name in ("angle", "speed")]

    def end(path, steps):
        """One cubic over the whole time, told anew in every step."""
        host = packaging.Host(path).begin(start | drive)
        for k in range(steps):
            t = time * k / steps
            host.set({"speed": 300.0 + 40.0 * t, "a_xi": 30.0 + 5e3 * t})
            host.step(time / steps)
        found = np.array(host.get(*names))
        host.free()
        return found

    native = end(fmus.native("BallBalancer", **sizes), 4)
    assert end(fmus.native("BallBalancer", **sizes), 64) == pytest.approx(native, rel=1e-11)
    python = fmus.python("BallBalancer", **sizes)
    errors = [abs(end(python, n) - native).max() for n in (16, 64, 256)]
    assert errors[0] > 1e-9
    assert errors[0] / errors[1] > 50.0
    assert errors[1] / errors[2] > 50.0


@pytest.mark.parametrize("case", [*CASES, *NATIVE], ids=ids)
def test_variables_and_start_values_stand_in_the_library(fmus, packaging, case):
    """Name, unit and limit of every Real, as the library has them in its messages."""
    unit, options = case
    host = packaging.Host(fmus.native(unit, **options))
    for k, v in enumerate(fmus.layout(unit, **options).reals):
        said = host.refused(partial(host.slave.setReal, [k], [math.nan]))
        own = f"{v.name}: outputs cannot" if v.causality == "output" else v.problem(math.nan)
        assert own in said
    for v in host.description.modelVariables:
        if v.type == "Real" and v.start is not None:
            tolerance = 1e-13 if v.name.startswith("compliance") else 0.0
            assert host.get(v.name)[0] == pytest.approx(float(v.start), rel=tolerance, abs=0.0)
        elif v.type == "Boolean":
            found = host.slave.getBoolean([v.valueReference])[0]
            assert bool(found) == (v.start == "true")
    host.free()


def test_one_library_serves_every_size(fmus):
    shapes = [{}, {"kind": "two_support", "stations": 2}]
    shapes += [
        {"kind": "flexible", "stations": n, "shaft": shaft}
        for n, shaft in product((2, 3, 8, 20), ("uniform", "compliance"))
    ]
    sizes = [("BallBalancer", {"weights": n}) for n in (*range(1, 13), 100)]
    for shape, planes, unbalances in product(shapes, range(1, 5), (1, 2, 5)):
        several = {"unbalances": unbalances} if shape else {}
        sizes.append(("RotorOnSupports", {**shape, "planes": planes, **several}))
    for (unit, options), frame in product(sizes, ("rotor", "fixed")):
        slave = FMU2Slave(
            guid=fmus.token(unit, frame=frame, **options),
            unzipDirectory=str(fmus.library.parent),
            modelIdentifier="autobalancer",
            instanceName="unit",
            libraryPath=str(fmus.library),
        )
        slave.instantiate()
        slave.fmi2FreeInstance(slave.component)  # the library stays loaded


@pytest.mark.parametrize(
    ("token", "reason"),
    [
        ("", ""),
        ("{1234-5678}", ""),
        ("Pump/frame=rotor/", "a unit that this library does not"),
        ("BallBalancer/frame=rotor/weights=0/", "weights: must be a whole number from 1 to 10000"),
        ("BallBalancer/frame=rotor/weights=99999999999999999999/", "weights: must be a whole"),
        ("BallBalancer/frame=rotor/wheels=2/", "an option that this library does not know, wheels"),
        ("BallBalancer/frame=rotor/weights=2", "a unit that this library does not"),
        ("RotorOnSupports/frame=rotor/kind=planar/planes=1/stations=3/", "does not exist"),
        ("RotorOnSupports/frame=rotor/kind=flexible/planes=1/shaft=uniform/stations=99999/unbalances"
         "=99999/", "stations: must be a whole number from 1 to 1000"),
    ],
)  # fmt: skip
def test_a_token_of_nobody_is_refused_with_a_reason(fmus, packaging, rewritten, token, reason):
    assert refusal(fmus, packaging, rewritten, token, "it is not as this library")
    if reason:
        assert refusal(fmus, packaging, rewritten, signed(token, packaging.STAMP), reason)


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("weights=2", "weights=3", "it is not as this library"),
        ("-{stamp}", "-{near}", "built from other sources"),
        ("-{stamp}", "-{stamp}0", "it is not as this library"),
    ],
)
def test_another_token_is_refused_with_what_was_expected(
    fmus, packaging, rewritten, old, new, reason
):
    token = fmus.token("BallBalancer")
    near = packaging.STAMP[:-1] + ("f" if packaging.STAMP[-1] != "f" else "e")
    old, new = (text.format(stamp=packaging.STAMP, near=near) for text in (old, new))
    assert old in token
    text = refusal(fmus, packaging, rewritten, token.replace(old, new), reason)
    assert re.search(rf"; expected at its end '[0-9a-f]{{16}}-{packaging.STAMP}'", text)


def refusal(fmus, packaging, rewritten, token: str, reason: str) -> str:
    """The reason logged by an FMU with another GUID."""
    source = fmus.native("BallBalancer")
    own = fmus.token("BallBalancer").encode()
    path = rewritten(
        source,
        source.with_name("other.fmu"),
        lambda name, data: (name, data.replace(own, token.encode())),
    )
    text = packaging.refusal(path)
    assert text.startswith("unit: instantiation failed: identity '")
    assert re.search(reason, text)
    return text
