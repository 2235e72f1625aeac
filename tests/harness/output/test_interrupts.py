"""Ctrl-C and SIGTERM while a command works: exit codes, one word, nothing left behind."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import textwrap
import time

import pytest

pytestmark = pytest.mark.slow

LONG = {
    "separate": [
        *["run", "two_balls", "--separate"],
        *["--set", "run.revolutions=1e6", "--set", "run.record=[]"],
    ],
    "run": ["run", "two_balls", "--set", "run.revolutions=3e6", "--set", "run.record=[]"],
    "python": [
        *["run", "two_balls", "--set", "run.revolutions=1e6", "--set", "run.record=[]"],
        *["--set", 'coupling.units="python"'],
    ],
    "map": [
        *["map", "filimonikhina", "--x", "speed=0.5:12:1500"],
        *["--y", "weights.drag=1e-4:1:1500:log", "-o", "map.png"],
    ],
    "stress": ["stress"],
}


WORDS = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated"}


@pytest.mark.parametrize("command", LONG)
def test_a_command_ends_at_once_with_one_word_and_leaves_no_folder(tmp_path, answering, command):
    """By either signal; the two commands work side by side."""
    places = {code: tmp_path / code.name / "temporary" for code in WORDS}
    groups = {}
    try:
        for code, folder in places.items():
            folder.mkdir(parents=True)
            groups[code] = subprocess.Popen(
                [sys.executable, "-m", "autobalancer.harness", *LONG[command]],
                env={**os.environ, "TMPDIR": str(folder), "HOME": str(folder.parent)},
                cwd=folder.parent,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
                start_new_session=True,
                preexec_fn=answering,
            )
        until = time.monotonic() + 60.0
        while not all(map(os.listdir, places.values())) and time.monotonic() < until:
            time.sleep(0.05)
        time.sleep(1.0)  # well into the work
        for code, group in groups.items():
            os.killpg(group.pid, code)  # as a terminal does: it tells every process of the group
        for code, group in groups.items():
            _, errors = group.communicate(timeout=60.0)
            assert group.returncode == 128 + code
            assert errors.strip() == WORDS[code]
            assert os.listdir(places[code]) == []
            assert os.listdir(places[code].parent) == ["temporary"]
    finally:
        for group in groups.values():
            if group.poll() is None:
                os.killpg(group.pid, signal.SIGKILL)
                group.wait()


BEGIN = """
import os, signal, sys, time
from autobalancer.harness.output import interrupts
def told(number=signal.SIGTERM):
    os.kill(os.getpid(), number)
"""
BETWEEN = {
    "swallowed by C code that calls Python": """
        import ctypes
        call = ctypes.CFUNCTYPE(None)(told)
        with interrupts.interruptible():
            call()
            time.sleep(30.0)
    """,
    "raised only when nothing is at work that must not see it": """
        marked = {"SIGNALS_WAIT": True, "told": told, "time": time}
        exec("def work():\\n try:\\n  told()\\n  time.sleep(0.2)\\n"
             " except BaseException:\\n  print('seen')", marked)
        with interrupts.interruptible():
            marked["work"]()
            time.sleep(30.0)
    """,
    "turned into another exception, as a C module does that is being imported": """
        with interrupts.interruptible():
            try:
                told()
                time.sleep(30.0)
            except interrupts.Interrupted:
                raise ImportError("initialization failed") from None
    """,
    "sent twice at once, as `timeout` does": """
        with interrupts.interruptible():
            try:
                told()
            finally:
                told()
                print("cleared up")
    """,
}
BY_FORCE = {
    "a second one": """
        with interrupts.temporary_files(), interrupts.interruptible():
            try:
                told()
            finally:
                time.sleep(interrupts._TWICE + 0.1)
                told()
                time.sleep(30.0)
    """,
    "C code that never comes back": """
        import ctypes, threading
        interrupts._GRACE = 0.3
        lock, mutex = ctypes.CDLL(None).pthread_mutex_lock, ctypes.create_string_buffer(64)
        with interrupts.temporary_files(), interrupts.interruptible():
            threading.Timer(0.3, told).start()
            lock(mutex), lock(mutex)
    """,
}


def _python(script: str, folder) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", BEGIN + textwrap.dedent(script)],
        env={**os.environ, "TMPDIR": str(folder)},
        capture_output=True,
        text=True,
        timeout=20.0,
    )


@pytest.mark.parametrize("case", BETWEEN)
def test_a_signal_is_never_lost_and_raised_once(tmp_path, case):
    ended = _python(BETWEEN[case], tmp_path)
    assert "seen" not in ended.stdout
    assert "Interrupted: 15" in ended.stderr.splitlines()[-1]
    assert ended.stderr.count("Traceback") == 1 + ("turned" in case)
    assert ("cleared up" in ended.stdout) == ("twice" in case)


@pytest.mark.parametrize("case", BY_FORCE)
def test_a_process_that_does_not_end_in_order_is_ended_and_leaves_no_folder(tmp_path, case):
    ended = _python(BY_FORCE[case], tmp_path)
    assert (ended.returncode, ended.stderr) == (143, "terminated\n")
    assert os.listdir(tmp_path) == []


TOLD_LOADING = """
import os, signal, sys, time
module, number = sys.argv[1], int(sys.argv[2])
class Told:  # as a C module does that the interrupt meets
    def find_spec(self, name, *_):
        if name == module:
            try:
                os.kill(os.getpid(), number)
                time.sleep(20.0)
            except BaseException:
                raise ImportError("initialization failed") from None
sys.meta_path.insert(0, Told())
from autobalancer.harness.__main__ import main
main()
"""
TOLD_WORKERS = """
import os, signal, time
from autobalancer.harness.output.workers import processes
signal.signal(signal.SIGINT, lambda *_: None)
with processes(1) as pool:
    answer = pool.submit(abs, -3)
    for _ in range(20):
        os.killpg(0, signal.SIGINT)
        time.sleep(0.02)
    print(answer.result())
"""


def _told(script: str, folder, answering, *arguments: object) -> tuple[int, str, str]:
    ended = subprocess.run(
        [sys.executable, "-c", script, *map(str, arguments)],
        env={**os.environ, "TMPDIR": str(folder)},
        capture_output=True,
        text=True,
        timeout=60.0,
        start_new_session=True,
        preexec_fn=answering,
    )
    assert os.listdir(folder) == []
    return ended.returncode, ended.stdout, ended.stderr


@pytest.mark.parametrize(("number", "word"), [(2, "interrupted"), (15, "terminated")])
@pytest.mark.parametrize("module", ["typer", "autobalancer.harness.accuracy.stress"])
def test_a_signal_while_the_program_loads_is_answered_in_a_word(
    tmp_path, answering, module, number, word
):
    ended = _told(TOLD_LOADING, tmp_path, answering, module, number)
    assert ended == (128 + number, "", f"{word}\n")


def test_ctrl_c_does_not_meet_workers_that_load(tmp_path, answering):
    assert _told(TOLD_WORKERS, tmp_path, answering) == (0, "3\n", "")


def test_programs_that_are_begun_and_killed_leave_no_files(tmp_path):
    other = "import tempfile, time; tempfile.mkdtemp(); print(flush=True); time.sleep(30.0)"
    ended = _python(
        f"""
        import subprocess
        with interrupts.temporary_files():
            other = subprocess.Popen([sys.executable, "-c", {other!r}], stdout=subprocess.PIPE)
            other.stdout.readline()
            other.kill()
            other.wait()
        print(os.environ["TMPDIR"])
        """,
        tmp_path,
    )
    assert (ended.returncode, ended.stdout) == (0, f"{tmp_path}\n")
    assert os.listdir(tmp_path) == []


def test_a_picture_is_drawn_where_the_home_folder_cannot_be_written(tmp_path):
    ended = subprocess.run(
        [sys.executable, "-m", "autobalancer.harness", "run", "two_balls", "--plot", "x.png"],
        cwd=tmp_path, env={**os.environ, "HOME": "/proc/none"}, capture_output=True, text=True,
    )  # fmt: skip
    assert (ended.returncode, ended.stderr) == (0, "")
    assert (tmp_path / "x.png").stat().st_size > 10_000
