"""Units with quintic signals (`order = 5`): exact second derivatives, and what they refuse."""

from __future__ import annotations

import fmpy
import numpy as np
import pytest

from autobalancer.fmus.variables import derivative

UNITS = [
    ("RotorOnSupports", {"planes": 2}),
    ("RotorOnSupports", {"frame": "fixed"}),
    ("RotorOnSupports", {"kind": "two_support", "stations": 2, "planes": 2}),
    ("RotorOnSupports", {"kind": "flexible", "stations": 4, "planes": 1}),
    ("BallBalancer", {"weights": 3}),
    ("BallBalancer", {"weights": 2, "frame": "fixed"}),
    ("LiquidBalancer", {}),
]
ASIDE = {"track_offset_xi": 1e-3, "track_offset_eta": -5e-4}
ANISOTROPIC = {"stiffness_y": 5e4, "damping_y": 90.0, "gravity_y": -9.81, "vx0": 0.1, "y0": 1e-3}


def moving(native_probe, unit: str, options: dict, spin: tuple[float, ...] = ()):
    """A unit whose inputs are quintics of about a revolution, and its layout.

    `spin`: the rotor's angular acceleration and its derivatives.
    """
    made = native_probe(unit, order=5, **options)
    random = np.random.default_rng(7)
    for name, value in {**ANISOTROPIC, **ASIDE}.items():
        if name in made.layout.index:
            made.put(name, value)
    if "inertia_as_force" in made.layout.boolean_index:
        made.put("inertia_as_force", unit == "LiquidBalancer")
    made.exit_initialization_mode()
    for variable in made.layout.reals[made.layout.inputs]:
        if variable.name.endswith("added_mass"):
            made.put(variable.name, 0.3)
        elif any(axis in variable.name for axis in ("_xi", "_eta", "_x", "_y")):
            order = int(variable.name[-2]) if "," in variable.name else "der" in variable.name
            made.put(variable.name, float(random.normal()) * 200.0**order)
    if "acceleration" in made.layout.index:
        made.put("speed", 250.0)
        names = ["acceleration", *(derivative("acceleration", k) for k in (1, 2, 3))]
        for name, value in zip(names, spin, strict=False):
            made.put(name, value)
    return made


@pytest.mark.parametrize("spin", [(), (3e4,), (3e4, -2e7, 3e10, 1e13)])
@pytest.mark.parametrize(("unit", "options"), UNITS)
def test_second_derivatives_are_those_of_the_slopes_along_the_motion(
    native_probe, unit, options, spin
):
    begun = moving(native_probe, unit, options, spin)
    state, outputs = begun.saved(), begun.layout.reals[begun.layout.computed]
    names = [v.derivative_of for v in outputs if v.name.endswith(",2)")]
    signals = [name.removeprefix("der(").removesuffix(")") for name in names]
    assert signals

    def look_at(t: float, order: int) -> np.ndarray:
        begun.restore(state)
        assert begun.do_step(0.0, t)
        return np.array(begun.look(*(derivative(name, order) for name in signals)))

    t, h = 5e-4, 2e-5
    for order in (1, 2):
        before, after = (look_at(t + k * h, order - 1) for k in (-1, 1))
        earlier, later = (look_at(t + k * h, order - 1) for k in (-2, 2))
        expected = (earlier - 8.0 * before + 8.0 * after - later) / (12.0 * h)
        size = np.abs(expected).max()
        assert look_at(t, order) == pytest.approx(expected, rel=0.0, abs=1e-5 * size)


@pytest.mark.parametrize("given", [{"weight_radius": 0.01}, {"rolling_resistance": 0.01}])
def test_weights_that_meet_or_stick_are_refused(host_of, given):
    host = host_of("BallBalancer", order=5)
    with pytest.raises(Exception, match="fmi2ExitInitializationMode"):
        host.begin(given)


def test_such_units_declare_no_directional_derivatives(fmus):
    for order, expected in ((3, True), (5, False)):
        path = fmus.native("BallBalancer", order=order)
        described = fmpy.read_model_description(str(path)).coSimulation
        assert described.providesDirectionalDerivative is expected
