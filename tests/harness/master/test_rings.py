"""A ring part filled with liquid in every engine, against integrations of the whole machine."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest
from fmpy import platform_tuple

import autobalancer as ab
from autobalancer.fmus.composite.build import build_composite
from autobalancer.harness import cosimulate
from autobalancer.harness.errors import SceneError
from autobalancer.harness.master.one_file import composition
from autobalancer.harness.scene.plausible import implausible
from autobalancer.models.monolith import simulate
from tests.native.packaging import Host
from tests.studies import rings

SIGNALS = [
    *("rotor.x", "rotor.y", "ring.wave_xi", "ring.wave_eta", "ring.wave_speed_xi"),
    *("ring.moment_xi", "ring.thinness", "ring.F_xi", "ring.F_eta"),
]
DRUM = {
    "rotor": {
        "kind": "planar", "mass": 10.0, "stiffness": 2.5e4, "damping": 60.0, "unbalance": 5e-4
    },
    "balancer": [
        {"kind": "ring", "wall_radius": 0.25, "inner_radius": 0.2, "height": 0.05, "density": 1e3,
         "viscosity": 1e-4}
    ],
    "operation": {"speed": 110.0},
    "run": {"revolutions": 12, "record": SIGNALS, "initial": {"x": 1e-3}},
}  # fmt: skip
BALLS = {"kind": "balls", "count": 2, "mass": 0.02, "track_radius": 0.1, "drag": 0.5}
RUN_UP = {"operation.speed": None, "operation.run_up": {"from": 0.0, "to": 110.0, "seconds": 0.8}}


def machine(**changes) -> ab.Scene:
    tables = {key: changes.pop(key, table) for key, table in DRUM.items()}
    return ab.Scene(**tables).replace(changes)


def errors(scene: ab.Scene) -> dict[str, float]:
    """Largest error of every signal over its range, by an integration in one piece."""
    result = cosimulate(scene)
    start = scene.run.initial.motion()
    truth = simulate(scene.assembly(), scene.profile(), result.time, initial=start, rtol=1e-11)
    return {
        name: float(np.abs(values - truth[name]).max() / np.ptp(truth[name]))
        for name, values in result.signals.items()
    }


@pytest.mark.parametrize(
    ("changes", "most"),
    [
        ({}, 1e-6),
        (RUN_UP, 1e-6),
        ({"rotor.stiffness": [2.5e4, 4e4]}, 1e-6),
        ({"operation.gravity": 9.81}, 1e-6),
        ({"balancer": [*DRUM["balancer"], BALLS]}, 1e-6),
        ({"coupling.scheme": "iterated", "coupling.steps_per_rev": 80}, 1e-6),
        ({"coupling.scheme": "iterated", "coupling.steps_per_rev": 80, **RUN_UP}, 1e-5),
        ({"coupling.units": "python", "coupling.steps_per_rev": 60, "run.revolutions": 3}, 1e-5),
    ],
    ids=["plain", "run-up", "unlike", "gravity", "balls", "given", "given run-up", "python"],
)  # fmt: skip
def test_runs_are_those_of_an_integration_in_one_piece(changes, most):
    found = errors(machine(**changes))
    assert set(found) == set(SIGNALS)
    assert max(found.values()) < most


def test_one_ring_on_two_supports_beside_another():
    scene = ab.Scene(
        rotor={"kind": "two_support", "mass": 12.0, "inertia": 0.5, "polar_inertia": 0.4,
               "span": 0.4, "stiffness": [5e4, 5e4], "damping": [60.0, 60.0],
               "planes": [0.0, 0.3], "unbalances": [{"position": 0.1, "amount": 1e-3}]},
        balancer=[{**DRUM["balancer"][0], "name": "ring"},
                  {**DRUM["balancer"][0], "name": "back", "at": 2, "wall_radius": 0.22}],
        operation={"speed": 150.0},
        run={"revolutions": 8, "record": [*SIGNALS[2:], "rotor.station[2].x", "back.wave_xi"]},
    )  # fmt: skip
    assert max(errors(scene).values()) < 1e-7


def test_methods_agree_on_the_unstable_band():
    """The methods are `floquet`, `cosim` and `proved`."""
    scene = machine(**{"ring.viscosity": 0.0, "ring.wave_damping": 6.0, "rotor.damping": 40.0})
    found = scene.speeds(20.0, 250.0, "floquet,cosim,proved")
    floquet, cosim = found.methods["floquet"], found.methods["cosim"]
    assert [c.above for c in floquet] == ["unstable", "stable"] == [c.above for c in cosim]
    for one, other in zip(floquet, cosim, strict=True):
        assert one.speed == pytest.approx(other.speed, abs=max(1e-4, 3.0 * other.error))
    proved = {
        state: [b for b in found.proof.bands if b.state == state]
        for state in ("stable", "unstable")
    }
    assert [(b.low, b.high) for b in proved["unstable"]] == [
        pytest.approx((floquet[0].speed, floquet[1].speed), rel=1e-6)
    ]
    assert len(proved["stable"]) == 2


def test_thickness_of_the_layer_may_be_said_in_three_ways():
    inner = 0.2
    mass = 1000.0 * math.pi * (0.25**2 - inner**2) * 0.05
    fill = (0.25**2 - inner**2) / (0.25**2 - 0.15**2)
    ways = [{"inner_radius": inner}, {"liquid_mass": mass}, {"fill": fill}]
    table = {k: v for k, v in DRUM["balancer"][0].items() if k != "inner_radius"}
    rings = [ab.Ring(**table, **way, inner_wall_radius=0.15).device for way in ways]
    assert [ring.inner_radius for ring in rings] == pytest.approx([inner] * 3, rel=1e-12)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"ring.fill": 0.5}, "one of inner_radius, fill and liquid_mass: not inner_radius and"),
        ({"ring.inner_radius": None, "ring.fill": 0.5}, "needs inner_wall_radius"),
        ({"ring.inner_radius": None, "ring.liquid_mass": 20.0}, "more liquid than the ring holds"),
        ({"ring.inner_radius": 0.3}, "must be less than wall_radius = 0.25 m"),
        ({"ring.inner_wall_radius": 0.22}, "more liquid than the ring holds inside its walls"),
        ({"ring.wall_radius": -1.0}, "wall_radius"),
        (
            {"operation": {"motor": {"stall_torque": 5.0, "no_load_speed": 100.0, "inertia": 1.0}}},
            "does not support a ring of liquid",
        ),
    ],
)  # fmt: skip
def test_wrong_rings_are_refused_with_a_reason(changes, message):
    with pytest.raises(SceneError, match=message):
        machine(**changes)


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_file_whose_motor_drives_a_ring_is_refused_as_the_scene_is(tmp_path, fmi):
    """By the FMU itself, whoever has put its parts together."""
    motor = {"stall_torque": 5.0, "no_load_speed": 100.0, "inertia": 1.0}
    with pytest.raises(SceneError) as refused:
        machine(operation={"motor": motor})
    driven = composition(machine(operation={"motor": motor}, balancer=[BALLS]))
    ring = composition(machine()).parts[1]
    object.__setattr__(driven, "parts", (driven.parts[0], ring, driven.parts[-1]))
    path = build_composite(driven, tmp_path, name="one", fmi=fmi, platforms=[platform_tuple])
    host = Host(path)
    said = host.refused(host.begin)
    assert str(refused.value).removeprefix("scene: ").replace("balancer[1]", ring.name) in said


def test_wave_of_a_steady_drum_is_that_of_the_closed_form():
    scene = machine(**{"rotor.damping": 400.0, "run.revolutions": 60, "operation.speed": 30.0,
                       "run.initial": {}, "ring.viscosity": 5e-3})  # fmt: skip
    result = cosimulate(scene)
    z = complex(result["rotor.x"][-1], result["rotor.y"][-1])
    z *= cmath.rect(1.0, -30.0 * result.time[-1])
    wave = complex(result["ring.wave_xi"][-1], result["ring.wave_eta"][-1])
    assert wave == pytest.approx(z / (1.0 - 0.64), rel=1e-3)


def test_random_machines_run_as_their_equations_written_anew_say():
    """A sample of `python -m tests.studies.rings`."""
    rng = np.random.default_rng(7)
    for _ in range(3):
        worst, stated = rings.errors(rings.machine(rng))
        assert worst < rings.TOLERANCE
        assert worst < 3.0 * stated


def test_a_ring_that_gravity_breaks_and_a_chamber_like_a_ring_get_a_warning():
    slow = machine(**{**RUN_UP, "operation.gravity": 9.81})
    assert ["does not stay at its wall" in line for line in implausible(slow)] == [True]
    assert not implausible(machine(**{"operation.gravity": 9.81}))
    chamber = {"kind": "liquid", "chamber_radius": 0.25, "float_radius": 0.2, "height": 0.05,
               "density": 1e3}  # fmt: skip
    lines = implausible(machine(balancer=[chamber], run={"revolutions": 5}))
    assert ['write kind = "ring"' in line for line in lines] == [True]


@pytest.mark.parametrize(
    ("seconds", "said"),
    [(1.0, ""), (2.0, "some 10 %"), (4.0, "more than 30 %"), (16.0, "was dry")],
)
def test_a_run_says_how_far_its_waves_are_to_be_believed(seconds, said):
    changes = {"operation.run_up.seconds": seconds, "run.revolutions": None}
    scene = ab.load("washing_machine_ring").replace({**changes, "run.duration": seconds})
    summary = str(scene.run().summary())
    assert said in summary
    assert bool(said) == ("layer of liquid" in summary or "wall of the ring" in summary)
