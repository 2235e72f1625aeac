"""Results, rows, pictures: what they say, and that files appear whole or not at all."""

import contextlib
import errno
import os
import resource
import sys

import numpy as np
import pytest

from autobalancer.harness.errors import UserError
from autobalancer.harness.output.files import write_whole
from autobalancer.harness.result.result import Result, UnknownSignalError


@pytest.fixture
def result() -> Result:
    time = np.linspace(0.0, 10.0, 1001)
    decay = np.exp(-time)
    signals = {
        "rotor.x": decay * np.cos(6.0 * time),
        "rotor.y": decay * np.sin(6.0 * time),
        "weights.moment_xi": np.full_like(time, 0.3),
        "weights.moment_eta": np.full_like(time, 0.4),
    }
    symbols = {name: "m" if name.startswith("rotor") else "kg m" for name in signals}
    return Result(
        "a decaying circle", time, signals, 0.1, units=("RotorOnSupports.fmu",),
        signal_units=symbols,
    )  # fmt: skip


def test_unknown_signal_lists_what_was_recorded(result):
    with pytest.raises(UnknownSignalError, match=r"'rotor.z'.*did you mean.*rotor.y") as caught:
        result["rotor.z"]
    assert isinstance(caught.value, (KeyError, UserError))
    assert "recorded: rotor.x, rotor.y, weights.moment_xi" in str(caught.value)


def test_a_result_is_told_in_a_line_draws_itself_and_completes_its_signals(result):
    said = "<Result of 'a decaying circle': 4 signals at 1001 times to 10 s>"
    assert repr(result) == said
    assert result.plot().title == "a decaying circle"
    assert result._ipython_key_completions_()[:2] == ["rotor.x", "rotor.y"]


def test_assert_close_passes_within_and_names_the_worst_time_beyond(result):
    exact = np.exp(-result.time) * np.cos(6.0 * result.time)
    result.assert_close("rotor.x", exact, 1e-12)
    wrong = exact.copy()
    wrong[500] += 0.02
    with pytest.raises(AssertionError, match=r"rotor.x differs by 0.02 at t = 5 s.*allowed 0.01"):
        result.assert_close("rotor.x", wrong, 0.01)
    result.assert_close("rotor.x", wrong, 0.03)


@pytest.mark.parametrize(
    "check",
    [
        lambda result: result.assert_close("rotor.x", 1.0, 100.0),
        lambda result: result.assert_bounded("rotor.x", 1e9),
        lambda result: result.assert_balanced(below=1e9),
    ],
    ids=["close", "bounded", "balanced"],
)
def test_a_value_that_is_not_a_number_fails_every_assertion(result, check):
    check(result)
    result.signals["rotor.x"][-3] = np.nan
    with pytest.raises(AssertionError, match=r"t = 9.98 s"):
        check(result)


def test_assert_bounded_names_first_and_worst_time(result):
    result.assert_bounded("rotor.x", 1.0)
    with pytest.raises(AssertionError, match=r"reaches 1 at t = 0 s.*first at t = 0 s"):
        result.assert_bounded("rotor.x", 0.5)
    result.assert_bounded("rotor.x", 0.5, after=1.0)
    with pytest.raises(UserError, match="the run ends at t = 10 s"):
        result.assert_bounded("rotor.x", 0.5, after=11.0)


def test_assert_balanced_judges_the_end_of_the_run_and_tells_the_moment(result):
    result.assert_balanced(below=np.exp(-9.0) * 1.001)
    with pytest.raises(AssertionError, match=r"rotor still moves 0.00012341 m .*hold 0.5 kg m"):
        result.assert_balanced(below=np.exp(-9.0) * 0.999)


def test_assert_balanced_needs_the_displacement():
    with pytest.raises(UserError, match=r"'rotor.x' was not recorded"):
        Result("empty", np.array([0.0, 1.0]), {}, 0.0).assert_balanced(below=1.0)


def test_csv_keeps_every_digit(result, tmp_path):
    path = result.to_csv(tmp_path / "out.csv")
    lines = path.read_text(encoding="utf-8").splitlines()
    assert lines[0] == "time,rotor.x,rotor.y,weights.moment_xi,weights.moment_eta"
    table = np.loadtxt(path, delimiter=",", skiprows=1)
    assert np.array_equal(table[:, 1], result["rotor.x"])


@contextlib.contextmanager
def files_no_larger_than(size: int):
    """The system refuses to let any file grow beyond this, as a full disk would."""
    # of a module that is loaded meanwhile Python would keep a truncated file
    written, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        sys.dont_write_bytecode = written


def test_a_disk_that_fills_up_leaves_the_old_file_and_nothing_else(result, tmp_path):
    path = tmp_path / "out.csv"
    path.write_text("old", encoding="utf-8")
    with files_no_larger_than(20_000), pytest.raises(UserError, match="cannot be written"):
        result.to_csv(path)
    assert path.read_text(encoding="utf-8") == "old"
    assert os.listdir(tmp_path) == ["out.csv"]


def test_a_device_is_written_to_and_not_replaced():
    with write_whole("/dev/null") as stream:
        stream.write("gone")
    assert not os.path.isfile("/dev/null")
    with pytest.raises(UserError, match=os.strerror(errno.ENOSPC)), write_whole("/dev/full") as s:
        s.write("x" * 100_000)
    assert not os.path.isfile("/dev/full")


def test_a_link_stays_a_link(tmp_path):
    (tmp_path / "real.txt").write_text("old", encoding="utf-8")
    (tmp_path / "link.txt").symlink_to("real.txt")
    with write_whole(tmp_path / "link.txt") as stream:
        stream.write("new")
    assert (tmp_path / "link.txt").is_symlink()
    assert (tmp_path / "real.txt").read_text(encoding="utf-8") == "new"


def test_picture_formats_are_named(result, tmp_path):
    with pytest.raises(UserError, match=r"pictures end in \.png, \.svg, \.pdf"):
        result.plot(tmp_path / "out.doc")


def test_picture_states_units_and_0_peak(result, tmp_path):
    text = result.plot(tmp_path / "out.svg").read_text(encoding="utf-8")
    # glyphs are drawn, but every text stands in a comment beside them
    for words in (
        "displacement [m]",
        "unbalance of the balancers [kg m]",
        "time [s]",
        "rotor.x, 0-peak 1 m",
    ):
        assert f"<!-- {words} -->" in text
