"""Speeds along a profile: both engines, the one file as a host steps it, its length, its energy."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from autobalancer.harness import Scene, SceneError, UserError, cosimulate, load_scene
from autobalancer.harness.master.one_file import composition
from autobalancer.harness.master.schedule import end_time, milestones
from autobalancer.harness.result.many import cosimulate_many
from autobalancer.harness.scene.trace import TraceNote, corners_of
from autobalancer.models.monolith import reference
from tests.energy import balance, signals

CORNERS = [[0, 0], [0.5, 110], [0.62, 110], [0.9, 0], [0.97, 0], [1.3, 60]]


@pytest.fixture
def scene():
    changes = {"operation.profile": CORNERS, "run.revolutions": None, "coupling.tolerance": 1e-5}
    return load_scene("run_up").replace(changes)


@pytest.mark.parametrize(
    ("separate", "coupling"),
    [(False, {}), (True, {}), (True, {"coupling.scheme": "compensated"})],
)
def test_a_run_follows_its_profile_to_standstill_and_up_again(scene, separate, coupling):
    steps = {"coupling.steps_per_rev": 40} if coupling else {}
    scene = scene.replace({**coupling, **steps})
    run = cosimulate(scene, separate=separate)
    assert run.time[-1] == 1.3
    assert set(milestones(scene)) <= set(run.time)
    right, own = reference(
        scene.assembly(), scene.operation.drive(), run.time, rtol=1e-10, bound=1e-6
    )
    for name in run.signals:
        error = np.abs(run[name] - right.signal(name)).max() / np.abs(right.signal(name)).max()
        assert error < (3.0 * max(run.estimated_error, own) if not coupling else 1e-5)


def test_angles_at_many_times_are_the_integral_of_the_speed(scene):
    times = np.linspace(0.0, 1.4, 1401)  # every corner is among them: trapezoids are exact
    profile = scene.profile()
    speeds = profile.speeds_at(times)
    assert speeds.tolist() == pytest.approx([profile.speed(t) for t in times], abs=1e-9)
    right = np.append(0.0, np.cumsum(0.5 * np.diff(times) * (speeds[1:] + speeds[:-1])))
    assert profile.angles_at(times).tolist() == pytest.approx(right.tolist(), abs=1e-9)


def test_one_file_follows_its_profile_whatever_the_steps_of_its_host(scene):
    """1.3 s in 80 steps or so: no corner is the end of one."""
    fine = scene.replace({"coupling.steps_per_rev": 80})
    names = ["rotor.x", "rotor.y", "weights.moment_xi", "rotor.speed"]
    found = cosimulate_many(fine, {"weights.drag": [0.3]}, results=names)
    run = cosimulate(fine, record=names[:3])
    assert found["rotor.speed"][0] == pytest.approx(60.0, rel=1e-14)
    for name in names[:3]:
        assert found[name][0] == pytest.approx(run[name][-1], abs=1e-5 * np.abs(run[name]).max())
    assert composition(scene).layout.index["corner[4].speed"]


def test_corners_of_one_file_that_do_not_ascend_are_refused(scene):
    found = cosimulate_many(scene, {"corner[2].time": [0.62, 0.5]}, results=["rotor.speed"])
    assert "corner[k].time: must ascend" in found["failure"][1]


def test_a_run_without_revolutions_ends_with_its_profile(scene):
    assert end_time(scene) == 1.3
    turned = 0.5 * 55 + 0.12 * 110 + 0.28 * 55 + 0.33 * 30
    assert scene.revolutions == pytest.approx(turned / math.tau)
    part = scene.replace({"run.revolutions": 0.5 * 55 / math.tau})
    assert end_time(part) == pytest.approx(0.5)
    stops = {"operation.profile": CORNERS[:5]}
    assert end_time(scene.replace({**stops, "run.revolutions": 8.9})) < 0.9
    with pytest.raises(SceneError, match=r"ends at rest after 8.92859 revolutions"):
        scene.replace({**stops, "run.revolutions": 9})


def test_a_measured_speed_becomes_few_lines_that_say_how_far_they_are_off(scene, tmp_path):
    time = np.linspace(2.0, 3.3, 1301)
    speed = np.interp(time - 2.0, *np.transpose(CORNERS)) * 30.0 / math.pi
    rows = "\n".join(
        f"{t},{s + 0.3 * math.sin(1e3 * t)}" for t, s in zip(time, abs(speed), strict=True)
    )
    rows = rows.replace(",-", ",")
    (tmp_path / "trace.csv").write_text(f"time_s,speed_rpm\n{rows}\n")
    (tmp_path / "mine.toml").write_text(scene.replace({"operation.profile": [[0, 0], [1, 1]]}).toml)
    loaded = load_scene(tmp_path / "mine.toml")
    with pytest.warns(
        TraceNote, match=r"1301 readings are approximated by 5 lines, .* by 1\.\d* rpm at most"
    ):
        traced = loaded.replace({"operation.profile": "trace.csv"}).profile()
    assert traced.times == pytest.approx([corner[0] for corner in CORNERS], abs=0.011)
    assert traced.speeds == pytest.approx([corner[1] for corner in CORNERS], abs=1.2)
    (tmp_path / "trace.csv").write_text("time_s,rpm\n0,1\n")
    with pytest.raises(SceneError, match=r"rpm: unknown column \(did you mean speed \[rpm\]\?\)"):
        loaded.replace({"operation.profile": "trace.csv"})


def test_a_measured_speed_on_lines_is_said_to_lie_on_them(tmp_path):
    (tmp_path / "trace.csv").write_text("time [s],speed [rad/s]\n0,0\n1,50\n2,100\n")
    with pytest.warns(TraceNote, match=r"^trace\.csv: 3 readings lie on 1 line$") as warned:
        corners_of(tmp_path / "trace.csv")
    assert warned[0].filename == __file__


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        (["0,0", "2,"], "line 3: speed .rpm.: must be a number; the cell is empty"),
        (["0,0", "2,9", "1,9"], "line 4: time = 1 s, after 2 s: times must ascend"),
        (["0,-5", "2,9"], "line 2: speed = -5 rpm: must be 0 or more"),
        (["0,0", "2,0"], "every speed is 0: must be above 0 somewhere"),
        (["0,0"], "one reading: must have two at least"),
    ],
)
def test_a_measured_speed_that_is_none_is_refused_with_its_line(tmp_path, rows, words):
    (tmp_path / "trace.csv").write_text("\n".join(["time [s],speed [rpm]", *rows]))
    with pytest.raises(UserError, match=words):
        corners_of(tmp_path / "trace.csv")


def test_a_measured_speed_that_begins_later_says_so(tmp_path):
    (tmp_path / "trace.csv").write_text("time [s],speed [rpm]\n1,0\n2,300\n")
    with pytest.warns(TraceNote, match="times count from the first reading, at 1 s"):
        corners = corners_of(tmp_path / "trace.csv")
    assert [time for time, _ in corners] == [0.0, 1.0]


def test_energy_is_accounted_for_in_a_run_down_with_gravity_and_contacts():
    """Between corners and events: an impact loses what its restitution says, in no time."""
    weights = {"kind": "balls", "count": 3, "mass": 0.05, "track_radius": 0.1, "drag": 0.2}
    scene = Scene.from_document(
        {
            "rotor": {"kind": "planar", "mass": 2.0, "stiffness": [8e3, 6e3], "damping": 30.0,
                      "unbalance": 2e-3},
            "balancer": [weights | {"name": "weights", "weight_radius": 0.02, "restitution": 0.5}],
            "operation": {"profile": [[0, 20], [0.3, 80], [0.4, 80], [0.8, 0], [0.9, 0]],
                          "gravity": 9.81},
            "coupling": {"steps_per_rev": 400},
        }
    )  # fmt: skip
    run = cosimulate(scene, record=signals(scene))
    changes = np.diff([run[f"weights.weight[{k}].speed"] for k in (1, 2, 3)])
    strikes = 1 + np.flatnonzero((np.abs(np.diff(changes, prepend=0.0)) > 0.3).any(axis=0))
    corners = np.searchsorted(run.time, scene.profile().times)
    cuts = np.unique([0, *corners, *strikes, len(run.time)])
    pieces = [slice(a, b) for a, b in pairwise(cuts) if b - a > 8]
    missing, energies = 0.0, []
    for piece in pieces:
        part = {name: run[name][piece] for name in run.signals}
        energy, work = balance(scene, _Part(run.time[piece], part))
        missing += float(np.abs(energy - energy[0] - work).max())
        energies += [energy.min(), energy.max()]
    assert len(strikes) > 5
    assert sum(p.stop - p.start for p in pieces) > 0.95 * len(run.time)
    assert missing < 1e-6 * (max(energies) - min(energies))


class _Part(dict):
    """Signals of a part of a run."""

    def __init__(self, time, recorded):
        super().__init__(recorded)
        self.time = time
