"""Limits of time and memory: work ends, or is refused, in words."""

from __future__ import annotations

import os
import re
import subprocess
import sys

import pytest

from autobalancer.harness import cosimulate, load_scene
from autobalancer.harness.errors import UserError
from autobalancer.harness.output.commands import seconds_of

pytestmark = pytest.mark.slow


def test_a_record_that_does_not_fit_into_memory_is_refused_with_its_keys(monkeypatch):
    monkeypatch.setattr("autobalancer.harness.master.recorder.free_memory", lambda: 1e5)
    with pytest.raises(UserError, match=r"run\.revolutions, run\.record: 6 signals .* 0\.0001 GB"):
        cosimulate(load_scene("two_balls").replace({"run.revolutions": 40}))
    # 3 * 8 bytes for time, rotor.x and what the verdict reads in each of 401 rows: 87 kB
    cosimulate(load_scene("two_balls").replace({"run.record": ["rotor.x"]}))


@pytest.mark.parametrize(
    ("command", "done"),
    [
        (
            ["run", "two_balls", "--set", "run.revolutions=3e6", "--set", "run.record=[]"],
            r"\d+ % of running two_balls",
        ),
        (
            [
                *["map", "filimonikhina", "--x", "speed=0.5:12:1500"],
                *["--y", "weights.drag=1e-4:1:1500:log", "--store", "map.store"],
            ],
            r"\d+ % of mapping filimonikhina; map\.store keeps what is done, the same .* continues",
        ),
    ],
)
def test_a_command_ends_when_its_time_is_over_and_says_how_far_it_came(tmp_path, command, done):
    """The time is over as soon as there is something to say: a busy machine takes longer."""
    ended = ended_in(tmp_path, [sys.executable, "-c", WHEN_BEGUN, done, *command])
    advice = r"give more time \(--at-most 4h\), or ask for less"
    assert re.fullmatch(f"not done within --at-most; {done}; {advice}\n", ended.stderr)


def test_the_time_of_a_command_is_that_of_the_option(tmp_path):
    command = ["run", "two_balls", "--set", "run.revolutions=3e6", "--set", "run.record=[]"]
    run = [sys.executable, "-m", "autobalancer.harness", *command, "--quiet", "--at-most", "1s"]
    assert ended_in(tmp_path, run).stderr.startswith("not done within --at-most; ")


WHEN_BEGUN = """
import contextlib, os, re, signal, sys, threading, time
from autobalancer.harness.__main__ import main
from autobalancer.harness.output.terminal import how_far

def end(done, said=""):
    while not re.search(done, said):
        time.sleep(0.01)
        with contextlib.suppress(RuntimeError):  # what is said changes meanwhile
            said = how_far()
    os.kill(os.getpid(), signal.SIGALRM)

threading.Thread(target=end, args=[sys.argv.pop(1)], daemon=True).start()
sys.argv[1:] += ["--quiet"]
main()
"""


def ended_in(folder, command):
    """A command that has ended for want of time, without output and without files."""
    temporary = folder / "temporary"
    temporary.mkdir()
    environment = {**os.environ, "TMPDIR": str(temporary)}
    ended = subprocess.run(command, cwd=folder, capture_output=True, text=True, env=environment)
    assert (ended.returncode, ended.stdout) == (2, "")
    assert os.listdir(temporary) == []
    return ended


@pytest.mark.parametrize(
    ("text", "seconds"), [("90", 90), ("90s", 90), ("1.5h", 5400), ("2 d", 172800)]
)
def test_times_are_read(text, seconds):
    assert seconds_of(text) == seconds


@pytest.mark.parametrize("text", ["", "h", "-1h", "0", "nan", "1e3", "2 weeks"])
def test_what_is_no_time_is_refused(text):
    with pytest.raises(UserError, match="must be a time such as"):
        seconds_of(text)
