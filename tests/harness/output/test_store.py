"""A store lasts: what it holds is not worked for again, and what is foreign is refused in words."""

from __future__ import annotations

import math
import warnings

import numpy as np
import pytest
from typer.testing import CliRunner

from autobalancer.harness import UserError, load_scene
from autobalancer.harness.__main__ import program
from autobalancer.harness.output.store import StoredArray, open_store
from autobalancer.harness.output.workers import in_order
from autobalancer.harness.stability.axis import Axis
from autobalancer.harness.stability.map import stability_map

pytestmark = pytest.mark.slow

pytest.importorskip("zarr")
ITEMS = [0.5, 1.5, -1.0]
PARTS = {
    "number": {
        "root": StoredArray(("number",), (3,), "number", meaning="square root [m]"),
        "why_not": StoredArray(("number",), (3,), "number", "str", meaning="why there is none"),
    }
}
begun: list[float] = []


def root(number: float) -> tuple[float, str]:
    begun.append(number)
    return (math.sqrt(number), "") if number >= 0.0 else (math.nan, "négative\n")


def roots(path, made_for="roots"):
    begun.clear()
    parts = open_store(path, {"content": made_for}, PARTS, {"number": ("number", ITEMS)})
    return in_order(root, ITEMS, kept=parts["number"])


def test_outcomes_come_back_and_nothing_is_worked_for_twice(tmp_path):
    first = roots(tmp_path / "a.zarr")
    assert begun == ITEMS
    (tmp_path / "a.zarr/number_done/c/1").unlink()  # as if killed before it was finished
    again = roots(tmp_path / "a.zarr")
    assert begun == ITEMS[1:2]
    assert str(again) == str(first)
    assert first[2][1] == "négative\n"


def test_xarray_opens_a_store_without_a_warning(tmp_path):
    xarray = pytest.importorskip("xarray")
    roots(tmp_path / "a.zarr")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        data = xarray.open_zarr(tmp_path / "a.zarr")
    np.testing.assert_array_equal(data["root"].sel(number=1.5), math.sqrt(1.5))
    assert data["root"].attrs["long_name"] == "square root [m]"


def test_a_store_of_something_else_is_refused(tmp_path):
    roots(tmp_path / "a.zarr")
    with pytest.raises(UserError, match="made for another content: 'roots' there, 'logs' now"):
        roots(tmp_path / "a.zarr", "logs")


def test_a_store_of_other_sources_is_refused(tmp_path):
    """Of the package, or of a study outside it."""
    (source := tmp_path / "draw.py").write_text("1")
    options = {"content": "a"}, PARTS, {"number": ("number", ITEMS)}, [tmp_path]
    open_store(tmp_path / "a.zarr", *options)
    open_store(tmp_path / "a.zarr", *options)
    source.write_text("2")
    with pytest.raises(UserError, match="made for another program"):
        open_store(tmp_path / "a.zarr", *options)


def test_a_map_of_a_dask_cluster_is_that_of_this_machine(tmp_path):
    cluster = pytest.importorskip("distributed").LocalCluster
    command = ["map", "filimonikhina", "--y", "weights.drag=1e-3:1:3:log", "--x", "speed=2:3:2"]
    with cluster(n_workers=1, processes=False, dashboard_address=None) as dask:
        for name, more in (("here.csv", []), ("there.csv", ["--cluster", dask.scheduler_address])):
            done = CliRunner().invoke(program(), [*command, "--csv", f"{tmp_path}/{name}", *more])
            assert done.exit_code == 0, done.output
    assert (tmp_path / "here.csv").read_bytes() == (tmp_path / "there.csv").read_bytes()


@pytest.mark.parametrize("damage", ["empty", "no number", "not JSON"])
def test_what_is_no_store_is_refused(tmp_path, damage):
    path = tmp_path / "a.zarr"
    if damage == "empty":
        path.mkdir()
    else:
        roots(path)
        (path / "root" / "zarr.json").write_text({"no number": "{}", "not JSON": "{"}[damage])
    with pytest.raises(UserError, match="no store that can be gone on with"):
        roots(path)


@pytest.mark.parametrize("speed_is", ["x", "y", "neither"])
def test_a_map_from_its_store_is_the_map(tmp_path, speed_is):
    scene = load_scene("filimonikhina")
    speed, drag = Axis.parse("speed=1.5:9:11"), Axis.parse("weights.drag=1e-3:1e-1:10:log")
    stiffness = Axis.parse("rotor.stiffness[2]=30:60:9")
    x, y = {"x": (speed, drag), "y": (drag, speed), "neither": (stiffness, drag)}[speed_is]
    maps = [stability_map(scene, x, y)]
    maps += [stability_map(scene, x, y, store=tmp_path / "a.zarr") for _ in range(2)]
    for one in maps[1:]:
        np.testing.assert_array_equal(one.growth, maps[0].growth)
        np.testing.assert_array_equal(one.criterion, maps[0].criterion)
        assert (one.failure == "").all()


def test_points_without_a_rate_keep_their_reasons(tmp_path, monkeypatch):
    def fails(assemblies, speeds):
        raise ValueError(f"not at {speeds[0]:g}")

    monkeypatch.setattr("autobalancer.harness.stability.map.growth_map", fails)
    scene, axes = load_scene("filimonikhina"), (Axis.parse("speed=1:2:2"),)
    axes += (Axis.parse("weights.drag=1:2:2"),)
    maps = [stability_map(scene, *axes, store=tmp_path / "a.zarr") for _ in range(2)]
    for one in maps:
        assert one.failure.tolist() == [["not at 1", "not at 2"]] * 2


def test_the_command_says_whose_store_it_is_and_where_one_cannot_be(tmp_path):
    command = ["map", "filimonikhina", "--y", "weights.drag=1e-3:1:3:log", "--x"]
    path = str(tmp_path / "a.zarr")
    done = CliRunner().invoke(program(), [*command, "speed=2:3:2", "-o", path])
    assert (done.exit_code, f"Store: {path}" in done.output) == (0, True)
    refused = CliRunner().invoke(program(), [*command, "speed=2:4:2", "-o", path])
    assert refused.exit_code == 2
    assert "'operation.speed = 2.0 to 3.0, 2 values' there" in " ".join(refused.output.split())
    nowhere = CliRunner().invoke(program(), [*command, "speed=2:3:2", "-o", "/nowhere/a.zarr"])
    assert (nowhere.exit_code, "cannot be written" in nowhere.output) == (2, True)


@pytest.mark.parametrize(
    ("name", "why"),
    [("a.zarr", "is a file and no store"), ("a.nc", "must end in .png, .svg, .pdf, .zarr")],
)
def test_a_place_that_can_be_neither_picture_nor_store_is_refused_in_words(tmp_path, name, why):
    (tmp_path / name).touch()
    command = ["map", "filimonikhina", "--x", "speed=2:3:2", "--y", "weights.drag=1e-3:1:3:log"]
    done = CliRunner().invoke(program(), [*command, "-o", str(tmp_path / name)])
    assert (done.exit_code, why in " ".join(done.output.split())) == (2, True)
