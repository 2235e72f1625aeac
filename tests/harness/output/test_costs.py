"""Work without end is refused after its first steps, with number and key."""

from __future__ import annotations

import math
import subprocess
import sys

import pytest
from typer.testing import CliRunner

from autobalancer.harness import cosimulate, load_scene
from autobalancer.harness.__main__ import program
from autobalancer.harness.errors import UserError
from autobalancer.harness.output.costs import seconds_of, within

pytestmark = pytest.mark.slow


def test_a_run_of_1e12_revolutions_is_refused_after_its_first_steps(monkeypatch):
    monkeypatch.setattr("autobalancer.harness.master.recorder.free_memory", lambda: math.inf)
    setting = ["--set", "run.revolutions=1e12", "--set", "run.record=[]"]
    outcome = CliRunner().invoke(program(), ["run", "two_balls", *setting])
    assert outcome.exit_code == 2, outcome.output
    assert "run.revolutions = 1e+12: would take about" in outcome.stderr
    assert "more than --at-most 1h" in outcome.stderr
    assert len(outcome.stderr.splitlines()) == 1


def test_a_record_that_does_not_fit_into_memory_is_refused_with_its_keys(monkeypatch):
    monkeypatch.setattr("autobalancer.harness.master.recorder.free_memory", lambda: 5e4)
    with pytest.raises(UserError, match=r"run\.revolutions, run\.record: 6 signals .* 5e-05 GB"):
        cosimulate("two_balls")
    # 3 * 8 bytes for time, rotor.x and two velocities in each of 401 rows
    cosimulate(load_scene("two_balls").replace({"run.record": ["rotor.x"]}))


@pytest.mark.parametrize(
    ("command", "said"),
    [
        (["check", "filimonikhina"], "checks of filimonikhina"),
        (["stress", "stiff"], "cases"),
        (["speeds", "two_balls", "--range", "1", "9"], "--range 1 9"),
    ],
)
def test_a_command_that_is_not_done_in_time_is_refused(command, said):
    line = [sys.executable, "-m", "autobalancer.harness", *command, "--at-most", "0.001s"]
    ended = subprocess.run(line, capture_output=True, text=True)
    assert ended.returncode == 2, ended.stdout
    assert said in ended.stderr
    assert ended.stderr.endswith("not done within --at-most 0.001s\n")


def watched(at_most: str, times: list[float]) -> list[float]:
    """Reports that came through while every one finished a thousandth."""
    told: list[float] = []
    ticks = iter(times)
    report = within(at_most, "key = 1", told.append, lambda: next(ticks))
    for number in range(len(times)):
        report(number / 1000)
    return told


def test_work_is_refused_by_its_rate_and_allowed_by_a_higher_limit():
    every_ten_seconds = [100.0 + 10.0 * n for n in range(30)]  # 10 000 s in all
    with pytest.raises(
        UserError, match=r"key = 1: would take about 2\.78 h, more than --at-most 1h"
    ):
        watched("1h", every_ten_seconds)
    assert len(watched("3h", every_ten_seconds)) == 30


def test_work_that_turns_out_to_be_more_is_judged_anew():
    """A tolerance that is not kept: what was half of the work becomes a tenth of it."""
    told, ticks = [], iter([0.0, 1.0, 3.0, 4.0, 5.0])
    report = within("1h", "key = 1", told.append, lambda: next(ticks))
    parts = [0.4, 0.5, 0.1, 0.2, 0.3]
    for part in parts:
        report(part)
    assert told == parts


def test_what_is_nearly_done_is_not_dropped():
    # the rate falls when a fifth of the limit has passed
    slowing = [0.0, 1.0, 2.0, 3.0, 800.0, 1600.0]
    assert len(watched("1h", slowing)) == 6


def test_work_in_parts_longer_than_its_limit_is_refused_after_the_first():
    with pytest.raises(UserError, match=r"would take about 8.33 h, more than --at-most 5s"):
        watched("5s", [0.0, 1.2, 60.0])


def test_work_that_has_not_moved_is_given_its_time():
    told, ticks = [], iter([0.0, 5.0, 50.0, 3601.0])
    report = within("1h", "key = 1", told.append, lambda: next(ticks))
    for _ in range(3):
        report(0.0)
    with pytest.raises(UserError, match="key = 1: not done within --at-most 1h"):
        report(0.0)
    assert told == [0.0, 0.0, 0.0]


@pytest.mark.parametrize(
    ("text", "seconds"), [("90", 90), ("90s", 90), ("1.5h", 5400), ("2 d", 172800)]
)
def test_times_are_read(text, seconds):
    assert seconds_of(text) == seconds


@pytest.mark.parametrize("text", ["", "h", "-1h", "0", "nan", "1e3", "2 weeks"])
def test_what_is_no_time_is_refused(text):
    with pytest.raises(UserError, match="must be a time such as"):
        seconds_of(text)
