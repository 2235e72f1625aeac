"""A scene in tools that nobody here wrote: how far each is off, and what a step takes it."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from fmpy import platform_tuple

from autobalancer.harness import Scene, load_scene
from autobalancer.harness.accuracy.precision.reference import right_motion
from autobalancer.harness.errors import SimulationError
from autobalancer.harness.export.one_file import build_one_file
from autobalancer.harness.export.ssp.build import build_ssp
from autobalancer.harness.master.schedule import end_time, step_size
from tests.studies.tools import drivers

SCENE = "two_balls"
SIGNALS = ("rotor.x", "rotor.y")
VALUES, SLOPES = "SSP, values alone", "SSP, values and slopes"
ONE_SSP, ONE_FMU = "SSP, composite", "composite FMU"
SEPARATE = (VALUES, SLOPES)
PACKAGES = (*SEPARATE, ONE_SSP)
PATHSIM = "PATHSIM_PYTHON"  # of an environment with pathsim and fmpy
COFMUPY = "COFMUPY_PYTHON"  # it needs older versions of FMPy and pythonfmu than we do
_TIMEOUT = 600  # s


@dataclass(frozen=True)
class Tool:
    """A tool: what it is found by, and what it runs by which driver.

    Attributes:
        needs: a module, a program on PATH, or a variable of the environment that names the Python
            of a tool with an environment of its own.
    """

    name: str
    needs: str
    runs: dict[str, str]

    @property
    def present(self) -> bool:
        """Whether this machine has it."""
        return any(find(self.needs) for find in (find_spec, shutil.which, os.environ.get))

    @property
    def python(self) -> str:
        """The interpreter that drives it."""
        return os.environ.get(self.needs, sys.executable)


TOOLS = (
    Tool("FMPy", "fmpy", {**dict.fromkeys(PACKAGES, "fmpy_ssp"), ONE_FMU: "fmpy_fmu"}),
    Tool("libcosim", "libcosimpy", dict.fromkeys(PACKAGES, "libcosim")),
    Tool("ecos", "ecospy", dict.fromkeys(PACKAGES, "ecos")),
    Tool("CoFMuPy, jacobi", COFMUPY, dict.fromkeys(SEPARATE, "cofmupy_jacobi")),
    Tool("CoFMuPy, gauss_seidel", COFMUPY, dict.fromkeys(SEPARATE, "cofmupy_gauss_seidel")),
    Tool("OMSimulator", "OMSimulator", dict.fromkeys(PACKAGES, "omsimulator")),
    Tool("fmusim", "fmusim", {ONE_FMU: "fmusim"}),
)


@dataclass(frozen=True)
class Row:
    """A tool with one kind of file at a number of steps per revolution.

    Attributes:
        error: largest of x and y over the largest amplitude; None where it does not run.
        seconds: a step.
        said: why it does not run.
    """

    error: float | None
    seconds: float | None = None
    said: str = ""


class Bench:
    """Files of the scene in a folder, and its right motion."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._scene = load_scene(SCENE)
        self._right = cache(self._motion)
        self._file = cache(self._built)

    def run(self, tool: Tool, what: str, steps: int) -> Row:
        """Run a tool in steps of its own; the composite keeps the scene's inside."""
        scene = self._at(steps)
        step, count = step_size(scene), round(end_time(scene) / step_size(scene))
        try:
            prefix = f"{scene.name}." if what == ONE_SSP else ""
            names = [prefix + name for name in SIGNALS]
            seconds, rows = driven(tool, what, self._file(what, steps), step, count, names)
        except SimulationError as error:
            return Row(None, said=str(error))
        right = self._right(steps)
        if rows.shape != right.shape:
            return Row(None, said=f"ended after {len(rows)} of {count} steps")
        error = float(np.abs(rows - right).max() / np.abs(right).max())
        return Row(error, seconds / count)

    def _at(self, steps: int) -> Scene:
        return self._scene.replace({"coupling.steps_per_rev": steps})

    def _motion(self, steps: int) -> np.ndarray:
        scene = self._at(steps)
        count = round(end_time(scene) / step_size(scene))
        times = np.arange(1, count + 1) * step_size(scene)
        right, _ = right_motion(scene, SIGNALS, [times])
        return np.column_stack([right.signal(name)[1:] for name in SIGNALS])

    def _built(self, what: str, steps: int) -> Path:
        stem = self._folder / f"{what.replace(', ', '-').replace(' ', '_')}-{steps}"
        if what == ONE_FMU:
            return build_one_file(self._scene, stem.with_suffix(".fmu"), 2, [platform_tuple])
        one = what == ONE_SSP
        scene = self._scene if one else self._at(steps)
        return build_ssp(
            scene,
            stem.with_suffix(".ssp"),
            one_file=one,
            slopes=what == SLOPES,
            platforms=[platform_tuple],
        )


def driven(
    tool: Tool, what: str, file: Path, step: float, count: int, names: list[str]
) -> tuple[float, np.ndarray]:
    # libraries that pip puts beside the interpreter's, as TBB for ecos, are not searched by default
    beside = [f"{sys.prefix}/lib", os.environ.get("LD_LIBRARY_PATH", "")]
    done = subprocess.run(
        [tool.python, drivers.__file__, tool.runs[what], str(file), repr(step), str(count), *names],
        env={**os.environ, "LD_LIBRARY_PATH": os.pathsep.join(filter(None, beside))},
        capture_output=True,
        text=True,
        timeout=_TIMEOUT,
        check=False,
    )
    answers = [line for line in done.stdout.splitlines() if line.startswith("RUN ")]
    if not answers:
        said = (done.stderr.strip() or done.stdout.strip() or "nothing said").splitlines()[-1]
        raise SimulationError(f"code {done.returncode}: {said}")
    seconds, rows = json.loads(answers[-1].removeprefix("RUN "))
    return seconds, np.array(rows)


def every_run() -> Iterator[tuple[Tool, str]]:
    """Every tool on this machine with everything it can run."""
    return ((tool, what) for tool in TOOLS if tool.present for what in tool.runs)
