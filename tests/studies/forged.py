"""Forged states and crafted compositions under sanitizers: no crash, no hang, no changed instance.

    python -m tests.studies.forged [--states 20000] [--compositions 5000] [--first 0]

A state is saved, one or two of its values are changed, its checksum is made right, and an instance
takes it: the instance refuses it and is as before, or goes on with it.  A composition is the text
of a scene with counts, indices, sizes, start values or whole entries changed, under its right
identity.  The library is compiled with the address and the undefined-behaviour sanitizer;
`native/host/forge.c` makes the calls.
"""

from __future__ import annotations

import argparse
import random
import re
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from autobalancer.fmus.catalogue import sized_unit
from autobalancer.fmus.native.build.compile import SOURCE, SOURCES, one_source, stamp
from autobalancer.fmus.native.build.tokens import token
from autobalancer.harness import Scene, load_scene
from autobalancer.harness.master.one_file import composition

HOST = Path(__file__).parents[1] / "native" / "host" / "forge.c"
SANITIZED = (
    *("-std=c99", "-O1", "-g1", "-fno-omit-frame-pointer"),
    *("-fsanitize=address,undefined,float-cast-overflow", "-fno-sanitize-recover=all"),
)
SHARED = (*("-ffp-contract=off", "-fno-math-errno", "-fvisibility=hidden", "-shared", "-fPIC"),)
PHASE = 192 + 4 * 8  # where a state has its phase: behind the token and four times
VALUES = PHASE + 2 * 4
UNITS = (
    ("RotorOnSupports", {"planes": 2}),
    ("RotorOnSupports", {"kind": "two_support", "stations": 2, "sliders": 2, "stops": 2}),
    ("RotorOnSupports", {"kind": "flexible", "stations": 4, "planes": 2, "shaft": "compliance"}),
    ("RotorOnSupports", {"kind": "matrices", "stations": 3, "planes": 2, "supports": 1, "feet": 1}),
    ("LiquidBalancer", {}),
    ("RingBalancer", {}),
    ("BallBalancer", {"weights": 3}),
    ("BallBalancer", {"weights": 4, "unequal": 1}),
    ("Motor", {"points": 3}),
)
SCENES = ("two_balls", "balls_and_liquid", "goncharov_balls", "finite_weights", "bristol_friction")
SCENES += ("sommerfeld", "run_up", "contact_order", "three_mass_shaft", "liquid_touch")
SCENES += ("washing_machine_stops",)
AT_ONCE = 1000  # cases between two lines of the report
ENVIRONMENT = {"ASAN_OPTIONS": "detect_leaks=1:allocator_may_return_null=1"}


@dataclass
class Found:
    """What a study found.

    Attributes:
        cases: that were run.
        faults: number of a case and what went wrong in it.
        counts: line of the host for each of its runs: how many were refused, and accepted.
    """

    cases: int
    faults: list[tuple[int, str]] = field(default_factory=list)
    counts: list[str] = field(default_factory=list)


def sanitized(folder: Path) -> tuple[Path, Path]:
    """The host and a library with sanitizers, by the compiler of this machine."""
    source, library, host = folder / SOURCE, folder / "autobalancer.so", folder / "forge"
    source.write_text(one_source())
    options = (*SANITIZED, f"-I{SOURCES}", "-Wno-maybe-uninitialized")
    subprocess.run(
        ["cc", *options, *SHARED, str(source), "-o", str(library), "-lm"],
        check=True,
    )
    subprocess.run(
        ["cc", "-D_GNU_SOURCE", "-Wall", "-Wextra", *options, str(HOST), "-o", str(host), "-ldl"],
        check=True,
    )
    return host, library


def run(host: Path, library: Path, kind: str, file: Path, first: int, count: int) -> Found:
    """Run cases; behind one that ends the host it goes on with the next."""
    found = Found(count)
    at, end = first, first + count
    while at < end:
        words = [str(host), str(library), kind, str(file), str(at), str(end - at)]
        done = subprocess.run(
            words, capture_output=True, text=True, errors="replace", env=ENVIRONMENT, check=False
        )
        lines = done.stdout.splitlines()
        found.faults += [
            (int(number), claim)
            for number, claim in re.findall(r"^case (\d+): (.*)$", done.stderr, re.M)
        ]
        if lines and lines[-1].startswith("refused"):
            found.counts.append(lines[-1])
            if done.returncode > 1 or (done.returncode and not found.faults):
                found.faults.append((end - 1, _reason(done)))
            break
        last = int(lines[-1]) if lines else at
        found.faults.append((last, _reason(done)))
        at = last + 1
    return found


def _reason(done: subprocess.CompletedProcess[str]) -> str:
    """First line that says what went wrong, and where in the sources it was."""
    said = [line for line in done.stderr.splitlines() if "ERROR" in line or "runtime error" in line]
    place = re.findall(r"#\d+ \S+ in (\w+) (\S+)", done.stderr)
    here = " in " + " < ".join(name for name, _ in place[:3]) if place else ""
    return f"exit code {done.returncode}: " + (said or done.stderr.splitlines() or ["-"])[0] + here


# -- states -----------------------------------------------------------------------------------


def profile_of_all() -> Scene:
    """A scene with corners, changes of the unbalance and gravity."""
    return load_scene("two_balls").replace(
        {
            "operation.unbalance_changes": [
                {"time": 0.002, "amount": 1.0},
                {"time": 1.0, "amount": 0.5},
            ],
            "operation.gravity": 9.81,
        }
    )


def write_kinds(path: Path) -> None:
    """Tokens of all kinds with the ranges of their value references, as forge.c reads them."""
    kinds = []
    for unit, options in UNITS:
        sized = sized_unit(unit, **options)
        kinds.append((token(sized, stamp()), sized.layout))
    for scene in (*map(load_scene, SCENES), profile_of_all()):
        made = composition(scene)
        kinds.append((made.token(stamp()), made.described("Composite").layout))
    lines = []
    for identity, layout in kinds:
        first, end = layout.computed.start, layout.observed.stop
        lines += [identity, f"{layout.inputs.start} {first} {end - first} {end}"]
    path.write_text("\n".join(lines) + "\n")


# -- compositions -------------------------------------------------------------------------------

NUMBERS = (0, 1, 2, 3, 7, 127, 128, 255, 1000, 1001, 65535, 65536, 99999, 100000, 2**31 - 1, 2**31)
NUMBERS += (2**32 - 1, 2**32, 2**32 + 1, 2**63, 2**64 - 1, 2**64, 10**30)
BITS = ("0" * 16, "f" * 16, "7ff0000000000000", "fff0000000000000", "7ff8000000000000")
BITS += ("3ff0000000000000", "bff0000000000000", "7fefffffffffffff", "0000000000000001", "", "1")


@cache
def digest(text: str) -> str:
    """FNV-1a as sixteen hexadecimal digits."""
    total = 0xCBF29CE484222325
    for byte in text.encode("latin-1"):
        total = (total ^ byte) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    return f"{total:016x}"


def signed(text: str) -> str:
    """The composition with right digests of all its units."""
    return re.sub(
        r"(\w+/(?:[\w=.]+/)*)[0-9a-f]{16}-[0-9a-f]{16}",
        lambda found: f"{found[1]}{digest(found[1])}-{stamp()}",
        text,
    )


def _number(text: str, draw: random.Random) -> str:
    """Another whole number at one place."""
    places = list(re.finditer(r"(?<=[=,;/])\d+(?=[,;:/])", text))
    return _at(text, draw.choice(places), str(draw.choice(NUMBERS))) if places else text


def _size(text: str, draw: random.Random) -> str:
    """Another size of a unit: mostly one that a library might make."""
    places = list(re.finditer(r"(?<==)\d+(?=/)", text))
    some = draw.choice(NUMBERS) if draw.random() < 0.5 else draw.randrange(12)
    return _at(text, draw.choice(places), str(some)) if places else text


def _start(text: str, draw: random.Random) -> str:
    """Another start value, of any bits."""
    places = list(re.finditer(r"(?<=:)[0-9a-f]{16}", text))
    bits = draw.choice(BITS) if draw.random() < 0.6 else f"{draw.getrandbits(64):016x}"
    return _at(text, draw.choice(places), bits) if places else text


def _entries(text: str, draw: random.Random) -> str:
    """One entry left out, doubled, moved or cut."""
    entries = text.split(";")
    if len(entries) < 2:
        return text
    at, to = draw.randrange(1, len(entries)), draw.randrange(1, len(entries))
    chosen = draw.randrange(5)
    if chosen == 0:
        del entries[at]
    elif chosen == 1:
        entries.insert(to, entries[at])
    elif chosen == 2:
        entries[at], entries[to] = entries[to], entries[at]
    elif chosen == 3:
        entries[at] = entries[at][: draw.randrange(len(entries[at]) + 1)]
    else:
        entries += [entries[at]] * draw.choice((2, 20, 300))
    return ";".join(entries)


def _counts(text: str, draw: random.Random) -> str:
    """Corners, changes or corrections that nothing stands behind."""
    key = draw.choice(("corners", "changes", "corrections"))
    entries = [entry for entry in text.split(";") if not entry.startswith(f"{key}=")]
    entries.insert(draw.randrange(1, len(entries) + 1), f"{key}={draw.choice(NUMBERS)}")
    return ";".join(entries)


def _letters(text: str, draw: random.Random) -> str:
    """Some letters, or the end, changed; digests are right again afterwards."""
    if draw.random() < 0.3:
        return text[: draw.randrange(len(text))]
    for _ in range(draw.choice((1, 1, 2, 5))):
        at = draw.randrange(len(text))
        text = text[:at] + chr(draw.choice((*range(32, 127), 128, 255))) + text[at + 1 :]
    return text


def _at(text: str, place: re.Match[str], new: str) -> str:
    return text[: place.start()] + new + text[place.end() :]


CRAFTS: tuple[Callable[[str, random.Random], str], ...] = (
    *(_number, _size, _start, _entries, _counts, _letters),
)


def crafted(number: int, texts: Sequence[str]) -> str:
    """A composition with one to three things changed; the same for the same number."""
    draw = random.Random(number)
    text = draw.choice(texts)
    for _ in range(draw.choice((1, 1, 2, 3))):
        text = draw.choice(CRAFTS)(text, draw) or text
    return signed(text).replace("\n", " ").encode("latin-1", "replace").decode("latin-1")


def write_compositions(path: Path, numbers: range) -> None:
    """Crafted compositions, one a line; those before the first are empty lines."""
    scenes = (*map(load_scene, SCENES), profile_of_all())
    texts = [composition(scene).token(stamp()) for scene in scenes]
    with path.open("w", encoding="latin-1") as file:
        file.write("\n" * numbers.start)
        file.writelines(crafted(k, texts) + "\n" for k in numbers)


# -- the study ----------------------------------------------------------------------------------


def study(
    folder: Path, states: range, compositions: range, at_once: int = 1_000_000
) -> Iterator[tuple[str, Found]]:
    """Run these cases in a folder; what is found of each kind, `at_once` cases at a time."""
    host, library = sanitized(folder)
    kinds, texts = folder / "kinds.txt", folder / "compositions.txt"
    write_kinds(kinds)
    write_compositions(texts, compositions)
    for kind, file, cases in ("states", kinds, states), ("compositions", texts, compositions):
        for first in cases[::at_once]:
            count = min(at_once, cases.stop - first)
            yield kind, run(host, library, kind, file, first, count)


def report(kind: str, found: Found) -> str:
    """Lines that say what was found."""
    faults = [f"  case {number}: {words}" for number, words in found.faults]
    counts = "; ".join(found.counts)
    return "\n".join(
        [f"{kind}: {found.cases} cases, {len(found.faults)} faults; {counts}", *faults]
    )


def main() -> int:
    """Print what is found; 1 where something is."""
    parser = argparse.ArgumentParser(description="forged states and crafted compositions")
    parser.add_argument("--states", type=int, default=20_000)
    parser.add_argument("--compositions", type=int, default=5_000)
    parser.add_argument("--first", type=int, default=0)
    given = parser.parse_args()
    first = given.first
    faults = 0
    with TemporaryDirectory(prefix="autobalancer-") as folder:
        states = range(first, first + given.states)
        compositions = range(first, first + given.compositions)
        for kind, found in study(Path(folder), states, compositions, AT_ONCE):
            print(report(kind, found), flush=True)
            faults += len(found.faults)
    return faults > 0


if __name__ == "__main__":
    sys.exit(main())
