"""Model exchange and inputs of the one-file unit against equations that are written here."""

from __future__ import annotations

import fmpy
import numpy as np
import pytest
from fmpy import platform_tuple
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar

from autobalancer.fmus.composite.build import build_composite
from autobalancer.harness import Scene, load_scene
from autobalancer.harness.master.one_file import composition
from autobalancer.models.ring import Ring
from tests.native.test_model_exchange import Exchange, changing, states_of

pytestmark = pytest.mark.filterwarnings(
    "ignore::autobalancer.harness.scene.plausible.ImplausibleWarning"
)


def file_of(scene, folder, change=lambda made: made):
    """The one-file unit of a scene."""
    made = change(composition(scene))
    return build_composite(made, folder, name="one", platforms=[platform_tuple])


def test_a_ring_in_a_run_up_moves_as_its_equations_in_fixed_axes_say(tmp_path):
    """F = -m (A + f y''), (1 + f) y'' + d (y' - i w y) - 4 i w y' - 2 w^2 y = -A.

    The states are Y and Y' with y = Y e^{i angle}.
    """
    scene = load_scene("washing_machine_ring")
    path = file_of(scene, tmp_path)
    w, change, damping = 20.0, 300.0, 0.4
    host = Exchange(path, {"rise_time": 0.0, "speed": w, "acceleration": change})
    names = [v.name for v in states_of(path)]
    own = {"rotor.angle": 0.7, "rotor.x": 1e-3, "rotor.y": -2e-3, "rotor.vx": 0.03,
           "rotor.vy": 0.05, "ring.wave_xi": 2e-3, "ring.wave_eta": 1e-3,
           "ring.wave_speed_xi": -0.02, "ring.wave_speed_eta": 0.04}  # fmt: skip
    host.place(0.0, [own[name] for name in names])
    rates = dict(zip(names, host.read("getDerivatives"), strict=True))

    def pair(values, kind, axes=("_xi", "_eta")):
        return complex(*(values[kind + axis] for axis in axes))

    turn = np.exp(1j * own["rotor.angle"])
    wave, slow, fast = (
        pair(own, "ring.wave"), pair(rates, "ring.wave"), pair(rates, "ring.wave_speed"),
    )  # fmt: skip
    assert slow == pair(own, "ring.wave_speed")
    y, y1 = wave * turn, (slow + 1j * w * wave) * turn
    y2 = (fast + 2j * w * slow + (1j * change - w * w) * wave) * turn
    place, velocity = pair(own, "rotor.", "xy"), pair(own, "rotor.v", "xy")
    moved = pair(rates, "rotor.v", "xy")
    ring = Ring(0.25, host.get("ring.inner_radius")[0], 0.06, 1000.0)
    f, mass, stiffness = ring.hollow, 38.0, 8000.0
    (damper,) = host.get("rotor.damping_x")
    unbalance = 0.025 * (w * w - 1j * change) * turn
    pushed = unbalance - damper * velocity - stiffness * place - ring.liquid_mass * (moved + f * y2)
    assert abs(mass * moved - pushed) <= 1e-12 * abs(unbalance)
    left = damping * (y1 - 1j * w * y) - 4j * w * y1 - 2.0 * w * w * y + moved
    assert abs((1.0 + f) * y2 + left) <= 1e-12 * abs(w * y1)


# -- stops -----------------------------------------------------------------------------------------

GAP, STOP, DAMPER, SPRING = 0.1, 40.0, 0.6, 2.0
UNBALANCE, SPEED = 0.02, 6.0


def turned(times, spin_ups, t):
    """Angle, speed and acceleration of a run-up whose acceleration changes at the ends of steps."""
    angle, speed = 0.0, SPEED
    for begin, end, change in zip(times[:-1], times[1:], spin_ups, strict=True):
        step = min(t, end) - begin
        angle, speed = angle + speed * step + 0.5 * change * step**2, speed + change * step
        if t <= end:
            break
    return angle, speed, change


def pressed(force, times, spin_ups):
    """x, y and their rates of 1 kg that a run-up turns, always in contact; the largest force."""

    def push(s):
        return STOP * (s[0] - GAP) + DAMPER * s[2]

    def rates(t, s):
        angle, w, change = turned(times, spin_ups, t)
        whirl = UNBALANCE * (w * w - 1j * change) * np.exp(1j * angle)
        along = force(t) - SPRING * s[0] - push(s) + whirl.real
        return [s[2], s[3], along, whirl.imag - SPRING * s[1]]

    run = solve_ivp(rates, (0.0, times[-1]), [0.15, 0.0, 0.9, 0.0], "DOP853", rtol=1e-12,
                    atol=1e-14, dense_output=True, max_step=1e-3)  # fmt: skip
    top = minimize_scalar(
        lambda t: -push(run.sol(t)), bounds=(0.0, times[-1]), method="bounded",
        options={"xatol": 1e-10},
    )  # fmt: skip
    assert 0.02 < top.x < times[-1] - 0.02
    return run.sol(np.array(times)), -top.fun


@pytest.mark.parametrize(
    ("times", "spin_ups"),
    [((0.0, 0.2), (15.0,)), ((0.0, 0.1, 0.2), (15.0, 15.0)), ((0.0, 0.1, 0.2), (15.0, 40.0))],
    ids=["first", "second", "second, which speeds up faster"],
)
def test_the_largest_force_of_a_stop_has_the_forces_from_outside_at_both_ends(
    tmp_path, times, spin_ups
):
    """Of the first step and of the second; the tool gives cubic and drive anew at each end."""
    cubic = np.array([3.0, -100.0, 900.0, -3000.0])  # N and its derivatives at t = 0
    factorial = np.array([1.0, 1.0, 2.0, 6.0])
    polynomial = np.polynomial.Polynomial(cubic / factorial)
    scene = Scene.from_document(
        {
            "rotor": {"kind": "planar", "mass": 1.0, "stiffness": SPRING, "damping": 0.0,
                      "unbalance": UNBALANCE,
                      "stops": [{"gap": GAP, "stiffness": STOP, "damping": DAMPER, "kind": "x"}]},
            "operation": {"speed": SPEED},
            "run": {"revolutions": 1, "initial": {"x": 0.15, "vx": 0.9}},
        }
    )  # fmt: skip
    moved, top = pressed(polynomial, times, spin_ups)
    path = file_of(scene, tmp_path)
    names = [v.name for v in states_of(path)]
    force = "rotor.plane[1].F_x"
    inputs = [force, f"der({force})", f"der({force},2)", f"der({force},3)"]

    def told(t):
        _, speed, change = turned(times, spin_ups, t + 1e-12)  # the change of the step that begins
        drive = {"speed": speed, "acceleration": change}
        return drive | {name: float(polynomial.deriv(k)(t)) for k, name in enumerate(inputs)}

    host = Exchange(path, told(0.0))
    host.slave.enterEventMode()
    host.slave.newDiscreteStates()
    host.slave.enterContinuousTimeMode()
    for time, (x, y, vx, vy) in zip(times[1:], moved.T[1:], strict=True):
        host.set(told(time))
        angle = turned(times, spin_ups, time)[0]
        state = {"rotor.angle": angle, "rotor.x": x, "rotor.y": y, "rotor.vx": vx, "rotor.vy": vy}
        host.place(time, [state.get(name, 0.0) for name in names])
        host.slave.completedIntegratorStep()
    assert host.get("rotor.stop[1].largest_force") == [pytest.approx(top, rel=1e-4)]


# -- the host's time and inputs --------------------------------------------------------------------


@pytest.mark.parametrize("start", [0.0, 1e4, 123456789.1, 1e9, 5e9])
def test_an_event_at_a_time_is_passed_where_the_tool_has_come_to_what_it_was_told(tmp_path, start):
    """Far from 0 that is rounded, and less than the unit's own time of it for some of these."""
    path = file_of(load_scene("balls_and_liquid"), tmp_path, changing)
    host = Exchange(path, start=start)
    host.slave.enterEventMode()
    next_time = host.slave.newDiscreteStates()[4:]
    assert next_time == (fmpy.fmi2.fmi2True, start + 0.1234)
    host.place(next_time[1], host.begun)
    host.slave.enterEventMode()
    assert host.slave.newDiscreteStates()[4] == fmpy.fmi2.fmi2False
