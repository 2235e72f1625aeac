"""Work on many things: the same outcomes wherever it is done, and an end at once on Ctrl-C."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
import time
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from pathlib import Path

import pytest

from autobalancer.harness.errors import SimulationError
from autobalancer.harness.output.terminal import is_quiet
from autobalancer.harness.output.workers import PREFIX, in_order, processes

pytestmark = pytest.mark.slow


def square(number: int) -> int:
    if number == 3:
        raise SimulationError("three")
    return number * number


def note(place: tuple[str, int]) -> int:
    """Leave a file that says that this item was begun; the first one fails."""
    directory, number = place
    (Path(directory) / str(number)).touch()
    if number == 0:
        raise SimulationError("the first")
    time.sleep(0.2)
    return number


def end_process(_item: int) -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def folder(_item: int) -> str:
    return tempfile.mkdtemp()


def quiet(_item: int) -> bool:
    return is_quiet.get()


class AtOnce(Executor):
    """Another's executor, such as a cluster's: only what the base class promises."""

    def submit(self, function, /, *arguments, **options):
        future: Future = Future()
        try:
            future.set_result(function(*arguments, **options))
        except Exception as error:
            future.set_exception(error)
        return future


@pytest.mark.parametrize("workers", [1, 2, AtOnce(), ThreadPoolExecutor(2)])
def test_outcomes_stand_in_the_items_order_whoever_does_the_work(workers):
    told = []
    assert in_order(square, [5, 1, 2, 4], workers, told.append) == [25, 1, 4, 16]
    assert told == [0.25, 0.5, 0.75, 1.0]


@pytest.mark.parametrize("workers", [1, 2])
def test_processes_of_a_quiet_command_are_quiet(workers):
    before = is_quiet.set(True)
    try:
        assert in_order(quiet, [1, 2], workers) == [True, True]
    finally:
        is_quiet.reset(before)


@pytest.mark.parametrize("workers", [1, 2, AtOnce()])
def test_the_first_failure_is_raised(workers):
    with pytest.raises(SimulationError, match="three"):
        in_order(square, [2, 3, 4], workers)


@pytest.mark.parametrize("begin", [lambda: processes(2), lambda: ThreadPoolExecutor(1)])
def test_after_a_failure_nothing_more_is_begun(tmp_path, begin):
    items = [(str(tmp_path), number) for number in range(40)]
    with begin() as executor, pytest.raises(SimulationError, match="the first"):
        in_order(note, items, executor)
    assert len(os.listdir(tmp_path)) < 10


def test_a_process_ended_from_outside_is_an_error_in_words():
    with pytest.raises(SimulationError, match="a process that did the work was ended"):
        in_order(end_process, [1, 2], 2)


def test_a_script_that_its_processes_read_again_is_told_what_it_lacks(tmp_path):
    script = tmp_path / "unguarded.py"
    script.write_text(
        "from autobalancer.harness.output.workers import in_order\nin_order(abs, [1, 2], 2)\n"
    )
    ended = subprocess.run([sys.executable, str(script)], capture_output=True, text=True)
    assert ended.returncode == 1
    assert "freeze_support" not in ended.stderr
    last = ended.stderr.splitlines()[-1]
    assert "a process that did the work was ended; a script" in last
    assert 'if __name__ == "__main__":' in last


def test_temporary_files_of_processes_are_gone_with_them():
    folders = in_order(folder, [1, 2, 3], 2)
    assert all(PREFIX in name for name in folders)
    assert not any(os.path.exists(name) for name in folders)


SCRIPT = """
import os, pathlib, tempfile, time
from autobalancer.harness.output.workers import in_order

def work(directory):
    made = tempfile.mkdtemp()
    note = pathlib.Path(made) / "note"
    note.write_text(made)
    note.rename(pathlib.Path(directory) / str(os.getpid()))
    time.sleep(3600)

if __name__ == "__main__":
    in_order(work, [{directory!r}] * 8, 2)
"""


def _alive(process: str) -> bool:
    try:
        return "\nState:\tZ" not in Path(f"/proc/{process}/status").read_text()
    except OSError:
        return False


@pytest.mark.parametrize(
    ("number", "code", "said"),
    [
        (signal.SIGINT, -signal.SIGINT, 1),
        (signal.SIGTERM, -signal.SIGTERM, 0),
        (signal.SIGKILL, -signal.SIGKILL, 0),
    ],
)
def test_an_interrupt_ends_all_processes_at_once_and_clears_their_files(
    tmp_path, answering, number, code, said
):
    script, begun = tmp_path / "script.py", tmp_path / "begun"
    begun.mkdir()
    script.write_text(SCRIPT.format(directory=str(begun)), encoding="utf-8")
    group = subprocess.Popen(
        [sys.executable, script], stderr=subprocess.PIPE, text=True, start_new_session=True,
        preexec_fn=answering,
    )  # fmt: skip
    while len(os.listdir(begun)) < 2 and group.poll() is None:
        time.sleep(0.05)
    if number == signal.SIGINT:
        os.killpg(group.pid, number)  # as a terminal does: it tells every process of the group
    else:
        group.send_signal(number)
    _, errors = group.communicate(timeout=3000.0)  # they would sleep for an hour
    assert group.returncode == code
    assert errors.count("Traceback") == said  # the parent's own; none of a worker
    workers = [path for path in begun.iterdir() if path.read_text()]
    assert len(workers) == 2
    for path in workers:
        assert not _alive(path.name)
        assert not os.path.exists(path.read_text())
