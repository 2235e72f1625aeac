"""One scene run many times in C: as single runs, in threads, and failures kept."""

from __future__ import annotations

import math
import sys
import threading
import time

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from autobalancer.fmus.composite.batch import BatchRuns
from autobalancer.harness import Scene, UserError, cosimulate, cosimulate_many, load_scene
from autobalancer.harness.master.one_file import composition
from autobalancer.harness.master.schedule import end_time

CLOSE = 1e-4  # what the tolerance of both allows
DRAGS = [0.008, 0.0125, 0.02, 0.05]
UNBALANCES = [0.01, 0.025, 0.03, 0.07]
TABLE = {"weights.drag": np.array(DRAGS), "rotor.unbalance": np.array(UNBALANCES)}


@pytest.fixture
def scene() -> Scene:
    return load_scene("two_balls").replace({"run.revolutions": 12})


def read_evenly(run, place, count):
    """Amplitude of a place at points that divide the run."""
    times = np.linspace(0.0, run.time[-1], count + 1)
    x, y = (CubicSpline(run.time, run[f"{place}{axis}"])(times) for axis in "xy")
    return np.hypot(x, y)


def test_every_row_is_the_run_of_a_scene_with_these_values(scene):
    found = cosimulate_many(
        scene, TABLE, results=["largest", "residual", "error", "weights.spread"]
    )
    assert list(found["failure"]) == [""] * 4
    for k, (drag, unbalance) in enumerate(zip(DRAGS, UNBALANCES, strict=True)):
        changed = scene.replace({"weights.drag": drag, "rotor.unbalance": unbalance})
        one = cosimulate(changed, record=["rotor.x", "rotor.y", "weights.spread"])
        amplitude = read_evenly(one, "rotor.", 12 * 20)
        assert found["largest"][k] == pytest.approx(amplitude.max(), rel=CLOSE)
        assert found["residual"][k] == pytest.approx(
            amplitude[-20:].max(), abs=CLOSE * amplitude.max()
        )
        assert found["weights.spread"][k] == pytest.approx(one["weights.spread"][-1], rel=CLOSE)
        assert 0.0 < found["error"][k] <= 1e-4


@pytest.mark.parametrize("own_steps", [False, True])
def test_a_vibration_at_the_end_is_seen_whatever_is_read_on_the_way(scene, own_steps):
    def vibration(asked, **pacing):
        runs = BatchRuns(composition(scene), [], asked, 50, last=["vibration"], **pacing)
        return runs.with_last(np.empty((2, 0)), np.full(2, 20.0))[1].tolist()

    seen = vibration(["vibration"], own_steps=own_steps)
    assert vibration([], own_steps=own_steps) == vibration(["rotor.x"], own_steps=own_steps) == seen
    assert seen[0][0] > 0.0


def test_each_station_has_its_own_residual():
    scene = load_scene("two_plane_rodrigues").replace({"run.revolutions": 12})
    names = ["rotor.station[1].residual", "rotor.station[2].residual", "residual"]
    found = cosimulate_many(scene, {"speed": [4.0]}, results=names)
    one = cosimulate(scene, record=[f"rotor.station[{k}].{axis}" for k in (1, 2) for axis in "xy"])
    for k in (1, 2):
        size = read_evenly(one, f"rotor.station[{k}].", 12 * 40)
        assert found[names[k - 1]][0] == pytest.approx(size[-40:].max(), rel=CLOSE)
    assert found["residual"][0] == max(found[name][0] for name in names[:2])


def test_more_than_the_memory_holds_is_refused_with_its_key(scene):
    endless = scene.replace({"run.revolutions": 1e20})
    with pytest.raises(UserError, match=r"run\.revolutions = 1e\+20: .* GB of memory"):
        cosimulate_many(endless, TABLE)


def test_a_free_rotor_settles_when_its_damping_says(scene):
    """Without weights that matter the amplitude decays as e^(-c t / 2 M)."""
    scene = scene.replace(
        {
            "run.revolutions": 40,
            "weights.mass": 1e-9,
            "weights.drag": 1e-9,
            "rotor.mass": 1.0,
            "rotor.unbalance": 0.0,
            "rotor.stiffness": 4.0,
            "run.initial.x": 1e-3,
        }
    )
    damping = np.array([0.1, 0.2, 0.4, 0.03])
    found = cosimulate_many(scene, {"rotor.damping_x": damping, "rotor.damping_y": damping})
    period = math.tau / 3.0
    # 5 % of the first amplitude above the last
    left = 0.05 + np.exp(-0.5 * damping * 40 * period)
    expected = -2.0 / damping * np.log(left)
    # in the last revolution the last one still loses e^(-0.6 * 2) of 3 %: more than 0.5 %
    expected[-1] = math.nan
    assert found["settling_time"] == pytest.approx(expected, abs=1.5 * period, nan_ok=True)
    assert list(found["settled"]) == [1.0, 1.0, 1.0, 0.0]


def test_runs_that_fail_say_why_and_the_others_go_on(scene):
    found = cosimulate_many(scene, {"rotor.mass": [0.95, -1.0, 0.95], "speed": [3.0, 3.0, 0.0]})
    assert [bool(reason) for reason in found["failure"]] == [False, True, True]
    assert "rotor.mass = -1.0 kg: must be a finite number above 0 kg" in found["failure"][1]
    assert "coupling.top_speed" in found["failure"][2]
    assert np.isnan(found["residual"]).tolist() == [False, True, True]


def test_a_run_up_is_driven_as_the_scene_says():
    changes = {"coupling.steps_per_rev": 40, "run.revolutions": 40}
    changes |= {"operation.run_up.seconds": 0.5}
    scene = load_scene("run_up").replace(changes)
    one = cosimulate(scene, record=["rotor.x", "rotor.y", "rotor.angle"])
    results = ["largest", "rotor.angle", "rotor.x"]
    found = cosimulate_many(scene, {"weights.drag": [0.3, 0.3]}, results=results)
    assert found["rotor.angle"] == pytest.approx([one["rotor.angle"][-1]] * 2, rel=1e-12)
    scale = np.ptp(one["rotor.x"])
    assert found["rotor.x"] == pytest.approx([one["rotor.x"][-1]] * 2, abs=1e-3 * scale)


def test_a_start_of_minus_zero_is_one_like_another(scene):
    scene = scene.replace({"run.initial.x": -0.0})
    assert list(cosimulate_many(scene, {"weights.drag": [0.01]})["failure"]) == [""]


def test_speed_is_of_each_run_and_so_is_its_length(scene):
    found = cosimulate_many(scene, {"speed": [3.0, 4.0]}, results=["rotor.angle", "coupling.steps"])
    assert found["rotor.angle"] == pytest.approx([12 * math.tau] * 2, rel=1e-12)
    assert (found["coupling.steps"] > 12).all()


def test_threads_change_no_bit_and_leave_the_interpreter_free(scene):
    rng = np.random.default_rng(5)
    table = {"weights.drag": rng.uniform(0.01, 0.05, 200)}
    ticks: list[float] = []
    done = threading.Event()

    def tick() -> None:
        while not done.wait(1e-3):
            ticks.append(time.monotonic())

    watch = threading.Thread(target=tick)
    watch.start()
    runs = [cosimulate_many(scene, table, threads=threads) for threads in (1, 4)]
    done.set()
    watch.join()
    assert len(ticks) > 3
    for name in ("residual", "largest", "error"):
        assert np.array_equal(runs[0][name], runs[1][name])


def test_a_frame_in_is_a_frame_out_with_its_own_columns(scene):
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame(TABLE, index=["a", "b", "c", "d"])
    found = cosimulate_many(scene, frame)
    assert list(found.index) == ["a", "b", "c", "d"]
    pandas.testing.assert_frame_equal(found[list(TABLE)], frame)
    assert found["largest"].to_numpy().tolist() == cosimulate_many(scene, TABLE)["largest"].tolist()


WRONG = [
    ({"weights.drga": [0.1]}, {}, "weights.drga"),
    ({"weights.drag": [0.1]}, {"results": ["residal"]}, "residual"),
    ({"weights.drag": [0.1], "speed": [1.0, 2.0]}, {}, "as many numbers"),
    ({"weights.drag": []}, {}, "at least 1"),
    ({}, {}, "at least 1"),
]


@pytest.mark.parametrize(("table", "options", "text"), WRONG)
def test_wrong_tables_are_refused_with_what_is_allowed(scene, table, options, text):
    with pytest.raises(UserError, match=text):
        cosimulate_many(scene, table, **options)


@pytest.mark.slow
def test_memory_does_not_grow_with_runs(scene):
    resource = pytest.importorskip("resource")
    unit = 1 if sys.platform == "darwin" else 1024
    cosimulate_many(scene, {"weights.drag": np.full(500, 0.0125)})
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    cosimulate_many(scene, {"weights.drag": np.full(5000, 0.0125)})
    grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) * unit
    assert grown < 20e6


@pytest.mark.parametrize("coupling", [{"tolerance": 1e-3}, {"tolerance": 1e-8}])
def test_a_run_is_read_where_its_own_steps_end(coupling):
    """As often as it steps, and as an evenly read run of the same scene that meets these times."""
    scene = load_scene("balls_and_liquid").replace(
        {"run.revolutions": 60, **{f"coupling.{key}": value for key, value in coupling.items()}}
    )
    asked, made, end = ["rotor.x", "balls.moment_xi", "coupling.steps"], composition(scene), 1.5
    none, ends = np.empty((2, 0)), np.full(2, end)
    found, reasons = BatchRuns(made, [], asked, 3000, own_steps=True)(none, ends)
    assert reasons == ["", ""]
    assert np.array_equal(found[0], found[1], equal_nan=True)
    time, x, moment, steps = found[0, ~np.isnan(found[0, :, 0])].T
    assert (time[0], time[-1]) == (0.0, pytest.approx(end))
    assert (np.diff(steps) <= 1).all()
    assert steps[-1] == pytest.approx(len(time), abs=3)
    even, _ = BatchRuns(made, [], asked, 3)(none[:1], ends[:1])
    assert even[0, -1, :2] == pytest.approx([x[-1], moment[-1]], rel=1e-9, abs=1e-16)


def test_a_run_up_is_read_where_its_own_steps_end():
    """Its top is one of them; runs that end there are the other side."""
    scene = load_scene("run_up").replace({"coupling.tolerance": 1e-9})
    made, asked, none = composition(scene), ["rotor.x", "rotor.y"], np.empty((1, 0))
    ends = np.array([end_time(scene)])
    signals, _ = BatchRuns(made, [], asked, 9000, own_steps=True)(none, ends)
    own = signals[0, ~np.isnan(signals[0, :, 0])]
    assert scene.operation.run_up.seconds in own[:, 0]
    some = own[[10, 100, 200, 300, -20, -1]]
    there, _ = BatchRuns(made, [], asked, 1)(np.empty((len(some), 0)), some[:, 0].copy())
    difference = np.abs(there[:, -1] - some[:, 1:]).max(axis=0)
    assert (difference < 1e-9 * np.ptp(own[:, 1:], axis=0)).all()
