"""Maps of runs: every point is the run of its own scene; a store is gone on with."""

import csv

import numpy as np
import pytest

from autobalancer.harness import UserError, cosimulate, load_scene
from autobalancer.harness.stability import run_map as module
from autobalancer.harness.stability.axis import Axis
from autobalancer.harness.stability.run_map import run_map

pytestmark = pytest.mark.slow


@pytest.fixture
def scene():
    return load_scene("two_balls").replace({"run.revolutions": 8})


@pytest.mark.parametrize("speed_is", ["x", "y"])
def test_every_point_is_the_run_of_its_own_scene(scene, speed_is):
    speed, drag = Axis.parse("speed=2.5:4:3"), Axis.parse("weights.drag=1e-3:1e-1:2:log")
    x, y = (speed, drag) if speed_is == "x" else (drag, speed)
    data = run_map(scene, x, y)
    assert data.residual.shape == (len(y.values), len(x.values))
    for (j, i), residual in np.ndenumerate(data.residual):
        run = cosimulate(scene.replace({x.path: x.values[i], y.path: y.values[j]}))
        motion = np.hypot(run["rotor.x"], run["rotor.y"])
        assert residual == pytest.approx(motion[-20:].max(), abs=1e-4 * motion.max())


@pytest.mark.parametrize("gravity", [0.0, 9.81])
def test_bare_rotors_keep_their_response(scene, gravity):
    """Without balancers and transient: A = U w^2 / |k - M w^2 + i c w|, about the sag."""
    bare = scene.without_balancers().replace(
        {"rotor.mass": 2.0, "rotor.stiffness": 800.0, "run.revolutions": 200}
    )
    bare = bare.replace({"operation.speed": 50.0, "operation.gravity": gravity})
    x, y = Axis.parse("rotor.unbalance=0.01:0.03:3"), Axis.parse("rotor.damping=10:20:2")
    data = run_map(bare, x, y)
    expected = x.values * 2500.0 / np.abs(800.0 - 5000.0 + 50j * y.values[:, None])
    np.testing.assert_allclose(data.residual, expected, rtol=1e-6)
    assert data.settled.all()


@pytest.mark.parametrize(
    ("x", "y", "said"),
    [
        ("speed=1:2:3", "speed=1:2:3", "both axes are the same"),
        ("speed=0:2:3", "weights.drag=1:2:3", "must be greater than 0"),
        ("speed=1:2:3", "run.revolutions=2:4:3", "cannot be varied; must be speed or begin with"),
        ("weights.mass=-1:2:3", "weights.drag=1:2:3", "greater than 0"),
    ],
)
def test_axes_that_cannot_be_are_refused(scene, x, y, said):
    with pytest.raises(UserError, match=said):
        run_map(scene, Axis.parse(x), Axis.parse(y))


def test_a_run_that_fails_costs_its_point_alone(scene):
    """A support whose force exceeds all numbers."""
    x, y = Axis.parse("rotor.stiffness[1]=1:1e59:2"), Axis.parse("weights.drag=0.01:0.02:2")
    data = run_map(scene, x, y)
    assert all("is not finite" in text for text in data.failure[:, 1])
    np.testing.assert_array_equal(data.failure != "", [[False, True]] * 2)
    np.testing.assert_array_equal(np.isnan(data.residual), [[False, True]] * 2)


def test_a_store_that_was_ended_is_gone_on_with_to_the_same_map(scene, interrupted_once, tmp_path):
    x, y = Axis.parse("speed=2.5:4:3"), Axis.parse("weights.drag=1e-3:1e-1:4:log")
    whole, done = run_map(scene, x, y), interrupted_once(module, "_row", 2)
    with pytest.raises(KeyboardInterrupt):
        run_map(scene, x, y, store=tmp_path / "map.store")
    resumed = run_map(scene, x, y, store=tmp_path / "map.store")
    assert len(done) == 4
    assert resumed.residual.tobytes() == whole.residual.tobytes()
    assert resumed.settled.tobytes() == whole.settled.tobytes()


def test_command_draws_runs(invoke, tmp_path, monkeypatch):
    monkeypatch.setattr("os.cpu_count", lambda: 1)
    picture, table = tmp_path / "map.png", tmp_path / "map.csv"
    axes = ("--x", "speed=2.5:4:4", "--y", "weights.drag=1e-3:1e-1:3:log")
    outcome = invoke(
        "map", "two_balls", *axes, "--method", "cosim-run", "-o", picture, "--csv", table
    )
    assert outcome.exit_code == 0, outcome.output
    assert "12 runs in C as one composite" in outcome.output
    assert picture.read_bytes().startswith(b"\x89PNG")
    with table.open() as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == 12
    assert all(float(row["residual amplitude [m]"]) > 0.0 for row in rows)
