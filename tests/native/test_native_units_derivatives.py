"""FMI's own derivatives: of inputs and outputs by time, and of outputs by inputs."""

from __future__ import annotations

import math

import numpy as np
import pytest

pytestmark = pytest.mark.slow

CASES = [
    ("LiquidBalancer", {"frame": "rotor"}),
    ("BallBalancer", {"weights": 3}),
    ("BallBalancer", {"weights": 2, "frame": "fixed"}),
    ("RotorOnSupports", {"planes": 2}),
    ("RotorOnSupports", {"planes": 1, "frame": "fixed"}),
    ("RotorOnSupports", {"kind": "two_support", "stations": 2, "planes": 2}),
    ("RotorOnSupports", {"kind": "two_support", "stations": 2, "planes": 2, "frame": "fixed"}),
    ("Motor", {"points": 3}),
]
TOUCHING = {"weight_radius": 0.0125, "track_offset_xi": 1e-4, "track_offset_eta": 2e-4}
POLYNOMIAL = 5  # outputs are at most cubic in any input but added_mass and angle


def somewhere(fmus, packaging, case, seed: int, spin_up: float, more: dict | None = None):
    """A unit in the middle of a motion, with every input set."""
    unit, options = case
    rng = np.random.default_rng(seed)
    host = packaging.Host(fmus.native(unit, **options))
    start = {"RotorOnSupports": {"internal_damping": 7.0}, "Motor": {"speed0": 40.0}}.get(
        unit, {"inertia_as_force": True}
    )
    if options.get("kind"):
        start = {"support[1].stiffness_x": 3e5}
    if unit == "BallBalancer":
        start |= {f"weight[{k}].speed0": float(k) for k in range(1, options["weights"] + 1)}
    host.begin(start | (more or {}))
    inputs = [n for n, v in host.variables.items() if v.causality == "input"]
    values = {}
    for name in inputs:
        value = float(rng.normal())
        values[name] = {
            "speed": 300.0 + value,
            "acceleration": spin_up,
            "angle": value,
            "x": 1e-3 * value,
            "y": 1e-3 * value,
        }.get(name, abs(value) if "added_mass" in name else value * 10.0 ** name.count("der"))
    host.set(values)
    host.step(1e-3)
    host.set(values)
    return host, inputs


def derivative(host, known: str, seed: float = 1.0) -> np.ndarray:
    outputs = [v.valueReference for v in host.variables.values() if v.causality == "output"]
    found = host.slave.getDirectionalDerivative(outputs, host.references(known), [seed])
    return np.array(found)


def beside(host, known: str, nodes: np.ndarray) -> np.ndarray:
    """Outputs with one input changed."""
    (value,) = host.get(known)
    seen = []
    for node in nodes:
        host.set({known: value + float(node)})
        seen.append(host.outputs())
    host.set({known: value})
    return np.array(seen)


@pytest.mark.parametrize("spin_up", [0.0, 40.0])
@pytest.mark.parametrize("case", CASES, ids=str)
def test_directional_derivatives_are_those_of_the_outputs(fmus, packaging, case, spin_up):
    agree(*somewhere(fmus, packaging, case, 3, spin_up))


@pytest.mark.parametrize("frame", ["rotor", "fixed"])
def test_friction_holds_what_sticks_and_lets_go_of_the_rest(fmus, packaging, frame):
    sizes = {"kind": "two_support", "stations": 2, "planes": 2, "sliders": 3, "frame": frame}
    sliders = {"slider[1].limit_x": 1e6, "slider[2].support": 2.0, "slider[2].limit_y": 0.01}
    sliders |= {"slider[3].limit_x": 0.02, "slider[3].limit_y": 5.0}
    sliders |= {"slider[3].stiffness_x": 1e4, "slider[3].stiffness_y": 1e5}
    agree(*somewhere(fmus, packaging, ("RotorOnSupports", sizes), 3, 40.0, sliders))


@pytest.mark.parametrize("frame", ["rotor", "fixed"])
def test_weights_that_press_on_each_other_answer_together(fmus, packaging, frame):
    """Three packed balls off centre: contacts that last are part of the derivative."""
    packed = {f"weight[{k}].angle0": k * 2.0 * math.asin(0.25) for k in (1, 2, 3)}
    rates = {f"weight[{k}].speed0": 2.0 for k in (1, 2, 3)}
    case = ("BallBalancer", {"weights": 3, "frame": frame})
    # far away a contact would open, where the outputs have a kink
    agree(*somewhere(fmus, packaging, case, 3, 5.0, {**TOUCHING, **packed, **rates}), reach=0.01)


@pytest.mark.parametrize("frame", ["rotor", "fixed"])
def test_weights_that_roll_against_a_resistance_go_on_to_do_so(fmus, packaging, frame):
    """Off centre, where the load depends on all that moves the rotor."""
    more = {"rolling_resistance": 0.02, "track_offset_xi": 1e-4, "track_offset_eta": 2e-4}
    case = ("BallBalancer", {"weights": 2, "frame": frame})
    agree(*somewhere(fmus, packaging, case, 3, 5.0, more), reach=0.01)


def agree(host, inputs: list[str], reach: float = 1.0) -> None:
    """Against the polynomial through the outputs beside; where they are none, one far narrower."""
    for known in inputs:
        smooth = "added_mass" in known or known in ("angle", "x", "y")
        (value,) = host.get(known)
        size = (1e-3 if smooth else 1.0) * max(1.0, abs(value))
        size *= 1e-3 if known in ("x", "y") else reach
        degree = 8 if smooth else POLYNOMIAL
        nodes = np.cos(np.pi * np.arange(degree + 1) / degree)
        seen = beside(host, known, size * nodes)
        slopes = np.polynomial.chebyshev.chebfit(nodes, seen, degree)
        expected = np.array(
            [
                np.polynomial.chebyshev.chebval(0.0, np.polynomial.chebyshev.chebder(c)) / size
                for c in slopes.T
            ]
        )
        rounding = 1e-13 * np.abs(seen).max(axis=0) / size
        found = derivative(host, known)
        scale = 1e-12 * np.abs(expected) + 10.0 * rounding
        assert np.all(np.abs(found - expected) <= scale), known
        assert derivative(host, known, -2.5) == pytest.approx(-2.5 * found, rel=1e-12)
    host.free()


@pytest.mark.parametrize("case", CASES, ids=str)
def test_derivatives_before_the_end_of_initialisation_are_by_parameters_too(fmus, packaging, case):
    """Every parameter that InitialUnknowns lists is a known, as both standards say."""
    unit, options = case
    host = packaging.Host(fmus.native(unit, **options))
    host.slave.setupExperiment(startTime=0.0)
    host.slave.enterInitializationMode()
    listed = {
        dependency.name
        for unknown in host.description.initialUnknowns
        for dependency in unknown.dependencies
        if dependency.causality == "parameter" and dependency.type == "Real"
    }
    before = host.outputs()
    for name in sorted(listed):
        (value,) = host.get(name)
        step = 1e-4 * max(abs(value), 1.0)
        if host.variables[name].min is not None or "above" in host.variables[name].description:
            step = 1e-4 * abs(value)
        seen = beside(host, name, np.array([-step, 0.0, step]))
        found = derivative(host, name)
        assert host.outputs() == before
        if step:
            expected = (seen[2] - seen[0]) / (2.0 * step)
            rounding = (1e-8 * np.abs(seen).max(axis=0) + 1e-13 * np.abs(seen).max()) / step
            assert np.all(np.abs(found - expected) <= 1e-6 * np.abs(expected) + rounding), name
        assert derivative(host, name, 0.0) == pytest.approx(0.0 * found)
    host.free()


@pytest.mark.parametrize("case", CASES[:4], ids=str)
def test_a_derivative_does_not_touch_what_a_step_left(fmus, packaging, case):
    """Outputs of a step's end stay those, with the inputs still those of its start."""
    host, inputs = somewhere(fmus, packaging, case, 3, 10.0)
    host.step(1e-3)
    before = host.outputs()
    derivative(host, inputs[0])
    assert host.outputs() == before
    host.free()


@pytest.mark.parametrize("case", CASES, ids=str)
def test_input_derivatives_are_the_units_own_slopes(fmus, packaging, case):
    """FMI's call and the variables der(...) are two ways to the same bits."""
    seen = []
    for fmi_own_way in (False, True):
        host, inputs = somewhere(fmus, packaging, case, 4, 0.0)
        slopes = [name for name in inputs if name.startswith("der(")]
        values = {name: 0.25 * k for k, name in enumerate(slopes)}
        if "speed" in inputs:
            values["acceleration"] = 12.0
        if fmi_own_way:
            references, orders = [], []
            for name in values:
                inner = "speed" if name == "acceleration" else name[4:-1].split(",")[0]
                references.append(host.variables[inner].valueReference)
                orders.append(int(name[4:-1].split(",")[1]) if "," in name else 1)
            host.slave.setRealInputDerivatives(references, orders, list(values.values()))
        else:
            host.set(values)
        host.step(1e-3)
        seen.append(host.outputs())
        host.free()
    assert seen[1] == seen[0]


@pytest.mark.parametrize("case", CASES, ids=str)
def test_output_derivatives_are_the_exact_slopes(fmus, packaging, case):
    """Signals by der(...), displacements by the velocities."""
    host, inputs = somewhere(fmus, packaging, case, 6, 0.0)
    host.set({name: 0.0 for name in inputs if name.startswith("der(acc")})
    host.step(1e-3)
    rates = {"x": "vx", "y": "vy", "angle": "speed", "speed": "acceleration"}
    outputs = [name for name, v in host.variables.items() if v.causality == "output"]
    slopes = {n: rates.get(n, n.replace(".angle", ".speed")) for n in outputs}
    slopes = {n: s if s != n else f"der({n})" for n, s in slopes.items()}
    known = {n: s for n, s in slopes.items() if s in host.variables}
    assert known
    for name, slope in known.items():
        found = host.slave.getRealOutputDerivatives(host.references(name), [1])
        assert found == host.get(slope), name
    host.free()


@pytest.mark.parametrize(
    ("case", "rates"),
    [
        (("RotorOnSupports", {}), ["vx", "vy"]),
        (("RotorOnSupports", {"frame": "fixed"}), ["vx", "vy"]),
        (CASES[1], ["weight[1].speed", "weight[3].speed"]),
        (CASES[-1], ["drive_torque", "power"]),
    ],
    ids=str,
)
def test_output_derivatives_are_those_that_a_short_step_shows(fmus, packaging, case, rates):
    """What is not known, as the spread's, is 0."""
    more = {"gravity_x": 1.5, "gravity_y": -9.81} if case[0] == "RotorOnSupports" else {}
    host, _ = somewhere(fmus, packaging, case, 6, 0.0, more)
    found = np.array(host.slave.getRealOutputDerivatives(host.references(*rates), [1] * len(rates)))
    others = ("spread", "added_mass", "der(F_xi)", "der(plane[1].a_xi)")
    none = host.references(*(name for name in others if name in host.variables))
    assert host.slave.getRealOutputDerivatives(none, [1] * len(none)) == [0.0] * len(none)
    before = np.array(host.get(*rates))
    host.step(1e-6)
    assert np.all(found != 0.0)
    assert (np.array(host.get(*rates)) - before) / 1e-6 == pytest.approx(found, rel=1e-3)
    host.free()


REFUSED = [  # the call, references by name and what else it takes
    ("getDirectionalDerivative", ["F_xi"], ["mass"], [1.0], "knowns must be inputs"),
    ("getDirectionalDerivative", ["speed"], ["speed"], [1.0], "unknowns must be"),
    ("setRealInputDerivatives", ["a_xi"], [4], [0.0], "derivative must be 1 to 3"),
    ("setRealInputDerivatives", ["a_xi"], [0], [0.0], "derivative must be 1 to 3"),
    ("setRealInputDerivatives", ["a_xi"], [1], [math.nan], "derivative must be a finite number"),
    ("setRealInputDerivatives", ["der(a_xi)"], [1], [0.0], "is a derivative itself"),
    ("setRealInputDerivatives", ["mass"], [1], [0.0], "value reference 0: is no input"),
    ("setRealInputDerivatives", ["F_xi"], [1], [0.0], "is no input"),
    ("getRealOutputDerivatives", ["F_xi"], [2], "the order of an output's derivative must be 1"),
    ("getRealOutputDerivatives", ["mass"], [1], "value reference 0: is no output"),
    ("getRealOutputDerivatives", ["a_xi"], [1], "is no output"),
]


@pytest.mark.parametrize("case", REFUSED, ids=lambda case: f"{case[0]} {case[-1]}")
def test_wrong_derivatives_are_refused_and_change_nothing(fmus, packaging, case):
    function, *arguments, reason = case
    host, _ = somewhere(fmus, packaging, CASES[1], 1, 0.0)
    before = host.outputs()
    taken = [[host.references(x)[0] if isinstance(x, str) else x for x in one] for one in arguments]
    assert reason in host.refused(lambda: getattr(host.slave, function)(*taken))
    assert host.outputs() == before
    host.free()


@pytest.mark.parametrize("knowns", [("mass", "plane[1].F_xi"), ("plane[1].F_xi", "mass")])
def test_a_parameter_among_the_knowns_leaves_the_others_as_they_are(fmus, packaging, knowns):
    """Before the end of initialisation a = F/m: its change is the sum of the changes by each."""
    host = packaging.Host(fmus.native("RotorOnSupports", planes=1))
    host.slave.setupExperiment()
    host.slave.enterInitializationMode()
    mass, force = 2.0, 3.0
    host.set({"mass": mass, "unbalance": 0.0, "plane[1].F_xi": force})
    outputs = host.references("plane[1].a_xi")
    (found,) = host.slave.getDirectionalDerivative(outputs, host.references(*knowns), [1.0, 1.0])
    assert found == pytest.approx(-force / mass**2 + 1.0 / mass, rel=1e-9)
