"""The ring of liquid as a unit and in one file: both ways of turning, and its warnings."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from autobalancer.harness import load_scene

ODD = ("F_eta", "wave_eta", "wave_speed_eta", "moment_eta")  # what changes its sign in a mirror


def turned(host, way: float):
    """Outputs after a run-up in which speed and motion are mirrored where `way` is -1."""
    host.begin({"viscosity": 1e-3, "wave_damping": 0.1})
    host.set({"a_xi": 3.0, "a_eta": 2.0 * way, "acceleration": 500.0 * way})
    for _ in range(20):
        time = host.time
        angle = 100.0 * time + 250.0 * time**2
        host.set({"speed": way * (100.0 + 500.0 * time), "angle": way * angle})
        host.step(1e-3)
    return {n: host.get(n)[0] for n, v in host.variables.items() if v.causality == "output"}


@pytest.mark.parametrize("backend", ["native", "python"])
def test_a_ring_that_turns_backwards_is_the_mirror_image(fmus, packaging, backend):
    """The film at the wall is that of the speed either way, while the speed changes too."""
    path = getattr(fmus, backend)("RingBalancer")
    forwards, backwards = (turned(packaging.Host(path), way) for way in (1.0, -1.0))
    for name, value in forwards.items():
        is_odd = name.removeprefix("der(").rstrip(")") in ODD
        assert backwards[name] == pytest.approx(-value if is_odd else value, rel=1e-12)


@pytest.mark.parametrize("backend", ["native", "python"])
@pytest.mark.parametrize("wrong", [{"speed": 1e12}, {"wave_damping": 1e15}])
def test_a_step_that_no_series_resolve_ends_with_a_message(fmus, packaging, backend, wrong):
    host = packaging.Host(getattr(fmus, backend)("RingBalancer")).begin(wrong)
    assert "s is too long" in host.refused(lambda: host.step(1e-3))


def test_a_wave_at_rest_stands_still_at_a_speed_whose_square_is_infinite(fmus, packaging):
    """The unit in Python; what is wrong of it there is fatal to the instance, but for a step."""
    host = packaging.Host(fmus.python("RingBalancer")).begin({"speed": 1e250})
    assert host.get("F_xi", "F_eta") == [0.0, 0.0]
    assert "s is too long" in host.refused(lambda: host.step(1e-3))
    host.set({"speed": 100.0})
    host.step(1e-3)


def test_a_step_that_ends_where_the_rotor_comes_to_rest_is_made(fmus, packaging):
    """The film's series has no radius there."""
    waves = []
    for path in (fmus.native("RingBalancer"), fmus.python("RingBalancer")):
        host = packaging.Host(path)
        host.begin({"viscosity": 1e-3, "speed": 3.0, "acceleration": -3000.0, "wave_xi0": 1e-4})
        host.step(1e-3)
        waves.append(host.get("wave_xi", "wave_speed_xi"))
    np.testing.assert_allclose(*waves, rtol=1e-6)
    assert 0.0 < waves[0][0] < 1e-4


def test_a_machine_with_a_ring_that_turns_backwards_is_the_mirror_image(instance):
    def displacements(way):
        host = instance(load_scene("washing_machine_ring"))
        drive = {"rise_time": 0.0, "speed": 50.0 * way, "acceleration": 20.0 * way}
        host.begin({**drive, "ring.viscosity": 1e-3})
        rows = []
        for _ in range(50):
            host.set({"speed": way * (50.0 + 20.0 * host.time)})
            host.step(1e-2)
            rows.append(host.get("rotor.x", "rotor.y"))
        return np.array(rows)

    np.testing.assert_allclose(displacements(-1.0), displacements(1.0) * [1.0, -1.0], rtol=1e-9)


def test_one_file_warns_of_a_layer_that_is_too_thin(hosted):
    host = hosted(load_scene("washing_machine_ring"), {"ring.wave_xi0": 0.05})
    assert host.get("ring.thinness")[0] > 0.3
    assert any("the waves are too large for the model" in text for _, text in host.messages)


def test_the_film_damps_waves_from_rest_on_as_equations_in_fixed_axes_say():
    """(1 + f) y'' + d (y' - i w y) - 4 i w y' - 2 w^2 y = -z'', F = -m (z'' + f y''), by SciPy.

    d grows as the root of the speed, whose series has no radius at rest.
    """
    change, turns, viscosity, wave = 30.0, 2.0, 1e-2, 1e-3
    seconds = math.sqrt(2.0 * turns * math.tau / change)
    scene = load_scene("washing_machine_ring").replace(
        {
            "ring.viscosity": viscosity,
            "ring.wave_damping": 0.0,
            "operation.run_up": {"from": 0.0, "to": change * seconds, "seconds": seconds},
            "run.revolutions": None,
            "run.duration": seconds,
            "run.initial": {"x": wave},
            "coupling.tolerance": 1e-9,
        }
    )
    run = scene.run(record=["rotor.x", "rotor.y"])
    ring, rotor = scene.balancer[0].device, scene.rotor
    f, liquid = ring.hollow, ring.liquid_mass
    (spring, _), (damper, _) = np.reshape(rotor.stiffness, 2), np.reshape(rotor.damping, 2)
    masses = np.array([[rotor.mass + liquid, liquid * f], [1.0, 1.0 + f]])

    def rates(t, state):
        z, y, z1, y1 = state
        w = change * t
        pushed = rotor.unbalance * (w**2 - 1j * change) * np.exp(0.5j * change * t**2)
        slid = ring.damping(w) * (y1 - 1j * w * y)
        driven = [pushed - damper * z1 - spring * z, 4j * w * y1 + 2.0 * w**2 * y - slid]
        return [z1, y1, *np.linalg.solve(masses, driven)]

    start = np.array([wave, 0.0, 0.0, 0.0], complex)
    solved = solve_ivp(rates, (0.0, seconds), start, "DOP853", run.time, rtol=1e-11, atol=1e-14)
    found = run["rotor.x"] + 1j * run["rotor.y"]
    assert np.abs(found - solved.y[0]).max() <= 1e-7 * np.abs(found).max()
