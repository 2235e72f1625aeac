"""The right-hand side of a machine in one piece, against Lagrange's equations of the reference."""

import math
from dataclasses import replace

import numpy as np
import pytest

from autobalancer.fmus.composite.run import Run, Stretch
from autobalancer.harness import Scene
from autobalancer.harness.master.one_file import composition
from autobalancer.models.constants import FIRST_DERIVATIVE
from autobalancer.models.monolith import equations
from tests.studies.truth.draw import draw

# rates of machines without events, of which those that may have some are drawn now and then
FAMILIES = (
    *("planar", "run_up", "two_support", "flexible", "liquid", "heavy", "offset", "gravity"),
    *("motor", "unequal", "profile", "changing"),
)
EACH = 12
TIGHT = 1e-12
TURNED = 0.37  # of a revolution, from the start


def smooth_scenes(family):
    for number in range(EACH):
        scene = Scene.from_document(draw(family, 44, number))
        meets = any(b.can_meet or b.can_stick for b in scene.balancer)
        if scene.assembly().weights and not (meets or scene.rotor.friction):
            yield scene


def states_and_rates(scene):
    """By the library, some way after the start: time, states and derivatives by name."""
    made = composition(scene)
    start = {**made.start, "coupling.tolerance": 1e-6}
    made = replace(made, start=start)
    names = [f"{part.name}.{state}" for part in made.parts for state in part.states]
    read = np.array([made.layout.index[name] for name in names], np.uintc)
    end = TURNED * 2.0 * math.pi / scene.profile().top
    values, rates = np.empty(len(read)), np.empty(len(read))
    run = Run(made)
    run.start()
    run.on(Stretch(0.0, end, end, end, 1), read, np.empty((2, 1 + len(read))))
    assert run.reason == ""
    run.read(read, values)
    run.read(np.arange(len(read), dtype=np.uintc) + FIRST_DERIVATIVE, rates)
    run.close()
    return end, dict(zip(names, values, strict=True)), dict(zip(names, rates, strict=True))


def of_parts(scene, values):
    """Angle of the shaft, values of the stations and of the weights on the track.

    Stations: (displacements or velocities, stations, x and y); weights: (angles or speeds, N).
    """
    n = len(scene.rotor.stations)
    lateral = [v for k, v in values.items() if k.startswith("rotor.")][1:]
    both = [
        [v for m in scene.assembly().weights for v in of_weights(values, m.name, end)]
        for end in (".angle", ".speed")
    ]
    return values["rotor.angle"], np.array(lateral).reshape(2, n, 2), np.array(both)


def of_weights(values, name, end):
    return [v for k, v in values.items() if k.startswith(f"{name}.") and k.endswith(end)]


def referred(scene, time, values):
    """Accelerations of the stations (n, 2), of the weights (N,) on the track, and of the shaft."""
    angle, stations, weights = of_parts(scene, values)
    motor, profile = scene.operation.motor, scene.profile()
    speed = values["motor.speed"] if motor else profile.speed(time)
    start = scene.run.initial.motion().angle
    equal = equations(scene.assembly().at(time), scene.operation.drive(), start)
    lateral = stations.transpose(0, 2, 1).ravel()
    state = [*lateral, *(weights[0] + angle), *(weights[1] + speed)]
    found = np.asarray(equal.rhs(time, np.array([*state, angle, speed] if motor else state)))
    change = found[-1] if motor else profile.acceleration(time)
    n, count = len(lateral) // 2, weights.shape[1]
    phi = found[2 * n + count : 2 * n + 2 * count]
    return found[n : 2 * n].reshape(2, -1).T, phi - change, change


@pytest.mark.parametrize("family", FAMILIES)
def test_rates_are_those_of_the_reference(family):
    compared = 0
    for scene in smooth_scenes(family):
        time, values, rates = states_and_rates(scene)
        stations, weights, change = referred(scene, time, values)
        _, lateral, turned = of_parts(scene, rates)
        size = abs(stations).max() + abs(scene.assembly().rotor.gravity)
        assert abs(lateral[1] - stations).max() <= TIGHT * size
        # in fixed axes the drag is a difference of speeds, which are rounded
        drag = max(one.damping_rate for m in scene.assembly().weights for one in m.device.each)
        top = scene.profile().top
        size = abs(weights).max() + abs(change) + drag * top
        assert abs(turned[1] - weights).max() <= TIGHT * size
        if scene.operation.motor:
            assert rates["motor.speed"] == pytest.approx(change, rel=TIGHT)
        compared += 1
    assert compared >= 3
