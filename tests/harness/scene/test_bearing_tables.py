"""Bearings over the speed in scenes: tables, files, journal bearings, and what refuses them."""

from __future__ import annotations

import numpy as np
import pytest

import autobalancer as ab
from autobalancer.harness import SceneError, UserError, cosimulate
from autobalancer.harness.master.plan import plan
from autobalancer.harness.scene.bearing import heads
from autobalancer.models.monolith import simulate

ROWS = [
    [50.0, 1e5, 2e3, -1e3, 1.2e5, 60, 5, 5, 80],
    [150.0, 1.4e5, 5e3, -6e3, 1.0e5, 80, 2, 1, 90],
    [300.0, 1.6e5, 3e3, -2e3, 2.0e5, 70, 2, 3, 60],
    [400.0, 1.5e5, 3e3, -2e3, 2.1e5, 90, 2, 3, 60],
]
BALLS = {
    "name": "balls", "kind": "balls", "count": 2, "mass": 0.02, "track_radius": 0.08, "drag": 0.5,
    "angles": [1.0, 2.8],
}  # fmt: skip
ROTOR = {"kind": "planar", "mass": 10.0, "unbalance": 1e-3, "bearings": [{"table": ROWS}]}
JOURNAL = {"diameter": 0.1, "length": 0.03, "clearance": 1e-4, "viscosity": 0.1,
           "speeds": [100.0, 900.0]}  # fmt: skip


def machine(operation, rotor=ROTOR, **run):
    return ab.Scene(
        rotor=rotor, balancer=[BALLS], operation=operation, run=run or {"revolutions": 8}
    )


def test_at_a_constant_speed_both_engines_move_as_with_the_matrices_of_that_speed():
    scene = machine({"speed": 200.0})
    here = scene.assembly().rotor.at(200.0)
    bearing = {"stiffness": here.springs[..., 0, 0], "damping": here.dampers[..., 0, 0]}
    fixed = cosimulate(scene.replace({"rotor.bearings": [bearing]}))
    one, several = (cosimulate(scene, separate=choice) for choice in (False, True))
    size = np.abs(fixed["rotor.x"]).max()
    assert one["rotor.x"] == pytest.approx(fixed["rotor.x"], abs=1e-10 * size)
    assert several["rotor.x"][-1] == pytest.approx(fixed["rotor.x"][-1], abs=1e-4 * size)
    assert plan(scene).units[0].sizes["speeds"] == 4


@pytest.mark.parametrize(
    "operation",
    [
        {"profile": [[0, 60.0], [0.6, 390.0], [0.9, 140.0]]},
        {"motor": {"inertia": 0.2, "table": [[0, 120.0], [200.0, 90.0], [390.0, 0.0]], "from": 60}},
    ],
    ids=["profile", "motor"],
)
def test_a_run_through_the_rows_of_a_table_is_that_of_an_independent_integration(operation):
    scene = machine(operation, duration=1.0)
    run = cosimulate(scene)
    apart = simulate(
        scene.assembly(), scene.operation.drive(), run.time, method="odeint", rtol=1e-10
    )
    for axis, values in (("x", apart.x), ("y", apart.y)):
        assert run[f"rotor.{axis}"] == pytest.approx(values[:, 0], abs=1e-4 * np.abs(values).max())


def test_a_file_of_any_units_is_the_same_table_and_is_kept_when_the_scene_is_saved(tmp_path):
    head = "speed [rpm],kxx [kN/m],kxy [kN/m],kyx [kN/m],kyy [kN/m]"
    head += ",cxx [N s/m],cxy [N s/m],cyx [N s/m],cyy [N s/m]"
    lines = [
        ",".join(f"{v:.15g}" for v in [row[0] * 30.0 / np.pi, *np.divide(row[1:5], 1e3), *row[5:]])
        for row in ROWS
    ]
    (tmp_path / "b.csv").write_text("\n".join([head, *lines]))
    document = machine({"speed": 200.0}).document
    document["rotor"]["bearings"] = [{"table": "b.csv"}]
    scene = ab.Scene.from_document(document, path=tmp_path / "scene.toml")
    assert np.array(scene.rotor.bearings[0].table) == pytest.approx(np.array(ROWS), rel=1e-12)
    again = ab.load(scene.save(tmp_path / "again.toml"))
    assert again.rotor.bearings == scene.rotor.bearings


def test_a_journal_bearing_carries_its_share_of_the_weight():
    rotor = ROTOR | {"bearings": [{"journal": JOURNAL}]}
    own = machine({"speed": 200.0}, rotor).assembly().rotor.at(200.0)
    said = ROTOR | {"bearings": [{"journal": JOURNAL | {"load": 10.0 * 9.80665}}]}
    expected = machine({"speed": 200.0}, said).assembly().rotor.at(200.0)
    assert own.springs == pytest.approx(expected.springs)


@pytest.mark.parametrize(
    ("bearing", "words"),
    [
        ({"table": ROWS[:1]}, "two rows or more"),
        ({"table": ROWS[::-1]}, "ascend"),
        ({"table": ROWS, "stiffness": [[1, 0], [0, 1]]}, "give one of"),
        ({}, "give one of"),
        ({"table": ROWS, "damping": [[1, 0], [0, 1]]}, "belongs to stiffness"),
        ({"table": "none.csv"}, r"rotor\.bearings\[1\]\.table: none\.csv: no such file; its path"),
        ({"table": ""}, r'rotor\.bearings\[1\]\.table: "": must not be empty: name a CSV file'),
        ({"journal": JOURNAL | {"length": 0.08}}, r"at most 0\.5 diameters"),
        ({"journal": JOURNAL | {"speeds": [9.0, 5.0]}}, "must ascend"),
    ],
)
def test_tables_that_cannot_be_are_refused(bearing, words):
    with pytest.raises(SceneError, match=words):
        machine({"speed": 200.0}, ROTOR | {"bearings": [bearing]})


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        ([ROWS[0]], "t.csv: one row: must have two or more"),
        (
            [ROWS[1], ROWS[0]],
            "t.csv, line 3: speed = 50 rad/s, after 150 rad/s: speeds must ascend",
        ),
        ([[-1.0, *ROWS[0][1:]], ROWS[1]], "t.csv, line 2: speed = -1 rad/s: must be 0 or more"),
    ],
    ids=["one", "back", "negative"],
)
def test_a_file_that_is_no_table_is_refused_with_its_line_and_nothing_else(rows, words, tmp_path):
    lines = [heads(), *(",".join(map(str, row)) for row in rows)]
    (tmp_path / "t.csv").write_text("\n".join(lines))
    document = machine({"speed": 200.0}).document
    document["rotor"]["bearings"] = [{"table": "t.csv"}]
    with pytest.raises(SceneError) as said:
        ab.Scene.from_document(document, path=tmp_path / "scene.toml")
    assert words in str(said.value)
    assert "\n" not in str(said.value)


def test_beside_a_wrong_bearing_no_stiffness_is_missing():
    with pytest.raises(SceneError) as said:
        machine({"speed": 200.0}, ROTOR | {"bearings": [{"table": ROWS[:1]}]})
    assert "rotor.stiffness" not in str(said.value)


@pytest.mark.parametrize(
    ("operation", "speeds"),
    [({"speed": 30.0}, "30"), ({"profile": [[0, 60.0], [1.0, 410.0]]}, "60 to 410")],
    ids=["low", "high"],
)
def test_a_run_outside_the_table_is_refused_with_the_way_out(operation, speeds):
    with pytest.raises(SceneError) as said:
        machine(operation)
    assert (
        f"operation: turns at {speeds} rad/s: must be within 50 to 400 rad/s, the speeds of the "
        "bearings' tables; change the operation, or give the tables rows for these speeds"
    ) in str(said.value)


def test_separate_units_follow_a_speed_through_the_rows_and_back():
    scene = machine({"profile": [[0, 60.0], [0.6, 390.0], [0.9, 140.0]]}, duration=1.0)
    one, several = (cosimulate(scene, separate=choice) for choice in (False, True))
    size = np.abs(one["rotor.x"]).max()
    assert several["rotor.x"][-1] == pytest.approx(one["rotor.x"][-1], abs=3e-4 * size)


def test_what_knows_no_table_says_so():
    scene = machine({"speed": 200.0})
    with pytest.raises(SceneError, match="bearings"):
        scene.replace({"coupling.units": "python"})


def test_a_film_over_speeds_that_fall_is_refused_by_the_name_of_the_command():
    size = {"diameter": 0.1, "length": 0.03, "clearance": 1e-4, "viscosity": 0.1, "load": 525.0}
    with pytest.raises(ab.UserError, match=r"^bearing: speeds = .*must ascend"):
        ab.find_film(**size, speeds=(400.0, 100.0))


def test_a_film_is_saved_as_a_table_that_a_scene_reads(tmp_path):
    film = ab.find_film(
        diameter="100 mm", length="30 mm", clearance="0.1 mm", viscosity="0.1 Pa s", load="525 N",
        speeds=("500 rpm", "12000 rpm"),
    )  # fmt: skip
    path = film.save(tmp_path / "b.csv")
    document = machine({"speed": 200.0}).document
    document["rotor"]["bearings"] = [{"table": path.name}]
    scene = ab.Scene.from_document(document, path=tmp_path / "scene.toml")
    assert np.array(scene.rotor.bearings[0].table) == pytest.approx(film.rows, rel=1e-9)
    # half a turn of Lund's threshold for a small eccentricity, 2.741279 sqrt(g/c)
    assert film.threshold == pytest.approx(2.741279 * np.sqrt(9.80665 / 1e-4), rel=0.01)


def test_the_threshold_of_a_film_is_that_of_the_film_wherever_its_rows_are():
    """Rows are 4 % apart, and where the first does not whirl at any mass none can be between."""
    size = {"diameter": 0.05, "length": 0.015, "clearance": 8e-5, "viscosity": 0.02, "load": 40.0}
    found = [
        ab.find_film(**size, speeds=(low, 5000.0)).threshold for low in np.geomspace(30, 33.0, 9)
    ]
    assert found == pytest.approx([found[0]] * len(found), rel=1e-8)


@pytest.mark.parametrize(
    ("low", "said"),
    [
        ("500rpm", "from 863.2 rad/s = 8243 rpm on"),
        ("9000rpm", "at 942.5 rad/s = 9000 rpm already"),
    ],
)
def test_whirl_below_the_first_row_is_not_said_to_be_none(invoke, low, said):
    size = ["--diameter", "100mm", "--length", "30mm", "--clearance", "0.1mm", "--load", "525N"]
    outcome = invoke("bearing", *size, "--viscosity", "0.1", "--range", low, "12000rpm")
    assert said in " ".join(outcome.stdout.split())


def test_speeds_beyond_the_rows_are_refused_with_the_rows():
    with pytest.raises(UserError, match=r"range 50 to 400 .* within 104\.72 to 1047\.2 rad/s"):
        ab.load("small_turbine").speeds(50.0, 400.0)
