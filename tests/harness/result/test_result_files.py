"""A result in other libraries' tables, in a file and in a notebook is the same result."""

from __future__ import annotations

import sys
from dataclasses import fields, replace

import numpy as np
import pytest

from autobalancer.harness import Result, UserError, cosimulate


@pytest.fixture(scope="module")
def result() -> Result:
    return cosimulate("two_balls")


def assert_equal(one: Result, other: Result) -> None:
    for each in fields(Result):
        if each.name in ("time", "signals", "velocity"):
            continue
        assert getattr(one, each.name) == getattr(other, each.name), each.name
    np.testing.assert_array_equal(one.time, other.time)
    assert list(one.signals) == list(other.signals)
    for name, values in (one.signals | one.velocity).items():
        np.testing.assert_array_equal(values, other[name])


def test_a_loaded_result_is_the_one_that_was_saved(result, tmp_path):
    pytest.importorskip("xarray")
    words = {"scene_title": 'µ <"title"> €', "events": ("note\nwith a second line",)}
    strange = replace(result, **words)
    for number, one in enumerate((result, strange, cosimulate("liquid_disc", record=[]))):
        path = one.save(tmp_path / f"{number}.nc")
        again = Result.load(path)
        assert_equal(one, again)
    assert Result.load(tmp_path / "0.nc").plot_polar().panels  # it knows its scene


def test_what_is_no_result_is_refused(tmp_path):
    xarray = pytest.importorskip("xarray")
    path = tmp_path / "a.nc"
    with pytest.raises(UserError, match="cannot be read: No such file"):
        Result.load(path)
    path.write_bytes(b"nothing of the kind")
    with pytest.raises(UserError, match=r"`Result\.save` of this .*; run the scene again"):
        Result.load(path)
    xarray.Dataset({"x": ("t", [1.0])}).to_netcdf(path, engine="scipy")
    with pytest.raises(UserError, match="is not a result"):
        Result.load(path)
    facts = '{"left_out": [], "units": [], "events": [], "signal_units": {}, "other": 1}'
    xarray.Dataset(attrs={"autobalancer_run": facts}).to_netcdf(path, engine="scipy")
    with pytest.raises(UserError, match="is not a result"):
        Result.load(path)


def test_a_file_appears_whole_or_not_at_all(result, tmp_path):
    pytest.importorskip("xarray")
    with pytest.raises(UserError, match="cannot be written"):
        result.save(tmp_path / "no" / "a.nc")
    assert not list(tmp_path.iterdir())


def test_tables_hold_signals_and_units(result):
    pytest.importorskip("xarray")
    frame, data = result.to_pandas(), result.to_xarray()
    np.testing.assert_array_equal(frame["rotor.x"].to_numpy(), result["rotor.x"])
    np.testing.assert_array_equal(frame.index.to_numpy(), result.time)
    assert frame.attrs["units"]["rotor.x"] == "m"
    assert data["rotor.x"].attrs == {"units": "m", "long_name": "displacement rotor.x"}
    assert data["time"].attrs == {"units": "s", "long_name": "time"}
    late = data["weights.weight[1].angle"].sel(time=result.time[-1], method="nearest")
    assert float(late) == result["weights.weight[1].angle"][-1]


def test_without_the_libraries_it_is_said_how_to_get_them(result, monkeypatch, tmp_path):
    for library, use in (("pandas", result.to_pandas), ("xarray", result.to_xarray)):
        monkeypatch.setitem(sys.modules, library, None)
        with pytest.raises(UserError, match=rf'{library}: pip install "autobalancer\[data\]"'):
            use()


def test_a_notebook_shows_signals_and_notes_as_text(result):
    strange = replace(result, scene_title="<script>alert(1)</script>", events=("<b>no</b>",))
    page = strange._repr_html_()
    assert "<script" not in page
    assert "<b>" not in page
    assert "&lt;script&gt;alert(1)" in page
    assert "rotor.x</td>" in page
    assert page.count("data:image/png;base64,") == 1
    assert "<img" not in replace(result, signals={})._repr_html_()
