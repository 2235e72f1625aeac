"""A host in plain C, with nothing of Python around it: `host/host.c` says what it demands."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from autobalancer.fmus.native.build.compile import SOURCES
from autobalancer.harness import load_scene
from autobalancer.harness.master.one_file import composition

pytestmark = pytest.mark.slow

HOST = Path(__file__).with_name("host")
UNITS = [
    ("RotorOnSupports", {"planes": 2}),
    ("RotorOnSupports", {"kind": "two_support", "stations": 2, "planes": 1, "frame": "fixed"}),
    ("RotorOnSupports", {"kind": "flexible", "stations": 3, "planes": 1}),
    ("LiquidBalancer", {}),
    ("BallBalancer", {"weights": 3}),
]
COMPOSITES = ["two_balls", "balls_and_liquid", "goncharov_balls", "finite_weights"]


def compiled(folder: Path, *flags: str, counting: str = "counting.c") -> Path:
    host = folder / "host"
    sources = [str(HOST / "host.c"), str(HOST / counting)]
    base = [
        "cc",
        "-D_GNU_SOURCE",
        "-std=c99",
        "-O1",
        "-g",
        "-Wall",
        "-Wextra",
        "-Wno-unused-parameter",
    ]
    libraries = ["-o", str(host), "-ldl", "-lpthread", "-lm"]
    subprocess.run([*base, f"-I{SOURCES}", "-rdynamic", *flags, *sources, *libraries], check=True)
    return host


def words(fmus, packaging) -> list[str]:
    """The units for the host: tokens and ranges of value references."""
    found: list[str] = []
    for unit, options in UNITS:
        layout = fmus.layout(unit, **options)
        inputs, computed, observed = layout.inputs, layout.computed, layout.observed
        numbers = [inputs.start, inputs.stop - inputs.start]
        numbers += [computed.start, observed.stop - computed.start]
        found += [fmus.token(unit, **options), *map(str, numbers)]
    for name in COMPOSITES:
        made = composition(load_scene(name))
        layout = made.described("Composite").layout
        numbers = [layout.inputs.start, layout.inputs.stop - layout.inputs.start]
        numbers += [layout.computed.start, layout.observed.stop - layout.computed.start]
        found += [made.token(packaging.STAMP), *map(str, numbers)]
    return found


def run(command: list[str], **environment: str) -> subprocess.CompletedProcess:
    return subprocess.run(command, env=environment, capture_output=True, text=True, timeout=300)


def test_a_plain_host_finds_nothing_wrong(fmus, packaging, tmp_path):
    place = tmp_path / "Jörg (1) + [x] 'y' %s#"
    place.mkdir()
    library = shutil.copy(fmus.library, place)
    done = run([str(compiled(tmp_path)), str(library), *words(fmus, packaging)])
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == f"{len(UNITS) + len(COMPOSITES)} units, 0 failures\n"


def test_sanitizers_find_nothing_either(fmus, packaging, tmp_path):
    flags = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-g1"]
    library = packaging.compile_units(tmp_path / "sanitized", *flags, "-Og")
    host = compiled(tmp_path, *flags, counting="not_counting.c")
    done = run([str(host), str(library), *words(fmus, packaging)], ASAN_OPTIONS="detect_leaks=1")
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == f"{len(UNITS) + len(COMPOSITES)} units, 0 failures\n"


def test_the_library_has_no_state_of_its_own(fmus):
    """Instances in any number of threads share constants alone."""
    table = subprocess.run(
        ["objdump", "-h", str(fmus.library)], capture_output=True, text=True, check=True
    ).stdout
    sections = set(re.findall(r"^ +\d+ (\S+)", table, re.MULTILINE))
    assert ".rodata" in sections
    assert not sections & {".data", ".bss", ".tdata", ".tbss"}
