"""Native and Python units: the same variables, the same start values, the same motion."""

from __future__ import annotations

import math
import re
from functools import partial
from typing import Any

import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave

from autobalancer.fmus.native.build.layout import signed

pytestmark = pytest.mark.slow

CASES: list[tuple[str, dict[str, Any]]] = [
    ("LiquidBalancer", {}),
    ("LiquidBalancer", {"frame": "fixed"}),
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
]
NATIVE: list[tuple[str, dict[str, Any]]] = [  # without a Python unit
    ("Motor", {"points": 4}),
    ("LiquidBalancer", {"order": 5}),
    ("BallBalancer", {"weights": 2, "order": 5}),
    ("BallBalancer", {"weights": 3, "order": 5, "frame": "fixed"}),
    ("RotorOnSupports", {"planes": 1, "order": 5}),
    ("RotorOnSupports", {"planes": 2, "order": 5, "frame": "fixed"}),
    ("RotorOnSupports", {"kind": "two_support", "stations": 2, "planes": 3, "order": 5}),
    ("RotorOnSupports", {"kind": "flexible", "stations": 4, "planes": 2, "order": 5}),
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


def motion(packaging, path, layout, seed: int, changes: dict | None = None) -> np.ndarray:
    """Outputs that both have before and after every step of a run of random inputs."""
    rng = np.random.default_rng(seed)
    host = packaging.Host(path)
    values = parameters(rng, layout, seed % 2 == 0) | (changes or {})
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


@pytest.mark.parametrize("case", CASES, ids=ids)
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_same_motion_to_1e_12_of_a_signals_range(fmus, packaging, case, seed):
    """Where rounding itself moves a signal more (a stiff shaft's jerk), it is the measure.

    Python's rotor keeps 1e-10 of its displacements at changing speed, C's errs by rounding: see
    `test_steps_at_changing_speed_are_those_of_python_in_many_parts`.
    """
    unit, options = case
    layout = fmus.layout(unit, **options)
    expected = motion(packaging, fmus.python(unit, **options), layout, seed)
    found = motion(packaging, fmus.native(unit, **options), layout, seed)
    # a signal that hardly moves has the rounding of its size
    size = np.maximum(np.ptp(expected, axis=0), 1e-3 * np.abs(expected).max(axis=0))
    if unit == "RotorOnSupports":
        last = slice(2 * CONSTANT_SPEED + 1, None)
        assert np.all(np.abs(found[last] - expected[last]).max(axis=0) <= 1e-7 * size)
        found, expected = (signals[: last.start] for signals in (found, expected))
    away, allowed = np.abs(found - expected).max(axis=0), 1e-12 * size
    if options.get("kind") == "flexible" and np.any(away > allowed):
        # one digit more in the last place of the masses
        masses = [f"station[{j}].mass" for j in (1, 2, 3)]
        values = parameters(np.random.default_rng(seed), layout, seed % 2 == 0)
        nearby = {name: math.nextafter(values[name], math.inf) for name in masses}
        moved = motion(packaging, fmus.python(unit, **options), layout, seed, nearby)
        moved = moved[: last.start]
        allowed = np.maximum(allowed, 30.0 * np.abs(moved - expected).max(axis=0))
        # hundreds of parts of a step at changing speed each add the rounding of a solution
        assert np.all(allowed < 1e-9 * size)
    assert np.all(away <= allowed)


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


def instantiated(library, token: str) -> bool:
    """Whether the library takes a token."""
    slave = FMU2Slave(
        guid=token,
        unzipDirectory=str(library.parent),
        modelIdentifier="autobalancer",
        instanceName="unit",
        libraryPath=str(library),
    )
    try:
        slave.instantiate()
    except Exception:
        return False
    slave.fmi2FreeInstance(slave.component)  # the library stays loaded
    return True


def test_one_library_serves_every_size(fmus):
    taken = []
    for planes in range(1, 5):
        for frame in ("rotor", "fixed"):
            taken.append(fmus.token("RotorOnSupports", planes=planes, frame=frame))
            for unbalances in (1, 2, 5):
                sizes = {"planes": planes, "unbalances": unbalances, "frame": frame}
                taken.append(fmus.token("RotorOnSupports", kind="two_support", stations=2, **sizes))
                taken += [
                    fmus.token("RotorOnSupports", kind="flexible", stations=n, shaft=shaft, **sizes)
                    for n in (2, 3, 8, 20)
                    for shaft in ("uniform", "compliance")
                ]
    taken += [fmus.token("BallBalancer", weights=n) for n in (*range(1, 13), 100)]
    assert all(instantiated(fmus.library, token) for token in taken)


@pytest.mark.parametrize(
    ("token", "reason"),
    [
        ("", ""),
        ("{1234-5678}", ""),
        ("Pump/frame=rotor/", "a unit that this library does not"),
        ("BallBalancer/frame=rotor/weights=0/", "an option or a size that this library"),
        ("BallBalancer/frame=rotor/weights=99999999999999999999/", "an option or a size"),
        ("BallBalancer/frame=rotor/wheels=2/", "an option or a size"),
        ("BallBalancer/frame=rotor/weights=2", "a unit that this library does not"),
        ("RotorOnSupports/frame=rotor/kind=planar/planes=1/stations=3/", "does not exist"),
        ("RotorOnSupports/frame=rotor/kind=flexible/planes=1/shaft=uniform/stations=99999/unbalances"
         "=99999/", "does not exist|not enough memory"),
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
