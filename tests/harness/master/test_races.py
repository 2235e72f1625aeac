"""Weights on races with lobes in every engine, against integrations of the whole machine."""

from __future__ import annotations

import numpy as np
import pytest

import autobalancer as ab
from autobalancer.harness import cosimulate
from autobalancer.harness.errors import SceneError
from autobalancer.models.monolith import simulate
from tests.studies import races

SIGNALS = [
    *("rotor.x", "rotor.y", "balls.weight[1].angle", "balls.weight[2].speed"),
    *("balls.moment_xi", "balls.F_xi", "balls.F_eta"),
]
RACE = [
    {"lobes": 2, "amplitude": "2 mm", "angle": 0.3},
    {"lobes": 5, "amplitude": "0.3 mm", "angle": "60 deg"},
]
BALLS = {"kind": "balls", "name": "balls", "count": 2, "mass": 0.15, "track_radius": 0.1,
         "drag": 0.6, "angles": [2.2, 4.1], "race": RACE}  # fmt: skip
FAN = {
    "rotor": {"kind": "planar", "mass": 10.0, "stiffness": 1e4, "damping": 60.0, "unbalance": 0.02},
    "balancer": [BALLS],
    "operation": {"speed": 100.0},
    "run": {"revolutions": 12, "record": SIGNALS},
}
RUN_UP = {"run_up": {"from": 0.0, "to": 100.0, "seconds": 0.8}}
MOTOR = {"motor": {"stall_torque": 5.0, "no_load_speed": 120.0, "inertia": 0.05, "from": 20.0}}
MEET = {"weight_radius": 0.01, "count": 4, "restitution": 0.3, "mass": 0.03,
        "angles": [3.0, 3.3, 3.6, 0.0]}  # fmt: skip


def machine(**tables) -> ab.Scene:
    return ab.Scene(**{**FAN, **tables})


def balls(**changes) -> list:
    return [{**BALLS, **changes}]


def errors(
    scene: ab.Scene, separate: bool = False, method: str = "DOP853", rtol: float = 1e-11
) -> dict[str, float]:
    """Largest error of every signal over its range, by an integration in one piece."""
    result = cosimulate(scene, separate=separate)
    drive = scene.operation.drive()
    truth = simulate(scene.assembly(), drive, result.time, method=method, rtol=rtol)
    return {
        name: float(np.abs(values - truth[name]).max() / np.ptp(truth[name]))
        for name, values in result.signals.items()
    }


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize(
    "tables",
    [
        {},
        {"operation": RUN_UP, "balancer": balls(weight_radius=0.01)},
        {"operation": MOTOR, "balancer": balls(track_offset_xi=3e-3, track_offset_eta=-2e-3)},
        {"rotor": {**FAN["rotor"], "stiffness": [1e4, 2e4]},
         "operation": {"speed": 100.0, "gravity": 9.81}},
        {"balancer": balls(mass=[0.1, 0.2], drag=[0.3, 0.9], kind="rollers")},
        {"balancer": [BALLS, {**BALLS, "name": "round", "race": []}]},
        {"balancer": balls(**MEET)},
        {"balancer": balls(**MEET), "operation": RUN_UP},
    ],
    ids=["plain", "run-up", "motor", "unlike", "unequal", "two", "contact", "contact run-up"],
)  # fmt: skip
def test_runs_are_those_of_an_integration_in_one_piece(tables):
    scene = machine(**tables, coupling={"tolerance": 1e-7})
    if "angles" in tables.get("balancer", [{}])[0] and scene.balancer[0].can_meet:
        scene = scene.replace({"run.record": SIGNALS[:3]})  # speeds and forces jump
    found = errors(scene)
    assert max(found.values()) < 1e-6


@pytest.mark.parametrize("operation", [{"speed": 100.0}, RUN_UP], ids=["constant", "run-up"])
def test_separate_units_move_the_same(operation):
    offset = balls(track_offset_xi=3e-3, mass=[0.1, 0.2])
    found = errors(machine(operation=operation, balancer=offset), separate=True)
    if operation is RUN_UP:  # forces jump where it ends
        found = {name: found[name] for name in SIGNALS[:5]}
    assert max(found.values()) < 2e-5


def test_stiff_machines_move_the_same():
    """Collocation takes steps in which the strong supports do not show."""
    stiff = {
        "kind": "planar",
        "mass": 10.0,
        "stiffness": [1e4, 1e9],
        "damping": [60.0, 1e4],
        "unbalance": 0.02,
    }
    scene = machine(rotor=stiff, run={"revolutions": 20, "record": ["rotor.x", SIGNALS[2]]})
    found = errors(scene, method="odeint", rtol=1e-10)  # an explicit method takes 30 s
    assert max(found.values()) < 1e-3


def test_random_machines_run_as_their_equations_written_anew_say():
    """A sample of `python -m tests.studies.races`."""
    rng = np.random.default_rng(5)
    for _ in range(3):
        worst, stated = races.errors(races.machine(rng))
        assert worst <= 3.0 * stated < 1e-3


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_separate_weights_that_touch_come_nearer_with_smaller_steps():
    """Impacts go to the rotor as pulses: an error of order 1, on a circle too."""
    coarse, fine = (
        errors(
            machine(
                balancer=balls(**MEET),
                coupling={"scheme": "iterated", "steps_per_rev": steps, "order": 3},
                run={"revolutions": 12, "record": SIGNALS[:3]},
            ),
            separate=True,
        )
        for steps in (40, 160)
    )
    assert max(coarse.values()) < 1e-3
    assert max(fine.values()) < 0.5 * max(coarse.values())


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"rolling_resistance": 1e-3}, "must be 0 on a race with lobes"),
        (
            {"race": [{"lobes": 2, "amplitude": 0.04}]},
            "bends inwards: .* must be less than track_radius",
        ),
        ({"race": [{"lobes": 0, "amplitude": 1e-5}]}, r"race\[1\].lobes"),
        ({"race": [{"lobes": 2.5, "amplitude": 1e-5}]}, r"race\[1\].lobes"),
        ({"race": [{"lobes": 2, "amplitude": -1e-5}]}, r"race\[1\].amplitude"),
        ({"race": [{"amplitude": 1e-5}]}, r"race\[1\].lobes: missing"),
    ],
)
def test_races_that_cannot_be_are_refused_by_name(changes, message):
    with pytest.raises(SceneError, match=message):
        machine(balancer=balls(**changes))


def test_python_units_refuse_lobes_by_name():
    with pytest.raises(SceneError, match=r'balancer\[1\].race: not with coupling.units = "python"'):
        machine(coupling={"units": "python"})


def test_many_side_by_side_end_as_each_alone():
    sizes = [0.0, 1e-4, 1e-3, 2e-3, 3e-3, 5e-4]
    scene = machine(balancer=balls(race=[{"lobes": 3, "amplitude": 1e-4}]))
    path = "balls.race[1].amplitude"
    together = scene.run.many({path: sizes}, threads=1)["residual"]
    alone = [scene.run.many({path: [size]}, threads=1)["residual"][0] for size in sizes]
    assert together.tolist() == alone
    assert len(set(alone)) == len(sizes)


def test_torque_on_a_motor_comes_from_separate_units_too():
    scene = machine(operation=MOTOR, balancer=balls(track_offset_xi=3e-3, weight_radius=None))
    found = errors(scene.replace({"run.record": SIGNALS[:3]}), separate=True)
    assert max(found.values()) < 2e-4


def test_lobes_can_be_fitted_and_scattered():
    scene = machine(balancer=balls(race=[{"lobes": 2, "amplitude": 1e-3, "angle": 0.3}]))
    values = {"balls.race[1].amplitude": [5e-4, 1e-3], "balls.race[1].angle": [0.0, 0.6]}
    found = scene.run.many(values, threads=1)
    assert not any(found["failure"])
    assert len(set(found["residual"])) == 2
