"""The units in a host in plain C: a million short lives of each, and 64 threads at once.

python -m tests.host [CYCLES]
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import fmpy

from autobalancer.fmus.build import build
from autobalancer.fmus.catalogue import CATALOGUE
from autobalancer.fmus.native.build.compile import SOURCES
from autobalancer.harness import load_scene
from autobalancer.harness.output.machine import machine
from autobalancer.harness.output.table import Sheet

THREADS, MOST_GROWTH = 64, 256  # kB, of a million cycles
SCENE = "two_balls"


def compiled(folder: Path) -> Path:
    """The host, by the compiler of this machine."""
    host, source = folder / "cycles", Path(__file__).with_name("cycles.c")
    flags = ["-D_GNU_SOURCE", "-std=c99", "-O1", "-Wall", "-Wextra", "-Werror", f"-I{SOURCES}"]
    subprocess.run(["cc", *flags, "-o", str(host), str(source), "-ldl", "-lpthread"], check=True)
    return host


def measured(host: Path, fmu: Path, cycles: int) -> tuple[float, int]:
    """Time of a cycle [us] and growth of the memory [kB].

    Raises:
        RuntimeError: a run fails, has other bits than the first, or the memory grows.
    """
    folder = Path(fmpy.extract(str(fmu), str(fmu.with_suffix(""))))
    found = fmpy.read_model_description(str(folder))
    name = found.coSimulation.modelIdentifier
    outputs = [
        str(v.valueReference)
        for v in found.modelVariables
        if v.causality == "output" and v.type == "Real"
    ]
    library = folder / "binaries" / "linux64" / f"{name}.so"
    words = [library, found.guid, (folder / "resources").as_uri(), cycles, THREADS, *outputs]
    done = subprocess.run([str(host), *map(str, words)], capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"{fmu.name}: {done.stderr.strip() or f'exit {done.returncode}'}")
    each, growth = done.stdout.split()
    if int(growth) > MOST_GROWTH:
        raise RuntimeError(f"{fmu.name}: memory grows by {growth} kB in {cycles} cycles")
    return float(each), int(growth)


def main() -> None:
    """Print the table."""
    cycles = int(sys.argv[1]) if sys.argv[1:] else 1_000_000
    rows = []
    with TemporaryDirectory(prefix="autobalancer-") as place:
        folder = Path(place)
        host = compiled(folder)
        files = [
            build(unit, folder / f"{unit}.fmu", platforms=["x86_64-linux"]) for unit in CATALOGUE
        ]
        one = load_scene(SCENE).build(folder, one_file=True, platforms=["x86_64-linux"])
        for fmu in [*files, *one.files]:
            each, growth = measured(host, fmu, cycles)
            rows.append([fmu.stem, f"{cycles:,}", f"{each:.1f} us", f"{growth} kB", "same bits"])
            print(*rows[-1], flush=True)
    columns = ("unit", "cycles", "a cycle", "memory growth", f"{THREADS} threads")
    print(f"\n{Sheet(columns, rows, 'lrrrl').markdown()}\n\n{machine()}")


if __name__ == "__main__":
    main()
