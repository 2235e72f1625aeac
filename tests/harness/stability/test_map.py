"""Stability maps: what stands on the axes, in the grid, and in the files."""

import csv

import numpy as np
import pytest

from autobalancer.harness import UserError, load_scene
from autobalancer.harness.stability.axis import Axis
from autobalancer.harness.stability.map import stability_map
from autobalancer.models.stability import growth_rates

pytestmark = pytest.mark.slow


@pytest.fixture
def one_process(monkeypatch):
    monkeypatch.setattr("os.cpu_count", lambda: 1)


def test_axis_is_read_as_it_is_written():
    axis = Axis.parse("speed=0.5:12:24")
    assert (axis.path, axis.log) == ("operation.speed", False)
    np.testing.assert_allclose(axis.values, np.linspace(0.5, 12.0, 24))
    axis = Axis.parse("weights.drag=1e-4:1:5:log")
    np.testing.assert_allclose(axis.values, [1e-4, 1e-3, 1e-2, 1e-1, 1.0])


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("speed", "PATH=LOW:HIGH:N"),
        ("speed=1:2", "PATH=LOW:HIGH:N"),
        ("speed=1:2:x", "PATH=LOW:HIGH:N"),
        ("speed=1:2:9:lin", "PATH=LOW:HIGH:N"),
        ("speed=2:1:9", "rising"),
        ("speed=1:nan:9", "finite"),
        ("speed=0:1:9:log", "above 0"),
        ("speed=1:2:1", "N = 1"),
    ],
)
def test_a_wrong_axis_is_said(text, said):
    with pytest.raises(UserError, match=said):
        Axis.parse(text)


def test_an_unknown_path_of_an_axis_is_named_before_its_units():
    known = r"unknown .*begins with one of: rotor, operation, coupling, run, weights"
    with pytest.raises(UserError, match=known):
        Axis.parse("wights.drag=0.1 N s/m:1 N s/m:3", load_scene("two_balls"))


def test_machines_without_weights_are_called_stable_and_not_balanced():
    weights, ring = load_scene("filimonikhina"), load_scene("washing_machine_ring")
    speed = Axis.parse("speed=20:60:2")
    (line, *_) = stability_map(ring, speed, Axis.parse("rotor.mass=1:2:2", ring)).lines()
    assert "balanced" not in line
    assert "stable, " in line
    assert "no weights" in line
    (line, *_) = stability_map(weights, speed, Axis.parse("rotor.mass=1:2:2", weights)).lines()
    assert " balanced, " in line


def test_labels_carry_units():
    scene = load_scene("filimonikhina")
    texts = {
        "speed=1:2:3": "speed [rad/s]",
        "weights.drag=1:2:3": "weights.drag [N s/m]",
        "rotor.stiffness[2]=1:2:3": "rotor.stiffness[2] [N/m]",
        "weights.count=1:2:3": "weights.count",
    }
    assert {text: Axis.parse(text).label(scene) for text in texts} == texts


@pytest.mark.parametrize("speed_is", ["x", "y", "neither"])
def test_every_point_is_that_of_its_own_scene(speed_is):
    scene = load_scene("filimonikhina")
    speed, drag = Axis.parse("speed=1.5:9:4"), Axis.parse("weights.drag=1e-3:1e-1:3:log")
    stiffness = Axis.parse("rotor.stiffness[2]=30:60:4")
    x, y = {"x": (speed, drag), "y": (drag, speed), "neither": (stiffness, drag)}[speed_is]
    data = stability_map(scene, x, y)
    assert data.growth.shape == (len(y.values), len(x.values))
    for j, b in enumerate(y.values):
        for i, a in enumerate(x.values):
            one = scene.replace({x.path: a, y.path: b})
            expected = growth_rates(one.assembly(), one.profile().end)[0]
            assert data.growth[j, i] == pytest.approx(expected, rel=1e-9)


def test_criterion_changes_sign_at_its_own_roots():
    x, y = Axis.parse("speed=0.9:8:800"), Axis.parse("weights.drag=1e-3:1e-2:2")
    data = stability_map(load_scene("filimonikhina"), x, y)
    row = data.criterion[0]
    change = np.flatnonzero(np.diff(np.sign(row)))
    # Filimonikhina 2017, Table 1
    np.testing.assert_allclose(x.values[change], [1.003, 5.041, 6.925], atol=0.011)


def test_weights_that_cannot_balance_are_not_a_number():
    x, y = Axis.parse("speed=2:4:2"), Axis.parse("rotor.unbalance=0.001:0.02:3")
    data = stability_map(load_scene("filimonikhina"), x, y)
    assert np.isfinite(data.growth[0]).all()
    assert np.isnan(data.growth[1:]).all()


def test_command_writes_picture_and_points(invoke, tmp_path, one_process):
    picture, table = tmp_path / "map.png", tmp_path / "map.csv"
    outcome = invoke(
        "map", "filimonikhina", "--x", "speed=0.9:12:12", "--y", "weights.drag=1e-3:1:6:log",
        "-o", picture, "--csv", table,
    )  # fmt: skip
    assert outcome.exit_code == 0, outcome.output
    assert picture.read_bytes().startswith(b"\x89PNG")
    with table.open() as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == 72
    assert float(rows[0]["speed [rad/s]"]) == 0.9
    for row in rows:
        assert row["criterion"] in {"stable", "unstable"}


def test_command_draws_a_map_without_criterion_and_with_gaps(invoke, tmp_path, one_process):
    picture = tmp_path / "map.svg"
    outcome = invoke(
        "map", "three_mass_shaft", "--x", "speed=1:6:5", "--y", "rotor.internal_damping=0:0.2:3",
        "-o", picture,
    )  # fmt: skip
    assert outcome.exit_code == 0, outcome.output
    assert "criterion: does not apply" in outcome.output
    assert picture.stat().st_size > 1000


def test_a_map_from_speed_zero_is_refused_in_words():
    with pytest.raises(UserError, match="speed = 0 rad/s: must be greater than 0"):
        stability_map(
            load_scene("two_balls"),
            Axis.parse("speed=0:10:3"),
            Axis.parse("weights.drag=1:2:2"),
        )


@pytest.mark.parametrize("axes", [("speed", "weights.drag"), ("weights.drag", "rotor.mass")])
def test_a_point_that_cannot_be_solved_costs_itself_alone(monkeypatch, axes):
    from autobalancer.harness.stability import map as module

    solve, scene = module.growth_map_with_errors, load_scene("two_balls")
    spans = {
        "speed": "speed=5:11:3",
        "weights.drag": "weights.drag=0.01:0.1:4:log",
        "rotor.mass": "rotor.mass=0.5:1.5:3",
    }
    x, y = (Axis.parse(spans[name]) for name in axes)
    whole = stability_map(scene, x, y)
    at = {x.path: 1, y.path: 2}
    unwanted = scene.replace({axis.path: axis.values[at[axis.path]] for axis in (x, y)})

    def fails(assemblies, speeds):
        for assembly in assemblies:
            same = assembly.balancers == unwanted.assembly().balancers
            mass = (assembly.rotor.mass == unwanted.assembly().rotor.mass).all()
            if same and mass and unwanted.profile().end in speeds:
                raise np.linalg.LinAlgError("Eigenvalues did not converge")
        return solve(assemblies, speeds)

    monkeypatch.setattr(module, "growth_map_with_errors", fails)
    data = stability_map(scene, x, y)
    assert data.failure[2, 1] == "Eigenvalues did not converge"
    assert any(line.startswith("1 without a verdict") for line in data.lines())
    others = data.failure == ""
    assert others.sum() == others.size - 1
    assert np.isnan(data.growth[2, 1])
    assert np.array_equal(data.growth[others], whole.growth[others])
