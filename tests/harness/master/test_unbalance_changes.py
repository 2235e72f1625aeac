"""Unbalance that changes during a run: both engines, the one file, its states, its refusals."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest

from autobalancer.harness import SceneError, cosimulate, load_scene
from autobalancer.harness.design.scenes import weights_of
from autobalancer.harness.export.ssp.structure import separate
from autobalancer.harness.master.one_file import composition
from autobalancer.harness.master.schedule import end_time, milestones
from autobalancer.harness.result.many import cosimulate_many
from autobalancer.harness.scene.plausible import implausible
from autobalancer.models.monolith import reference
from autobalancer.models.papers.settling import critical_drag_factor, slow_root

SHORT = {"run.revolutions": 6, "coupling.tolerance": 1e-5}
CASES = {
    "two_balls": SHORT,
    "run_up": {"coupling.tolerance": 1e-5},
    "two_plane_rodrigues": SHORT,
    "three_mass_shaft": SHORT,
}


def changed(name: str, number: int = 1):
    """The scene with an unbalance that doubles, and one that is lost, at an eighth and a half."""
    scene = load_scene(name).replace(CASES[name])
    rotor, end = scene.rotor, end_time(scene)
    amount = rotor.unbalance if rotor.kind == "planar" else rotor.unbalances[number - 1].amount
    changes = [
        {"time": end / 8, "amount": f"{2 * amount} kg m", "angle": "60 deg", "number": number},
        {"time": end / 2, "amount": 0.0, "number": number},
    ]
    return scene.replace({"operation.unbalance_changes": changes})


@pytest.mark.parametrize("separate", [False, True])
@pytest.mark.parametrize("name", CASES)
def test_a_run_follows_its_unbalance(name, separate):
    scene = changed(name)
    run = cosimulate(scene, separate=separate)
    assert all(np.isclose(run.time, at, rtol=1e-14).any() for at in milestones(scene))
    right, own = reference(
        scene.assembly(), scene.operation.drive(), run.time,
        initial=scene.run.initial.motion(), rtol=1e-10, bound=1e-6,
    )  # fmt: skip
    for signal in run.signals:
        exact = right.signal(signal)
        error = np.abs(run[signal] - exact).max() / np.abs(exact).max()
        assert error < 3.0 * max(run.estimated_error, own)


def test_the_first_scheme_without_corrections_follows_too():
    scene = changed("run_up").replace(
        {"coupling.scheme": "compensated", "coupling.steps_per_rev": 200}
    )
    runs = [cosimulate(scene, separate=True), cosimulate(changed("run_up"))]
    x, exact = runs[0]["rotor.x"], np.interp(runs[0].time, runs[1].time, runs[1]["rotor.x"])
    assert np.abs(x - exact).max() < 1e-3 * np.abs(exact).max()


def test_one_file_changes_its_unbalance_whatever_the_steps_of_its_host():
    scene = changed("two_balls").replace({"coupling.steps_per_rev": 80})
    names = ["rotor.x", "rotor.y"]
    found = cosimulate_many(scene, {"unbalance_change[1].amount": [2e-3, 4e-3]}, results=names)
    for k, amount in enumerate((2e-3, 4e-3)):
        run = cosimulate(scene.replace({"operation.unbalance_changes[1].amount": amount}))
        for name in names:
            assert found[name][k] == pytest.approx(run[name][-1], abs=1e-4 * run[name].max())
    index = "unbalance_change[2].number"
    assert composition(scene).layout.index[index]
    wrong = cosimulate_many(scene, {index: [1.5, 2.0]}, results=names)
    assert all("number: must be that of an unbalance" in why for why in wrong["failure"])
    late = cosimulate_many(scene, {"unbalance_change[1].time": [9.0]}, results=names)
    assert "unbalance_change[k].time: must not fall" in late["failure"][0]


def test_balls_rebalance_a_new_unbalance_as_fast_as_the_slow_root_says():
    """Two balls on a heavy rotor, balanced before and after: the rest falls by exp(lambda t)."""
    two = {
        "balls.count": 2,
        "balls.angles": None,
        "balls.weight_radius": None,
        "balls.restitution": None,
        "coupling.steps_per_rev": 40,
        "coupling.scheme": "auto",
        "run.revolutions": 260,
    }
    scene = load_scene("goncharov_balls").replace(two)
    device, speed, at = scene.assembly().weights[0].device, scene.profile().end, 4.0
    new = cmath.rect(0.3, math.radians(25))
    change = {"time": at, "amount": abs(new), "angle": cmath.phase(new)}
    scene = scene.replace({"operation.unbalance_changes": [change]})
    run = cosimulate(scene, record=["balls.moment_xi", "balls.moment_eta"])
    moment = run["balls.moment_xi"] + 1j * run["balls.moment_eta"]
    left = np.abs(moment + new) / abs(new)
    assert left[run.time >= at][0] > 0.3
    factor = critical_drag_factor(scene.assembly().loaded_rotor, speed, device.kappa)
    half = math.acos(abs(new) / device.point_capacity)  # of the angle between the balls
    root = slow_root(device, abs(math.cos(2.0 * half)), factor).real
    first, last = (run.time[np.flatnonzero(left > part)[-1]] for part in (1e-2, 1e-5))
    assert last - first == pytest.approx(
        math.log(1e3) / -root, rel=0.04
    )  # (1) leaves the rotor's damping out
    assert at < first < run.time[-1] - 1.0


@pytest.mark.parametrize(
    ("what", "refused"),
    [
        (lambda scene: scene.speeds(800, 900), "speeds is that of one unbalance"),
        (
            lambda scene: scene.map("speed=800:900:2", "weights.drag=1:2:2"),
            "growth rates is that of one unbalance",
        ),
        (lambda scene: separate(scene), "SSP sets parameters at the start alone"),
        (lambda scene: weights_of(scene), "unbalance_changes: must be left out"),
    ],
)
def test_what_takes_one_unbalance_refuses_by_name(what, refused):
    with pytest.raises(SceneError, match=f"operation.unbalance_changes.*{refused}|{refused}"):
        what(changed("two_balls"))


@pytest.mark.parametrize(
    ("changes", "wrong"),
    [
        ([{"time": 2, "amount": 1}, {"time": 1, "amount": 1}], "times must not fall"),
        ([{"time": 0, "amount": 1}], r"\[1\].time = 0 s: must be greater than 0"),
        ([{"time": 1, "amount": 1, "number": 2}], r"\[1\].number = 2: must be at most 1"),
    ],
)
def test_wrong_changes_are_named(changes, wrong):
    with pytest.raises(SceneError, match=wrong):
        load_scene("two_balls").replace({"operation.unbalance_changes": changes})
    motor = load_scene("sommerfeld")
    with pytest.raises(SceneError, match="not with a motor"):
        motor.replace({"operation.unbalance_changes": [{"time": 1, "amount": 1}]})


def test_a_later_unbalance_beyond_the_capacity_is_implausible():
    big = {"operation.unbalance_changes": [{"time": 3, "amount": 1.0}]}
    (line,) = implausible(load_scene("two_balls").replace(big))
    assert "to balance from 3 s on, the weights hold at most" in line
