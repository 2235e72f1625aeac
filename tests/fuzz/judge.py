"""What holds for every command line: it ends by itself, with a code and words, and files are whole.

A command runs in a fork of a process that has loaded everything: as the console script runs it, and
alone, so that one that dies of a signal or never ends is one wrong case.
"""

from __future__ import annotations

import csv
import json
import multiprocessing
import os
import random
import re
import resource
import signal
import sys
import tempfile
import time
import traceback
import zipfile
from collections.abc import Callable, Sequence
from multiprocessing.process import BaseProcess
from pathlib import Path
from xml.etree import ElementTree

from PIL import Image

KEPT = b"kept\n"  # what stands in a file before a command that may replace it
_LONGEST = 600.0  # s: what takes longer is endless, on a busy machine too
_MOST = 6_000_000  # kB: what takes more would end in the dark on many a machine
_PATIENCE = 15.0  # s for processes to see that their parent is gone
_UNFORESEEN, _LARGE = 99, 98  # exit codes of our own
_WHO = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
_NEVER_SAID = re.compile(r"Traceback|Exception ignored|\w+Warning:|\x1b\[31m")


class Wrong(Exception):
    """What a command must never do."""


def alone(
    work: Callable[[], int], said: Path, told: Callable[[BaseProcess], None] | None = None
) -> int:
    """Exit code of some work in a process of its own, whose output goes to `said`.

    Args:
        told: what is done with the process on the way.

    Raises:
        Wrong: it was ended by a signal, was endless, took too much memory, or left processes.
    """
    process = multiprocessing.get_context("fork").Process(target=_work, args=(work, said))
    process.start()
    number = process.pid or 0
    if told is not None:
        told(process)
    process.join(_LONGEST)
    if process.is_alive():
        os.killpg(number, signal.SIGKILL)
        process.join()
        raise Wrong(f"not done after {_LONGEST:g} s")
    code = process.exitcode or 0
    if code < 0:
        raise Wrong(f"ended by {signal.Signals(-code).name}")
    if code == _LARGE:
        raise Wrong(f"took more than {_MOST / 1e6:g} GB")
    _refuse_orphans(number)
    return code


def _work(work: Callable[[], int], said: Path) -> None:
    """Of a process with a group and an output of its own, as if just begun."""
    os.setsid()
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a background job ignores it
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    output = os.open(said, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    for stream in (1, 2):
        os.dup2(output, stream)
    sys.stdout = os.fdopen(1, "w", encoding="utf-8")
    sys.stderr = os.fdopen(2, "w", buffering=1, encoding="utf-8", errors="backslashreplace")
    try:
        code = work()
    except BaseException:
        traceback.print_exc()
        sys.exit(_UNFORESEEN)
    used = max(resource.getrusage(who).ru_maxrss for who in _WHO)
    sys.exit(_LARGE if used > _MOST else code)


def _refuse_orphans(group: int) -> None:
    until = time.monotonic() + _PATIENCE
    while time.monotonic() < until:
        try:
            os.killpg(group, 0)
        except ProcessLookupError:
            return
        time.sleep(0.01)
    os.killpg(group, signal.SIGKILL)
    raise Wrong("left processes behind")


def refuse_wrong(arguments: Sequence[str], folder: Path, draw: random.Random | None = None) -> int:
    """Exit code of a command line in `folder`; with `draw` it is interrupted at some moment.

    Raises:
        Wrong: a traceback or warning is shown, the exit code is none of those that are told, it
            failed without a word, or a file is half-written or left behind.
    """
    said, scratch = folder.parent / "said.txt", folder.parent / "scratch"
    scratch.mkdir()
    codes = (0, 1, 2)
    told = None
    if draw is not None:
        number, after = draw.choice((signal.SIGINT, signal.SIGTERM)), draw.random() ** 2 * 3.0
        codes = (*codes, 128 + number)

        def told(process: BaseProcess) -> None:
            _interrupt(process, number, after, scratch)

    try:
        code = alone(lambda: _main(arguments, folder, scratch), said, told)
        text = said.read_text(encoding="utf-8", errors="replace")
        if code not in codes:
            raise Wrong(f"exit code {code}")
        never = _NEVER_SAID.search(text)
        if never or (code and not text.strip()):
            raise Wrong(f"exit code {code}, said {never.group() if never else 'nothing'}")
        if left := [*scratch.iterdir()]:
            raise Wrong(f"left in the temporary folder: {left}")
        for path in [each for each in folder.rglob("*") if each.is_file()]:
            _refuse_half(path)
        return code
    except Wrong as error:
        text = said.read_text(encoding="utf-8", errors="replace") if said.exists() else ""
        raise Wrong(f"{error}\n  {list(arguments)}\n{text[-2500:]}") from None


def _main(arguments: Sequence[str], folder: Path, scratch: Path) -> int:
    os.chdir(folder)
    os.environ.update(TMPDIR=str(scratch), HOME=str(folder))
    tempfile.tempdir = None
    sys.argv = ["autobalancer", *arguments]
    from autobalancer.harness.__main__ import main

    try:
        main()
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else int(end.code is not None)
    return 0


def _interrupt(process: BaseProcess, number: int, after: float, scratch: Path) -> None:
    """Tell a process and its workers, as a terminal does, some time after it has begun."""
    while process.is_alive() and not any(scratch.iterdir()):
        time.sleep(0.002)
    process.join(after)
    if process.is_alive():
        os.killpg(process.pid or 0, number)


def _refuse_half(path: Path) -> None:
    """A file that was to be written is whole, or as it was before."""
    data = path.read_bytes()
    if path.name.startswith("."):
        raise Wrong(f"left {path.name}")
    if data == KEPT or "given" in path.parts or path.suffix in (".store", ".store-journal"):
        return
    try:
        whole = _READ.get(path.suffix, bool)(path if path.suffix in _BY_PATH else data)
    except Exception as error:
        raise Wrong(f"{path.name} is half: {error!r}") from None
    if not whole:
        raise Wrong(f"{path.name} is half: {len(data)} bytes")


def _table(path: Path) -> bool:
    with path.open(newline="", encoding="utf-8") as stream:
        rows = [row for row in csv.reader(stream) if row and not row[0].startswith("#")]
    return path.read_bytes().endswith(b"\n") and len({len(row) for row in rows}) == 1


def _image(path: Path) -> bool:
    with Image.open(path) as image:
        for number in range(getattr(image, "n_frames", 1)):
            image.seek(number)
            image.load()
    return True


def _archive(path: Path) -> bool:
    with zipfile.ZipFile(path) as archive:
        return archive.testzip() is None


_BY_PATH = {
    **dict.fromkeys((".png", ".gif", ".webp"), _image),
    **dict.fromkeys((".fmu", ".ssp"), _archive),
    ".csv": _table,
}
_READ: dict[str, Callable] = {
    **_BY_PATH,
    ".json": lambda data: json.loads(data) is not None,
    ".pdf": lambda data: data.startswith(b"%PDF") and data.rstrip().endswith(b"%%EOF"),
    ".svg": lambda data: ElementTree.fromstring(data) is not None,
    ".html": lambda data: data.rstrip().endswith(b"</html>"),
    ".mp4": lambda data: b"moov" in data,
}
