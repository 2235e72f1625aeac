"""What a host may ask of the one file: a tolerance, forces that vary, another unbalance."""

from __future__ import annotations

import math

import fmpy
import numpy as np
import pytest
from fmpy import platform_tuple
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu

from autobalancer.harness import load_scene
from tests.native.packaging import Host
from tests.native.test_composite_inputs import sprung

FORCE = ["rotor.plane[1].F_x", "rotor.plane[1].F_y"]


def one_file(folder, scene, fmi=2):
    return scene.build(folder, fmi=fmi, platforms=[platform_tuple], one_file=True).files[0]


# -- the tolerance of the experiment ---------------------------------------------------------------


def asked(path, tolerance, values=None):
    """An instance of either version, begun with the tolerance of an experiment."""
    host = Host(path)
    host.time = 0.0
    if host.description.fmiVersion == "2.0":
        host.slave.setupExperiment(tolerance=tolerance)
        host.slave.enterInitializationMode()
    else:
        host.slave.enterInitializationMode(tolerance=tolerance)
    host.set(values or {})
    host.slave.exitInitializationMode()
    return host


COUPLING = ["coupling.tolerance"]


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("scene", ["two_balls", "run_up"])  # built with steps, with a tolerance
def test_the_tolerance_of_the_experiment_is_that_of_the_coupling_unless_that_is_set(
    tmp_path, scene, fmi
):
    scene = load_scene(scene).replace({"coupling.tolerance": None} if scene == "run_up" else {})
    path = one_file(tmp_path, scene, fmi)
    built = Host(path).begin().get(*COUPLING)
    assert asked(path, None).get(*COUPLING) == built
    assert asked(path, 1e-7).get(*COUPLING) == [1e-7]
    own = {"coupling.tolerance": 1e-3}
    assert asked(path, 1e-7, own).get(*COUPLING) == [1e-3]


@pytest.mark.parametrize("last", [1e-7, None])
def test_the_experiment_that_is_set_up_last_counts(tmp_path, last):
    """FMI 2.0 allows `fmi2SetupExperiment` wherever an instance has not been initialised."""
    path = one_file(tmp_path, load_scene("two_balls"))
    host, built = Host(path), Host(path).begin().get(*COUPLING)
    expected = [last] if last else built
    host.slave.setupExperiment(tolerance=1e-3)
    assert host.get(*COUPLING) == built  # a parameter is not computed from others
    host.get("rotor.x")
    host.slave.setupExperiment(tolerance=last)
    host.slave.enterInitializationMode()
    host.slave.exitInitializationMode()
    assert host.get(*COUPLING) == expected


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_reset_instance_takes_the_tolerance_of_its_next_experiment(tmp_path, fmi):
    path = one_file(tmp_path, load_scene("two_balls"), fmi)
    host, built = asked(path, 1e-3), Host(path).begin().get(*COUPLING)
    for tolerance in (1e-7, None, 1e-6):
        host.slave.reset()
        if fmi == 2:
            host.slave.setupExperiment(tolerance=tolerance)
            host.slave.enterInitializationMode()
        else:
            host.slave.enterInitializationMode(tolerance=tolerance)
        host.slave.exitInitializationMode()
        assert host.get(*COUPLING) == ([tolerance] if tolerance else built)


def test_a_tolerance_that_the_host_has_set_stays_at_a_later_experiment(tmp_path):
    host = Host(one_file(tmp_path, load_scene("two_balls")))
    host.slave.setupExperiment(tolerance=1e-3)
    host.set({"coupling.tolerance": 1e-5})
    host.get("rotor.x")
    host.slave.setupExperiment(tolerance=1e-7)
    host.slave.enterInitializationMode()
    host.slave.exitInitializationMode()
    assert host.get(*COUPLING) == [1e-5]


def test_a_tighter_tolerance_of_the_tool_makes_a_smaller_error(tmp_path):
    path = one_file(tmp_path, load_scene("two_balls"))

    def run(tolerance):
        names = ["rotor.x", "rotor.y"]
        found = fmpy.simulate_fmu(
            str(path), relative_tolerance=tolerance, stop_time=10.0, output=names
        )
        return np.array([found[n] for n in names])

    exact = run(1e-10)
    errors = [abs(run(t) - exact).max() / abs(exact).max() for t in (1e-3, 1e-5, 1e-7)]
    assert errors == sorted(errors, reverse=True)
    assert [error <= t for error, t in zip(errors, (1e-3, 1e-5, 1e-7), strict=True)] == [True] * 3


@pytest.mark.parametrize("tolerance", [0.0, -1.0, math.inf, math.nan])
def test_a_tolerance_that_is_none_is_refused(fmus, tolerance):
    host = Host(fmus.native("RotorOnSupports"))
    text = host.refused(lambda: host.slave.setupExperiment(tolerance=tolerance))
    assert "tolerance = " in text
    assert "must be a finite number above 0" in text


# -- forces that vary over a step ------------------------------------------------------------------


def pushed(host, told, length, count, orders=3):
    """Places of the rotor under a force along x and y, which is `told(order, t)`, order from 0."""
    found = [host.get("rotor.x", "rotor.y")]
    references = host.references(*FORCE)
    for k in range(count):
        t = k * length
        host.set(dict(zip(FORCE, told(0, t), strict=True)))
        for order in range(1, orders + 1):
            host.slave.setRealInputDerivatives(references, [order] * 2, list(told(order, t)))
        host.step(length)
        found.append(host.get("rotor.x", "rotor.y"))
    return np.array(found)


def wave(order, t):
    """A force of 3 N sin(40 rad/s t) along x, of -5 N cos along y, and its derivatives."""
    rate, phase = 40.0, 40.0 * t + order * math.pi / 2.0
    return 3.0 * rate**order * math.sin(phase), -5.0 * rate**order * math.cos(phase)


def test_a_force_with_its_derivatives_moves_the_rotor_as_a_closed_form_says(hosted):
    """At steps of the host of a fifteenth of the force's period; the value alone is off by 21 %."""
    scene, length, count = sprung(), 0.01, 60
    mass = 2.0 + 1000.0 * math.pi * 0.04**2 * 0.05
    t = length * np.arange(count + 1)
    expected = []
    for force, cosine, stiffness in ((3.0, 0, 1e4), (-5.0, 1, 4e4)):
        own = math.sqrt(stiffness / mass)
        still = force / mass / (own**2 - 40.0**2)
        if cosine:
            expected.append(still * (np.cos(40.0 * t) - np.cos(own * t)))
        else:
            expected.append(still * (np.sin(40.0 * t) - 40.0 / own * np.sin(own * t)))
    errors = []
    for orders in (0, 1, 3):
        error = abs(pushed(hosted(scene), wave, length, count, orders) - np.array(expected).T)
        errors.append(float((error.max(axis=0) / abs(np.array(expected)).max(axis=1)).max()))
    assert errors[0] > 0.1
    assert errors[1] < 0.05
    assert errors[2] < (40.0 * length) ** 4 / 24.0  # of the force, what its cubic misses


def test_a_force_that_goes_on_as_it_was_told_costs_no_steps(hosted):
    """A parabola that is told in pieces is the parabola, but for rounding."""

    def parabola(order, t):
        x = 3.0 + 20.0 * t + 7.0 * t**2, 20.0 + 14.0 * t, 14.0, 0.0
        return x[order], -0.3 * x[order]

    scene = load_scene("two_balls").replace({"coupling.steps_per_rev": 40})
    whole, pieces = hosted(scene), hosted(scene)
    pushed(whole, parabola, 6.0, 1)
    found = pushed(pieces, parabola, 0.02, 300)
    assert whole.get("coupling.steps") == pytest.approx(pieces.get("coupling.steps"), abs=1)
    assert found[-1] == pytest.approx(whole.get("rotor.x", "rotor.y"), rel=1e-5)


def test_a_force_that_varies_within_long_steps_moves_a_stiff_machine_as_in_pieces(hosted):
    """By collocation: a cubic over the whole step of the host, or told anew in 300 of them."""

    def cubic(order, t):
        x = (
            0.3 + 0.2 * t - 0.09 * t**2 + 0.01 * t**3,
            0.2 - 0.18 * t + 0.03 * t**2,
            0.06 * t - 0.18,
            0.06,
        )
        return x[order], -3e4 * x[order]

    supports = {"rotor.stiffness": [1.0, 1e7], "rotor.damping": [0.5, 0.14 * 1e7**0.5]}
    own = {"coupling.steps_per_rev": None, "coupling.corrections": None, "coupling.scheme": "auto"}
    scene = load_scene("two_balls").replace({**supports, **own, "coupling.tolerance": 1e-6})
    whole, pieces = hosted(scene), hosted(scene)
    [_, end] = pushed(whole, cubic, 6.0, 1)
    found = pushed(pieces, cubic, 0.02, 300)
    assert whole.get("coupling.steps")[0] < 400
    assert np.abs(found[-1] - end).max() < 1e-5 * np.abs(found).max()


@pytest.mark.parametrize("fmi", [2, 3])
def test_derivatives_of_a_force_are_inputs_in_both_versions(tmp_path, fmi):
    path = one_file(tmp_path, sprung(), fmi)
    assert validate_fmu(str(path)) == []
    host = Host(path).begin()
    host.set({"der(rotor.plane[1].F_x)": 50.0})
    for _ in range(2):
        host.step(0.05)
        host.set({"rotor.plane[1].F_x": 50.0 * host.time})
    mass, t = 2.0 + 1000.0 * math.pi * 0.04**2 * 0.05, 0.1
    own = math.sqrt(1e4 / mass)
    expected = 50.0 / 1e4 * (t - math.sin(own * t) / own)
    assert host.get("rotor.x") == [pytest.approx(expected, rel=1e-4)]


def test_slopes_of_a_table_move_the_rotor_as_short_steps_do(tmp_path):
    """As a tool interpolates its inputs; values that are held are off a hundred times as far."""
    path = one_file(tmp_path, sprung())
    assert fmpy.read_model_description(str(path)).coSimulation.canInterpolateInputs
    times = np.linspace(0.0, 0.5, 26)
    table = 3.0 * np.sin(40.0 * times)

    def end(parts, slopes):
        host = Host(path).begin()
        (reference,) = host.references(FORCE[0])
        for k, slope in enumerate(np.diff(table) / 0.02):
            for part in range(parts):
                host.set({FORCE[0]: table[k] + slope * 0.02 * part / parts})
                host.slave.setRealInputDerivatives([reference], [1], [slope * slopes])
                host.step(0.02 / parts)
        return host.get("rotor.x")[0]

    exact = end(200, True)
    assert abs(end(1, True) - exact) < 1e-4 * abs(exact)
    assert abs(end(1, False) - exact) > 1e-2 * abs(exact)


# -- another unbalance -----------------------------------------------------------------------------


@pytest.mark.parametrize("coupling", [{"steps_per_rev": 40}, {"tolerance": 1e-6}])
def test_an_unbalance_set_between_steps_is_one_that_changes_then(tmp_path, coupling):
    keys = {f"coupling.{key}": value for key, value in coupling.items()}
    scene = load_scene("two_balls").replace(keys)
    change = {"time": 1.37, "amount": 0.01, "angle": 0.7}
    changing = scene.replace({"operation.unbalance_changes": [change]})
    tuned, scheduled = (
        Host(one_file(tmp_path / str(k), s)).begin() for k, s in enumerate((scene, changing))
    )
    for host in (tuned, scheduled):
        host.step(1.37)
    tuned.set({"rotor.unbalance": 0.01, "rotor.unbalance_angle": 0.7})
    names = ["rotor.x", "rotor.y", "weights.weight[1].angle", "residual_unbalance"]
    for _ in range(5):
        for host in (tuned, scheduled):
            host.step(0.9)
            host.set({"rotor.unbalance": host.get("rotor.unbalance")[0]})  # as it is: no jump
        assert tuned.get(*names) == scheduled.get(*names)


def test_a_tuned_unbalance_is_part_of_the_state(tmp_path):
    path = one_file(tmp_path, load_scene("two_balls"))
    host, other = Host(path).begin(), Host(path).begin()
    host.step(1.0)
    host.set({"rotor.unbalance": 0.004})
    kept = host.slave.serializeFMUState(host.slave.getFMUState())
    host.step(2.0)
    expected = host.outputs()
    other.slave.setFMUState(other.slave.deserializeFMUState(kept))
    other.time = 1.0
    other.step(2.0)
    assert other.outputs() == expected


def test_an_unbalance_that_a_change_has_set_is_not_set_again(tmp_path):
    change = {"time": 0.5, "amount": 0.01}
    scene = load_scene("two_balls").replace({"operation.unbalance_changes": [change]})
    host = Host(one_file(tmp_path, scene)).begin()
    host.step(0.4)
    host.set({"rotor.unbalance": 0.02})
    host.step(0.2)
    for name in ("rotor.unbalance", "rotor.unbalance_angle"):
        text = host.refused(lambda name=name: host.set({name: 0.03}))
        assert f"{name}: unbalance_change[1] has set it at t = 0.5 s" in text
    text = host.refused(lambda: host.set({"rotor.mass": 0.03}))
    assert "fixed once initialisation has ended" in text


@pytest.mark.parametrize("read", [[], ["rotor.x"]], ids=["unread", "read"])
def test_outputs_behind_a_restored_state_are_its_own(tmp_path, read):
    """From behind a change of the unbalance, before a step is taken again."""
    change = {"time": 0.5, "amount": 0.01, "angle": 0.7}
    scene = load_scene("two_balls").replace({"operation.unbalance_changes": [change]})
    path = one_file(tmp_path, scene)
    host, straight = Host(path).begin(), Host(path).begin()
    for one in (host, straight):
        one.step(0.4)
        one.get(*read)
    state = host.slave.getFMUState()
    host.step(0.3)
    host.outputs()
    host.slave.setFMUState(state)
    torques = [name for name in host.variables if name.endswith(".torque")]
    assert host.get(*torques) == straight.get(*torques)
    assert host.outputs() == straight.outputs()


def test_a_new_instance_goes_on_alike_though_the_speed_has_risen(tmp_path):
    """Of a stiff machine, whose steps by collocation are known by the speed at the start."""
    scene = load_scene("two_balls").replace({"rotor.stiffness": [8e4, 8e7]})
    path = one_file(tmp_path, scene)
    host, other = Host(path).begin(), Host(path)
    host.step(5.0)
    host.set({"speed": 15.0})
    host.step(2.0)
    kept = host.slave.serializeFMUState(host.slave.getFMUState())
    other.slave.setFMUState(other.slave.deserializeFMUState(kept))
    other.time = host.time
    names = ["rotor.x", "rotor.y", "coupling.steps"]
    for _ in range(20):
        for one in (host, other):
            one.step(0.05)
        assert other.get(*names) == host.get(*names)


@pytest.mark.parametrize("fmi", [2, 3])
def test_the_description_says_what_is_tunable(tmp_path, fmi):
    path = one_file(tmp_path, load_scene("two_plane_rodrigues"), fmi)
    assert validate_fmu(str(path)) == []
    variables = fmpy.read_model_description(str(path)).modelVariables
    found = [v.name for v in variables if v.variability == "tunable"]
    assert found
    assert all("unbalance" in name for name in found)


def test_a_separate_rotor_takes_another_unbalance_between_steps(fmus):
    host = Host(fmus.native("RotorOnSupports")).begin({"speed": 100.0})
    host.step(0.1)
    host.set({"unbalance": 0.0})
    before = host.get("plane[1].a_xi")
    host.set({"unbalance": 0.01})
    assert host.get("plane[1].a_xi") != before


# -- messages of model exchange --------------------------------------------------------------------


def test_messages_of_model_exchange_name_call_time_and_what_did_not_agree(tmp_path):
    from tests.native.test_model_exchange import Exchange

    host = Exchange(one_file(tmp_path, load_scene("two_balls")))
    states = host.read("getContinuousStates")
    host.place(6.8, np.full_like(states, 1e200))
    before = len(host.messages)
    with pytest.raises(FMICallException):
        host.read("getDerivatives")
    text = host.messages[before][1]
    assert "at t = 6.8 s: fmi2GetDerivatives: " in text
    assert "start values" not in text


def test_torques_of_one_file_are_those_of_its_motion(tmp_path):
    """Of the unbalance -u Im(z'' e^{-ia}), of balls b R^2 phi' + (kappa - 1) m R^2 phi''."""
    keys = {"coupling.steps_per_rev": None, "coupling.tolerance": 1e-10, "weights.kind": "balls"}
    scene = load_scene("two_balls").replace(keys)
    host = Host(one_file(tmp_path, scene)).begin()
    velocity = ["rotor.vx", "rotor.vy"]
    rates = [f"weights.weight[{k}].speed" for k in (1, 2)]
    torques = ["rotor.torque", "weights.torque"]
    host.step(1.0)
    before = np.array(host.get(*velocity, *rates))
    host.step(1e-4)
    found, angle = host.get(*torques), host.get("rotor.angle")[0]
    here = np.array(host.get(*velocity, *rates))
    host.step(1e-4)
    slope = (np.array(host.get(*velocity, *rates)) - before) / 2e-4
    turned = (slope[0] + 1j * slope[1]) * np.exp(-1j * angle)
    ring = scene.balancer[0]
    square = ring.track_radius**2
    expected = [
        -scene.rotor.unbalance * turned.imag,
        ring.drag * square * here[2:].sum()
        + (ring.kappa - 1.0) * ring.mass * square * slope[2:].sum(),
    ]
    assert found == pytest.approx(expected, rel=1e-6)
    assert min(map(abs, found)) > 1e-4
