"""What holds for every command line: it ends by itself with a code and words; files are whole."""

from __future__ import annotations

import csv
import json
import os
import random
import re
import signal
import subprocess
import sys
import time
import zipfile
from collections.abc import Callable, Sequence
from pathlib import Path
from xml.etree import ElementTree

from PIL import Image

KEPT = b"kept\n"  # what stands in a file before a command that may replace it
_LONGEST = 600.0  # s: what takes longer is endless, on a busy machine too
_ORPHANS_END = 15.0  # s for processes to see that their parent is gone
_NEVER_SAID = re.compile(r"Traceback|Exception ignored|\w+Warning:|\x1b\[31m")


class Wrong(Exception):
    """What a command must never do."""


def refuse_wrong(arguments: Sequence[str], folder: Path, draw: random.Random | None = None) -> int:
    """Exit code of a command line in `folder`; with `draw` it is interrupted at some moment.

    Raises:
        Wrong: it was ended by a signal, was endless or left processes, a traceback or warning is
            shown, the exit code is not one of those documented, it failed without a word, or a
            file is half-written or left behind.
    """
    said, scratch = folder.parent / "said.txt", folder.parent / "scratch"
    scratch.mkdir()
    try:
        code = _run(arguments, folder, scratch, said, draw)
        text = said.read_text(encoding="utf-8", errors="replace")
        never = _NEVER_SAID.search(text)
        if never or (code and not text.strip()):
            raise Wrong(f"exit code {code}, said {never.group() if never else 'nothing'}")
        if left := [*scratch.iterdir()]:
            raise Wrong(f"left in the temporary folder: {left}")
        for path in [each for each in folder.rglob("*") if each.is_file()]:
            _refuse_half(path)
        return code
    except Wrong as error:
        text = said.read_text(encoding="utf-8", errors="replace")
        raise Wrong(f"{error}\n  {list(arguments)}\n{text[-2500:]}") from None


def _run(
    arguments: Sequence[str], folder: Path, scratch: Path, said: Path, draw: random.Random | None
) -> int:
    """Exit code of a command in a process group of its own, whose output goes to `said`."""
    codes = [0, 1, 2]
    with said.open("wb") as output:
        process = subprocess.Popen(
            [sys.executable, "-m", "autobalancer.harness", *map(os.fsencode, arguments)],
            cwd=folder,
            env={**os.environ, "TMPDIR": str(scratch)},
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
    if draw is not None:
        number, after = draw.choice((signal.SIGINT, signal.SIGTERM)), draw.random() ** 2 * 3.0
        codes.append(128 + number)
        _interrupt(process, number, after, scratch)
    try:
        code = process.wait(_LONGEST)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        raise Wrong(f"not done after {_LONGEST:g} s") from None
    if code not in codes:
        raise Wrong(f"ended by {signal.Signals(-code).name}" if code < 0 else f"exit code {code}")
    _refuse_orphans(process.pid)
    return code


def _interrupt(process: subprocess.Popen, number: int, after: float, scratch: Path) -> None:
    """Signal a process and its workers, as a terminal does, some time after it has begun."""
    while process.poll() is None and not any(scratch.iterdir()):
        time.sleep(0.002)
    try:
        process.wait(after)
    except subprocess.TimeoutExpired:
        if any(scratch.iterdir()):  # else its work is done, and the interpreter ends
            os.killpg(process.pid, number)


def _refuse_orphans(group: int) -> None:
    until = time.monotonic() + _ORPHANS_END
    while time.monotonic() < until:
        try:
            os.killpg(group, 0)
        except ProcessLookupError:
            return
        time.sleep(0.01)
    os.killpg(group, signal.SIGKILL)
    raise Wrong("left processes behind")


def _refuse_half(path: Path) -> None:
    """A file that was to be written is whole, or as it was before."""
    data = path.read_bytes()
    if path.name.startswith("."):
        raise Wrong(f"left {path.name}")
    if data == KEPT or {"given", "live"} & {*path.parts}:  # a live page of the manual has no end
        return
    if path.suffix in (".store", ".store-journal"):
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
