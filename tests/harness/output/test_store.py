"""A store lasts: what it holds is not worked for again, and what is foreign is refused in words."""

from __future__ import annotations

import math
import sqlite3
from contextlib import closing

import numpy as np
import pytest
from typer.testing import CliRunner

from autobalancer.harness import UserError, load_scene
from autobalancer.harness.__main__ import program
from autobalancer.harness.output.store import open_store
from autobalancer.harness.output.workers import in_order
from autobalancer.harness.stability.axis import Axis
from autobalancer.harness.stability.map import stability_map

pytestmark = pytest.mark.slow

ITEMS = [0.5, 1.5, -1.0]
begun: list[float] = []


def root(number: float) -> tuple[float, str]:
    begun.append(number)
    return (math.sqrt(number), "") if number >= 0.0 else (math.nan, "négative\n")


def roots(path, made_for="roots"):
    begun.clear()
    return in_order(root, ITEMS, kept=open_store(path, {"content": made_for}))


def test_outcomes_come_back_and_nothing_is_worked_for_twice(tmp_path):
    first = roots(tmp_path / "a.store")
    assert begun == ITEMS
    with sqlite3.connect(tmp_path / "a.store") as file:  # as if killed before it was finished
        file.execute("DELETE FROM outcome WHERE item = 1")
    again = roots(tmp_path / "a.store")
    assert begun == ITEMS[1:2]
    assert str(again) == str(first)
    assert first[2][1] == "négative\n"


def test_progress_counts_what_a_store_has(tmp_path):
    seen: list[float] = []
    store = open_store(tmp_path / "a.store", {})
    store[1] = root(1.5)
    in_order(root, ITEMS, 1, seen.append, store)
    assert seen == pytest.approx([1 / 3, 2 / 3, 1.0])


def test_a_store_of_something_else_is_refused(tmp_path):
    roots(tmp_path / "a.store")
    with pytest.raises(UserError, match="made for another content: 'roots' there, 'logs' now"):
        roots(tmp_path / "a.store", "logs")


def test_a_store_of_other_sources_is_refused(tmp_path, monkeypatch):
    roots(tmp_path / "a.store")
    monkeypatch.setattr("autobalancer.harness.output.store._program", lambda: "autobalancer 0")
    with pytest.raises(UserError, match="made for another program"):
        roots(tmp_path / "a.store")


def test_a_map_of_a_dask_cluster_is_that_of_this_machine(tmp_path):
    cluster = pytest.importorskip("distributed").LocalCluster
    command = ["map", "filimonikhina", "--y", "weights.drag=1e-3:1:3:log", "--x", "speed=2:3:2"]
    with cluster(n_workers=1, processes=False, dashboard_address=None) as dask:
        for name, more in (("here.csv", []), ("there.csv", ["--cluster", dask.scheduler_address])):
            done = CliRunner().invoke(program(), [*command, "--csv", f"{tmp_path}/{name}", *more])
            assert done.exit_code == 0, done.output
    assert (tmp_path / "here.csv").read_bytes() == (tmp_path / "there.csv").read_bytes()


def test_what_is_no_store_is_refused(tmp_path):
    (tmp_path / "a.store").write_text("a year's work\n" * 100)
    with pytest.raises(UserError, match=r"no store that can be continued: .*not a database"):
        roots(tmp_path / "a.store")
    with pytest.raises(UserError, match="no store that can be continued"):
        roots(tmp_path)


DAMAGE = {
    "a bit": "UPDATE outcome SET value = substr(value, 1, 90) || x'ff' || substr(value, 92)",
    "a text": "UPDATE outcome SET value = 'none'",
    "none": "UPDATE outcome SET value = NULL",
    "another item's": "UPDATE outcome SET value = (SELECT value FROM outcome WHERE item = 0), "
    "checksum = (SELECT checksum FROM outcome WHERE item = 0)",
}


@pytest.mark.parametrize("statement", DAMAGE.values(), ids=list(DAMAGE))
def test_a_damaged_outcome_is_refused(tmp_path, statement):
    roots(tmp_path / "a.store")
    with sqlite3.connect(tmp_path / "a.store") as file:
        file.execute(statement)
    with pytest.raises(UserError, match=r"a\.store: is damaged: outcome [01] is not as it was"):
        roots(tmp_path / "a.store")


def test_a_damaged_heading_is_refused(tmp_path):
    roots(tmp_path / "a.store")
    with sqlite3.connect(tmp_path / "a.store") as file:
        file.execute("UPDATE made_for SET words = '{'")
    with pytest.raises(UserError, match="is damaged: what it was made for"):
        roots(tmp_path / "a.store")


def test_the_database_of_another_program_is_left_as_it_is(tmp_path):
    path = tmp_path / "mails.db"
    for statement in ("CREATE TABLE mails (words)", "CREATE TABLE outcome (item, value)"):
        with sqlite3.connect(path) as file:
            file.execute(statement)
        before = path.read_bytes()
        with pytest.raises(UserError, match="a database of another program"):
            roots(path)
        assert path.read_bytes() == before
        assert list(tmp_path.iterdir()) == [path]


def test_a_store_in_use_is_named_as_such(tmp_path, monkeypatch):
    roots(tmp_path / "a.store")
    connect = sqlite3.connect
    with closing(connect(tmp_path / "a.store")) as other:
        other.execute("BEGIN EXCLUSIVE")
        monkeypatch.setattr(sqlite3, "connect", lambda path: connect(path, timeout=0.0))
        with pytest.raises(UserError, match="another program is writing to this store"):
            roots(tmp_path / "a.store")


@pytest.mark.parametrize("speed_is", ["x", "y", "neither"])
def test_a_map_from_its_store_is_the_map(tmp_path, speed_is):
    scene = load_scene("filimonikhina")
    speed, drag = Axis.parse("speed=1.5:9:11"), Axis.parse("weights.drag=1e-3:1e-1:10:log")
    stiffness = Axis.parse("rotor.stiffness[2]=30:60:9")
    x, y = {"x": (speed, drag), "y": (drag, speed), "neither": (stiffness, drag)}[speed_is]
    maps = [stability_map(scene, x, y)]
    maps += [stability_map(scene, x, y, store=tmp_path / "a.store") for _ in range(2)]
    for one in maps[1:]:
        np.testing.assert_array_equal(one.growth, maps[0].growth)
        np.testing.assert_array_equal(one.criterion, maps[0].criterion)
        assert (one.failure == "").all()


def test_points_without_a_rate_keep_their_reasons(tmp_path, monkeypatch):
    def fails(assemblies, speeds):
        raise ValueError(f"not at {speeds[0]:g}")

    monkeypatch.setattr("autobalancer.harness.stability.map.growth_map_with_errors", fails)
    scene, axes = load_scene("filimonikhina"), (Axis.parse("speed=1:2:2"),)
    axes += (Axis.parse("weights.drag=1:2:2"),)
    maps = [stability_map(scene, *axes, store=tmp_path / "a.store") for _ in range(2)]
    for one in maps:
        assert one.failure.tolist() == [["not at 1", "not at 2"]] * 2


def test_the_command_says_whose_store_it_is_and_where_one_cannot_be(tmp_path):
    command = ["map", "filimonikhina", "--y", "weights.drag=1e-3:1:3:log", "--x"]
    path = str(tmp_path / "a.store")
    done = CliRunner().invoke(program(), [*command, "speed=2:3:2", "--store", path])
    assert (done.exit_code, f"Store: {path}" in done.output) == (0, True)
    refused = CliRunner().invoke(program(), [*command, "speed=2:4:2", "--store", path])
    assert refused.exit_code == 2
    assert "'operation.speed = 2.0 to 3.0, 2 values' there" in " ".join(refused.output.split())
    nowhere = CliRunner().invoke(
        program(), [*command, "speed=2:3:2", "--store", "/nowhere/a.store"]
    )
    assert (nowhere.exit_code, "cannot be written" in nowhere.output) == (2, True)
