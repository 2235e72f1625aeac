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
    "run": ["run", "two_balls", "--set", "run.revolutions=3e6", "--set", "run.record=[]"],
    "python": [
        *["run", "two_balls", "--set", "run.revolutions=1e6", "--set", "run.record=[]"],
        *["--set", 'coupling.units="python"'],
    ],
    "map": [
        *["map", "filimonikhina", "--x", "speed=0.5:12:1500"],
        *["--y", "weights.drag=1e-4:1:1500:log", "-o", "map.png"],
    ],
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
        for code, group in groups.items():
            while not os.listdir(places[code]) and group.poll() is None:
                time.sleep(0.05)
        time.sleep(1.0)  # well into the work, or at its begin where the machine is busy
        for code, group in groups.items():
            os.killpg(group.pid, code)  # as a terminal does: it tells every process of the group
        for code, group in groups.items():
            _, errors = group.communicate(timeout=3000.0)
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
import ctypes, multiprocessing, os, pathlib, signal, subprocess, sys, tempfile, threading, time
from autobalancer.fmus.whole_files import whole_file
from autobalancer.harness.output import interrupts
def send(number=signal.SIGTERM):
    os.kill(os.getpid(), number)
"""
MOMENTS = {
    "within C code that calls Python": "ctypes.CFUNCTYPE(None)(send)(); time.sleep(30.0)",
    "twice at once, as `timeout` does": "send(); send(); time.sleep(30.0)",
    "within C code that never comes back": """
lock, mutex = ctypes.CDLL(None).pthread_mutex_lock, ctypes.create_string_buffer(64)
threading.Timer(0.3, send).start()
lock(mutex), lock(mutex)""",
    "while a file is written": """
with whole_file(pathlib.Path(tempfile.tempdir).parent / "file"):
    send(); time.sleep(30.0)""",
    "beside a program that writes temporary files": """
other = "import tempfile, time; tempfile.mkdtemp(); print(flush=True); time.sleep(2.0)"
begun = subprocess.Popen([sys.executable, "-c", other], stdout=subprocess.PIPE)
begun.stdout.readline(); send(); time.sleep(30.0)""",
    "before a worker process knows its work": """
from multiprocessing import util
from autobalancer.harness.output.workers import processes
begin = util.spawnv_passfds
with processes(1) as pool:
    util.spawnv_passfds = lambda *told: (begin(*told), send())[0]
    pool.submit(abs, -3); time.sleep(30.0)""",
}
LOADING = """
import os, sys, time
module, number = sys.argv[1], int(sys.argv[2])
class Sender:  # as a C module does that the interrupt meets
    def find_spec(self, name, *_):
        if name == module:
            try:
                os.kill(os.getpid(), number)
                time.sleep(20.0)
            except BaseException:
                raise ImportError("initialization failed") from None
sys.meta_path.insert(0, Sender())
from autobalancer.harness.__main__ import main
main()
"""
WORKERS = """
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


def _ended(script: str, folder, answering, *arguments: object) -> tuple[int, str, str]:
    """Exit code and output of a script that leaves no file in its temporary folder."""
    ended = subprocess.run(
        [sys.executable, "-c", script, *map(str, arguments)],
        env={**os.environ, "TMPDIR": str(folder)},
        capture_output=True,
        text=True,
        timeout=3000.0,
        start_new_session=True,
        preexec_fn=answering,
    )
    assert os.listdir(folder) == []
    return ended.returncode, ended.stdout, ended.stderr


@pytest.mark.parametrize("moment", MOMENTS)
def test_a_signal_ends_the_process_at_any_moment_and_leaves_no_file(tmp_path, answering, moment):
    block = textwrap.indent(MOMENTS[moment].strip(), "    ")
    script = f"{BEGIN}interrupts.answer_signals()\nwith interrupts.temporary_files():\n{block}"
    assert _ended(script, tmp_path, answering) == (143, "", "terminated\n")


@pytest.mark.parametrize(
    ("module", "number", "word"),
    [("typer", 2, "interrupted"), ("autobalancer.harness.commands.stress", 15, "terminated")],
)
def test_a_signal_while_the_program_loads_is_answered_in_a_word(
    tmp_path, answering, module, number, word
):
    ended = _ended(LOADING, tmp_path, answering, module, number)
    assert ended == (128 + number, "", f"{word}\n")


def test_ctrl_c_does_not_meet_workers_that_load(tmp_path, answering):
    assert _ended(WORKERS, tmp_path, answering) == (0, "3\n", "")


def test_a_picture_is_drawn_where_the_home_folder_cannot_be_written(tmp_path):
    ended = subprocess.run(
        [sys.executable, "-m", "autobalancer.harness", "run", "two_balls", "--plot", "x.png"],
        cwd=tmp_path, env={**os.environ, "HOME": "/proc/none"}, capture_output=True, text=True,
    )  # fmt: skip
    assert (ended.returncode, ended.stderr) == (0, "")
    assert (tmp_path / "x.png").stat().st_size > 10_000
