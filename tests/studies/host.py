"""Units and composites in a host in plain C, with nothing of Python around it.

    python -m tests.studies.host [INSTANCES]

A million short instances of each, one after the other, and 64 threads with three instances each;
`native/host/host.c` says what else it demands.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from fmpy import platform_tuple

from autobalancer.fmus.catalogue import sized_unit
from autobalancer.fmus.native.build.compile import SOURCES, libraries, stamp
from autobalancer.fmus.native.build.tokens import token
from autobalancer.fmus.variables import Layout
from autobalancer.harness import load_scene
from autobalancer.harness.master.one_file import composition

HOST = Path(__file__).parents[1] / "native" / "host"
UNITS = [
    ("RotorOnSupports", {"planes": 2}),
    ("RotorOnSupports", {"kind": "two_support", "stations": 2, "planes": 1, "frame": "fixed"}),
    ("RotorOnSupports", {"kind": "flexible", "stations": 3, "planes": 1}),
    ("LiquidBalancer", {}),
    ("BallBalancer", {"weights": 3}),
    ("Motor", {"points": 3}),
]
COMPOSITES = ["two_balls", "balls_and_liquid", "goncharov_balls", "finite_weights"]


def compiled(folder: Path, *flags: str) -> Path:
    """The host, by the compiler of this machine."""
    host = folder / "host"
    sources = [str(HOST / "host.c"), str(HOST / "counting.c")]
    base = ["-D_GNU_SOURCE", "-std=c99", "-O1", "-g", "-Wall", "-Wextra", "-Wno-unused-parameter"]
    libraries = ["-o", str(host), "-ldl", "-lpthread", "-lm"]
    command = ["cc", *base, f"-I{SOURCES}", "-rdynamic", *flags, *sources, *libraries]
    subprocess.run(command, check=True)
    return host


def words() -> list[str]:
    """Tokens and ranges of value references of all kinds, as the host takes them."""
    kinds: list[tuple[str, Layout]] = []
    for unit, options in UNITS:
        sized = sized_unit(unit, **options)
        kinds.append((token(sized, stamp()), sized.layout))
    for name in COMPOSITES:
        made = composition(load_scene(name))
        kinds.append((made.token(stamp()), made.described("Composite").layout))
    found: list[str] = []
    for identity, layout in kinds:
        inputs, first = layout.inputs, layout.computed.start
        numbers = (inputs.start, inputs.stop - inputs.start, first, layout.observed.stop - first)
        found += [identity, *map(str, numbers)]
    return found


def run(
    host: Path, library: Path, repeated: int, threads: int, **environment: str
) -> subprocess.CompletedProcess:
    """Run the host; `repeated` instances of each kind, and these threads."""
    command: Sequence[object] = [host, library, repeated, threads, *words()]
    return subprocess.run(
        list(map(str, command)), env=environment, capture_output=True, text=True, check=False
    )


def main() -> int:
    """Print what the host says; its exit code."""
    repeated = int(sys.argv[1]) if sys.argv[1:] else 1_000_000
    with TemporaryDirectory(prefix="autobalancer-") as folder:
        library = libraries([platform_tuple])[platform_tuple]
        done = run(compiled(Path(folder)), library, repeated, 64)
    print(done.stdout, done.stderr, sep="", end="")
    return done.returncode


if __name__ == "__main__":
    sys.exit(main())
