"""Model exchange of the one-file unit: a solver of the tool integrates the states of its parts."""

from __future__ import annotations

import ctypes
import math
from dataclasses import replace

import fmpy
import numpy as np
import pytest
from fmpy import platform_tuple
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu
from scipy.integrate import solve_ivp

from autobalancer.fmus.composite.build import build_composite
from autobalancer.harness import Scene, load_scene
from autobalancer.harness.master.one_file import composition
from tests.native.packaging import Host
from tests.studies.truth.draw import draw

TIGHT = 1e-12
CHANGE = {"time": 0.1234, "number": 1.0, "amount": 2e-3, "angle": 1.0}


def parts_with(made, model, start):
    """The composition with other start values of the parts of this model."""
    parts = [replace(p, start={**p.start, **start}) if p.model == model else p for p in made.parts]
    return replace(made, parts=tuple(parts))


def eccentric(made):
    """The composition with a track beside the axis, and a force from outside."""
    made = parts_with(made, "BallBalancer", {"track_offset_xi": 2e-4, "track_offset_eta": -1e-4})
    return replace(made, start={**made.start, "rotor.plane[1].F_y": 20.0})


def changing(made):
    """The composition with an unbalance that changes at a time between points of the output."""
    change = {f"unbalance_change[1].{key}": value for key, value in CHANGE.items()}
    return replace(made, changes=1, start={**made.start, **change})


MACHINES = {
    "balls": ("two_balls", lambda made: made, 5.0),
    "liquid": ("liquid_disc", lambda made: made, 0.5),
    "balls and liquid": ("balls_and_liquid", lambda made: made, 0.3),
    "eccentric track": ("balls_and_liquid", eccentric, 0.3),
    "force, gravity": ("liquid_heavy_force", lambda made: made, 0.3),
    "motor": ("sommerfeld", lambda made: made, 0.5),
    "shaft": ("three_mass_shaft", lambda made: made, 1.0),
    "run-up with a corner": ("run_up", lambda made: made, 2.5),
    "changing unbalance": ("balls_and_liquid", changing, 0.3),
}


def built(folder, name, fmi=2):
    scene, change, stop = MACHINES[name]
    made = change(composition(load_scene(scene)))
    return build_composite(made, folder, name="one", fmi=fmi, platforms=[platform_tuple]), stop


def states_of(path):
    return [d.variable.derivative for d in fmpy.read_model_description(str(path)).derivatives]


def simulated(path, stop, kind, names, **settings):
    """Rows at 200 points; at an event the solver writes two more."""
    step = {"output_interval": stop / 200, "stop_time": stop}
    run = fmpy.simulate_fmu(str(path), fmi_type=kind, output=names, **step, **settings)
    points = step["output_interval"] * np.arange(201)
    rows = [int(np.abs(run["time"] - point).argmin()) for point in points]
    return np.array([run[n][rows] for n in names]).T


# FMI 3.0 shares all but its front
@pytest.mark.parametrize(
    ("name", "fmi"), [*((name, 2) for name in MACHINES), ("run-up with a corner", 3)]
)
def test_a_solver_of_the_tool_finds_the_motion_of_co_simulation(tmp_path, name, fmi):
    path, stop = built(tmp_path, name, fmi)
    assert validate_fmu(str(path)) == []
    names = [v.name for v in states_of(path)]
    exact = {"coupling.tolerance": 10.0 * TIGHT if name == "force, gravity" else TIGHT}
    steps = simulated(path, stop, "CoSimulation", names, start_values=exact)
    solved = simulated(path, stop, "ModelExchange", names, solver="CVode", relative_tolerance=TIGHT)
    largest = abs(steps).max(axis=0)
    assert (abs(solved - steps).max(axis=0) <= 1e-8 * largest).all()


class Exchange(Host):
    """An instance of FMI 2.0 for model exchange in continuous-time mode."""

    def __init__(self, path, values=None, start=0.0):
        super().__init__(path, kind=fmpy.fmi2.FMU2Model)
        self.slave.setupExperiment(startTime=start)
        self.slave.enterInitializationMode()
        self.set(values or {})
        self.count = len(self.description.derivatives)
        self.buffer = np.zeros(self.count)
        self.pointer = self.buffer.ctypes.data_as(fmpy.fmi2.POINTER(fmpy.fmi2.fmi2Real))
        exchange = self.description.modelExchange
        self.begun = self.read("getContinuousStates") if exchange else None
        self.slave.exitInitializationMode()

    def read(self, function):
        getattr(self.slave, function)(self.pointer, self.count)
        return self.buffer.copy()

    def place(self, time, states):
        self.slave.setTime(time)
        self.buffer[:] = states
        self.slave.setContinuousStates(self.pointer, self.count)


@pytest.mark.parametrize("name", ["balls and liquid", "motor", "shaft", "run-up with a corner"])
def test_derivatives_are_those_of_the_motion_whatever_was_asked_before(tmp_path, name):
    """At points of a co-simulation, by differences of its motion and by its variables."""
    path, _ = built(tmp_path, name)
    names = [v.name for v in states_of(path)]
    rates = [f"der({n})" for n in names]
    exact = {"coupling.tolerance": TIGHT}
    h = 2e-3 if name == "shaft" else 1e-4  # the shaft turns slowly, and angles are rounded
    run = fmpy.simulate_fmu(
        str(path), stop_time=40 * h, output_interval=h, output=[*names, *rates], start_values=exact
    )
    seen = np.array([[row[n] for n in names] for row in run])
    told = np.array([[row[n] for n in rates] for row in run])
    weights = np.array([1.0, -9.0, 45.0, 0.0, -45.0, 9.0, -1.0]) / -60.0 / h
    found = sum(w * seen[k : k + 35] for k, w in enumerate(weights))
    size = abs(told).max(axis=0)
    assert (abs(found - told[3:38]).max(axis=0) <= 1e-6 * size).all()
    host = Exchange(path)
    assert (host.begun == seen[0]).all()
    first = host.read("getDerivatives")
    for k in (35, 7, 20):
        host.place(float(run["time"][k]), seen[k])
        assert (abs(host.read("getDerivatives") - told[k]) <= 1e-9 * size).all()
        assert host.read("getContinuousStates") == pytest.approx(seen[k], rel=1e-15, abs=1e-300)
    kept = host.slave.serializeFMUState(host.slave.getFMUState())
    rates_there = host.read("getDerivatives")
    host.place(0.0, seen[0])
    assert (host.read("getDerivatives") == first).all()
    host.slave.setFMUState(host.slave.deserializeFMUState(kept))
    assert (host.read("getDerivatives") == rates_there).all()


def test_a_speed_that_the_tool_prescribes_moves_the_rotor_alike(tmp_path):
    path, stop = built(tmp_path, "balls and liquid")
    names = [v.name for v in states_of(path)]
    columns = [("time", float), ("speed", float), ("acceleration", float)]
    told = np.array([(0.0, 250.0, -100.0), (stop, 250.0 - 100.0 * stop, -100.0)], columns)
    steps = simulated(
        path, stop, "CoSimulation", names, input=told, start_values={"coupling.tolerance": TIGHT}
    )
    host = Exchange(path, {"speed": 250.0, "acceleration": -100.0})

    def rates(time, states):
        host.set({"speed": 250.0 - 100.0 * time})
        host.place(time, states)
        return host.read("getDerivatives")

    start = host.read("getContinuousStates")
    tight = {"method": "DOP853", "rtol": TIGHT, "atol": 1e-14}
    found = solve_ivp(rates, (0.0, stop), start, **tight).y[:, -1]
    assert (abs(found - steps[-1]) <= 1e-8 * abs(steps).max(axis=0)).all()


def test_nominal_values_are_those_of_the_description(tmp_path):
    path, _ = built(tmp_path, "motor")
    host = Exchange(path)
    of_type = {t.name: float(t.nominal) for t in host.description.typeDefinitions}
    expected = [of_type[v.declaredType.name] for v in states_of(path)]
    assert host.read("getNominalsOfContinuousStates").tolist() == expected


def test_the_vibration_of_model_exchange_is_that_of_co_simulation(tmp_path):
    path, _ = built(tmp_path, "balls")
    names = ["vibration", "residual_unbalance", "capacity_used"]
    solved = simulated(path, 20.0, "ModelExchange", names, relative_tolerance=1e-9)
    exact = {"coupling.tolerance": 1e-9}
    steps = simulated(path, 20.0, "CoSimulation", names, start_values=exact)
    # revolutions that are looked at end up to a 32nd of a turn apart: meanwhile it decays
    assert solved[-1] == pytest.approx(steps[-1], rel=3e-4)


def test_the_vibration_is_that_of_the_step_which_the_solver_has_completed(tmp_path):
    """Read before that too, or not."""
    path, _ = built(tmp_path, "balls")
    found = []
    for reads in (False, True):
        host = Exchange(path)
        host.place(1e-3, host.begun + 1e-3)
        if reads:
            assert host.get("vibration") == [0.0]
        host.slave.completedIntegratorStep()
        found += host.get("vibration")
    assert found[0] == found[1] > 0.0


# impacts and contacts, rolling and sticking, dry friction
@pytest.mark.parametrize(
    ("family", "number", "fmi", "indicators"),
    [("impacts", 2, 2, 3), ("sticking", 0, 2, 4), ("sticking", 1, 3, 4), ("friction", 5, 3, 2)],
)
def test_a_solver_of_the_tool_finds_every_event(tmp_path, family, number, fmi, indicators):
    """By indicators that are distances: its motion is that of co-simulation."""
    scene = Scene.from_document(draw(family, 5, number))
    path = build_composite(
        composition(scene), tmp_path, name="one", fmi=fmi, platforms=[platform_tuple]
    )
    assert validate_fmu(str(path)) == []
    description = fmpy.read_model_description(str(path))
    assert description.numberOfEventIndicators == indicators
    names = [v.name for v in states_of(path)]
    stop = 2.0 * math.pi * scene.revolutions / scene.profile().top
    exact = {"coupling.tolerance": 1e-11}
    steps = simulated(path, stop, "CoSimulation", names, start_values=exact)
    solved = simulated(path, stop, "ModelExchange", names, solver="CVode", relative_tolerance=1e-11)
    largest = abs(steps).max(axis=0)
    assert (abs(solved - steps).max(axis=0) <= 1e-6 * largest).all()


def test_an_impact_changes_states_and_no_time_event(tmp_path):
    """The indicator is the gap; behind it the weights part at e times their closing speed."""
    meeting = {
        "weights.weight_radius": 0.1,
        "weights.restitution": 0.5,
        "weights.angles": [1.0, 2.0],
    }
    scene = load_scene("two_balls").replace({**meeting, "weights.speeds": [0.3, -0.3]})
    path = build_composite(composition(scene), tmp_path, name="one", platforms=[platform_tuple])
    host = Exchange(path)
    indicators = np.zeros(2)
    pointer = indicators.ctypes.data_as(fmpy.fmi2.POINTER(fmpy.fmi2.fmi2Real))

    def meet():
        host.slave.enterEventMode()
        more, end, nominals, changed, timed, _ = host.slave.newDiscreteStates()
        assert (more, end, nominals, timed) == (0, 0, 0, 0)
        host.slave.enterContinuousTimeMode()
        return bool(changed)

    names = [v.name for v in states_of(path)]
    angles, speeds = (
        [names.index(f"weights.weight[{k}].{v}") for k in (1, 2)] for v in ("angle", "speed")
    )
    assert not meet()
    states = host.read("getContinuousStates")
    host.slave.getEventIndicators(pointer, 2)
    radius = scene.balancer[0].track_radius
    touching = 2.0 * math.asin(0.1 / radius)
    assert indicators[0] == pytest.approx(1.0 - touching, abs=1e-13)
    states[angles] = 1.0, 1.0 + touching - 1e-12
    host.place(0.1, states)
    host.slave.getEventIndicators(pointer, 2)
    assert indicators[0] < 0.0
    assert meet()
    behind = host.read("getContinuousStates")
    assert behind[speeds[1]] - behind[speeds[0]] == pytest.approx(0.5 * 0.6, rel=1e-12)
    host.slave.getEventIndicators(pointer, 2)
    assert indicators[0] >= -1e-15


def test_sliders_with_springs_are_for_co_simulation_alone(tmp_path):
    scene = load_scene("two_balls").replace({"rotor.friction": [{"limit": 0.1, "stiffness": 10.0}]})
    path = build_composite(composition(scene), tmp_path, name="one", platforms=[platform_tuple])
    description = fmpy.read_model_description(str(path))
    assert description.modelExchange is None
    assert not description.derivatives
    with pytest.raises(FMICallException):
        Exchange(path)


def test_calls_of_the_other_interface_are_refused(tmp_path):
    path, _ = built(tmp_path, "balls")
    host = Exchange(path)
    calls = [
        lambda: host.slave.getContinuousStates(host.pointer, host.count - 1),
        lambda: host.slave.getEventIndicators(host.pointer, 1),
        lambda: host.place(0.0, [float("nan")] * host.count),
        lambda: host.slave.setTime(float("inf")),
    ]
    for call in calls:
        with pytest.raises(FMICallException):
            call()
    step = (ctypes.c_void_p(host.slave.component), ctypes.c_double(), ctypes.c_double(1e-3), 0)
    assert host.slave.dll.fmi2DoStep(*step) == fmpy.fmi2.fmi2Error
    with pytest.raises(FMICallException):
        Exchange(path, {"weights.weight_radius": 0.01})


@pytest.mark.parametrize("size", [1.7e308, -1e200, 1e160])
@pytest.mark.parametrize("name", ["balls", "motor", "shaft", "liquid"])
def test_derivatives_that_are_not_finite_are_an_error(tmp_path, name, size):
    """A solver would go on with an infinite value that is given as a good one."""
    path, _ = built(tmp_path, name)
    host = Exchange(path)
    host.slave.enterContinuousTimeMode()
    for k in range(host.count):
        host.place(0.0, np.where(np.arange(host.count) == k, size, 0.0))
        try:
            rates = host.read("getDerivatives")
        except FMICallException:
            continue
        assert np.isfinite(rates).all(), k


@pytest.mark.parametrize("fmi", [2, 3])
def test_indicators_are_there_from_initialisation_on(tmp_path, fmi):
    """Both standards let a tool read them before the solver starts."""
    made = composition(load_scene("washing_machine_stops"))
    path = build_composite(made, tmp_path, name="one", fmi=fmi, platforms=[platform_tuple])
    kind = fmpy.fmi2.FMU2Model if fmi == 2 else fmpy.fmi3.FMU3Model
    host = Host(path, kind=kind)
    if fmi == 2:
        host.slave.setupExperiment()
    host.slave.enterInitializationMode()
    count = host.description.numberOfEventIndicators
    before, after = (ctypes.c_double * count)(), (ctypes.c_double * count)()
    host.slave.getEventIndicators(before, count)
    host.slave.exitInitializationMode()
    host.slave.getEventIndicators(after, count)
    assert list(before) == list(after)
    assert min(before) > 0.0
