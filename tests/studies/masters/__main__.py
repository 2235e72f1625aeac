"""Our master and others on problems with exact solutions: error and run time.

`python -m tests.studies.masters [NAME ...]` prints the table of `results/masters.md`, of all
problems or those whose names hold one of the words.  The errors are of displacements, the largest
over the largest value.  Seconds are of the processor; of our master with
loading and start, of others of the steps alone.
"""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
import time as clock
import zipfile
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from xml.sax.saxutils import quoteattr

import numpy as np
from fmpy import read_model_description

import autobalancer as ab
from tests.studies.masters.problems import PROBLEMS, Problem
from tests.studies.tools.measure import COFMUPY, PATHSIM

ROOT = Path(__file__).parents[3]
GUESTS = ROOT / "tests" / "guests"
DRIVER = ROOT / "tests" / "studies" / "tools" / "drivers.py"
OTHERS = {
    "fmpy_ssp": "FMPy, SSP",
    "libcosim": "libcosim, fixed step",
    "ecco": "libcosim, ECCO",
    "ecos": "ecos",
    "pathsim": "PathSim",
    "cofmupy_jacobi": "CoFMuPy, Jacobi",
    "cofmupy_gauss_seidel": "CoFMuPy, Gauss-Seidel",
}
SCHEMES = ("jacobi", "gauss-seidel", "iterated")
LONGEST = 120.0  # s of a run
KINDS = {"input": "input", "output": "output", "parameter": "parameter"}
SSD = "http://ssp-standard.org/SSP1/SystemStructure"


def built(folder: Path) -> dict[str, Path]:
    """FMUs of the guests, by name."""
    from pythonfmu.builder import FmuBuilder

    names = sorted({guest for p in PROBLEMS for guest, _ in p.units.values()})
    return {
        name: Path(
            FmuBuilder.build_FMU(GUESTS / f"{name}.py", dest=folder, canGetAndSetFMUstate=True)
        )
        for name in names
    }


def system_of(problem: Problem, fmus: dict[str, Path], **coupling: object) -> ab.System:
    """A problem for our master."""
    return ab.System(
        unit=[
            {"name": name, "fmu": str(fmus[guest]), "start": start}
            for name, (guest, start) in problem.units.items()
        ],
        connection=[{"from": s, "to": t} for s, t in problem.wires],
        coupling=coupling,
        run={"duration": problem.duration, "record": list(problem.exact(np.zeros(1)))},
    )


def write_ssp(problem: Problem, fmus: dict[str, Path], path: Path) -> None:
    """A problem for others."""
    elements, parameters = [], []
    for name, (guest, start) in problem.units.items():
        variables = read_model_description(str(fmus[guest])).modelVariables
        connectors = "".join(
            f'<ssd:Connector name={quoteattr(v.name)} kind="{KINDS[v.causality]}"><ssc:Real/>'
            "</ssd:Connector>"
            for v in variables
            if v.causality in KINDS
        )
        own = "".join(
            f'<ssv:Parameter name="{k}"><ssv:Real value="{v!r}"/></ssv:Parameter>'
            for k, v in start.items()
        )
        elements.append(
            f'<ssd:Component name="{name}" source="resources/{fmus[guest].name}" '
            f"><ssd:Connectors>{connectors}</ssd:Connectors><ssd:ParameterBindings>"
            f'<ssd:ParameterBinding><ssd:ParameterValues><ssv:ParameterSet version="1.0" '
            f'name="start"><ssv:Parameters>{own}</ssv:Parameters></ssv:ParameterSet>'
            "</ssd:ParameterValues></ssd:ParameterBinding></ssd:ParameterBindings>"
            "</ssd:Component>"
        )
        parameters.append(own.replace('name="', f'name="{name}.'))
    wires = []
    for source, target in problem.wires:
        (a, x), (b, y) = source.split("."), target.split(".")
        wires.append(
            f'<ssd:Connection startElement="{a}" startConnector="{x}" endElement="{b}" '
            f'endConnector="{y}"/>'
        )
    names = f'xmlns:ssd="{SSD}Description" xmlns:ssc="{SSD}Common" '
    names += f'xmlns:ssv="{SSD}ParameterValues"'
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(
            "SystemStructure.ssd",
            f'<?xml version="1.0" encoding="UTF-8"?><ssd:SystemStructureDescription {names} '
            'version="1.0" name="problem"><ssd:System name="system"><ssd:ParameterBindings>'
            '<ssd:ParameterBinding source="resources/parameters.ssv"/></ssd:ParameterBindings>'
            f"<ssd:Elements>{''.join(elements)}</ssd:Elements><ssd:Connections>{''.join(wires)}"
            "</ssd:Connections></ssd:System></ssd:SystemStructureDescription>",
        )
        archive.writestr(
            "resources/parameters.ssv",
            f'<?xml version="1.0" encoding="UTF-8"?><ssv:ParameterSet {names} version="1.0" '
            f'name="start"><ssv:Parameters>{"".join(parameters)}</ssv:Parameters>'
            "</ssv:ParameterSet>",
        )
        for fmu in {fmus[guest] for guest, _ in problem.units.values()}:
            archive.write(fmu, f"resources/{fmu.name}")


def deviation(problem: Problem, time: np.ndarray, signals: dict[str, np.ndarray]) -> float:
    """Largest error of any signal, over its largest value."""
    exact = problem.exact(time)
    shares = [np.abs(signals[n] - e).max() / np.abs(e).max() for n, e in exact.items()]
    return float(max(shares)) if np.isfinite(shares).all() else math.inf


def ours(problem: Problem, fmus: dict[str, Path], **coupling: object) -> list[str]:
    """Cells of our master: error, stated error, seconds of the steps."""
    begun = clock.process_time()
    try:
        result = system_of(problem, fmus, **coupling).run()
    except ab.SimulationError:
        return ["refused", "", ""]
    seconds = clock.process_time() - begun
    found = deviation(problem, result.time, result.signals)
    stated = f"{result.estimated_error:.1e}" if "tolerance" in coupling else ""
    return [f"{found:.1e}", stated, f"{seconds:.2g}"]


def theirs(problem: Problem, tool: str, ssp: Path, step: float) -> list[str]:
    """Cells of another master."""
    count, names = round(problem.duration / step), list(problem.exact(np.zeros(1)))
    own = {"cofmupy": COFMUPY, "pathsim": PATHSIM}.get(tool.partition("_")[0])
    python = os.environ.get(own, "") if own else sys.executable
    if not python:
        return [f"not run: {own} names no Python", "", ""]
    words = [python, str(DRIVER), tool, str(ssp), repr(step), str(count), *names]
    beside = [f"{sys.prefix}/lib", os.environ.get("LD_LIBRARY_PATH", "")]  # of ecos
    env = {
        **os.environ,
        "PROCESSOR_TIME": "1",
        "LD_LIBRARY_PATH": os.pathsep.join(filter(None, beside)),
    }
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=LONGEST, env=env)
    except subprocess.TimeoutExpired:
        return ["not done", "", f"> {LONGEST:g}"]
    line = next((x for x in done.stdout.splitlines() if x.startswith("RUN ")), None)
    if line is None:
        return [f"failed: {(done.stderr.strip().splitlines() or ['?'])[-1][:60]}", "", ""]
    seconds, rows = json.loads(line[4:])
    if len(rows) < count:
        return ["ended early", "", ""]
    table = np.array(rows, float)[:count].T
    time = step * np.arange(1, count + 1)
    found = deviation(problem, time, dict(zip(names, table, strict=True)))
    return [f"{found:.1e}" if found < math.inf else "inf, as a success", "", f"{seconds:.2g}"]


def rows_of(problem: Problem, fmus: dict[str, Path], ssp: Path) -> Iterator[list[str]]:
    """Lines of the table."""
    for step in problem.steps:
        for scheme in SCHEMES:
            cells = ours(problem, fmus, step=step, scheme=scheme)
            yield [f"ours, {scheme}", f"{step:g} s", *cells]
        for tool, name in OTHERS.items():
            yield [name, f"{step:g} s", *theirs(problem, tool, ssp, step)]
    for tolerance in (1e-3, 1e-4):
        cells = ours(problem, fmus, tolerance=tolerance)
        yield ["ours, tolerance", f"{tolerance:g}", *cells]


def main() -> None:
    """Print the tables of the problems that are asked for."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        fmus = built(folder)
        for problem in PROBLEMS:
            if sys.argv[1:] and not any(word in problem.name for word in sys.argv[1:]):
                continue
            ssp = folder / "problem.ssp"
            write_ssp(problem, fmus, ssp)
            title, about = (text[0].upper() + text[1:] for text in (problem.name, problem.about))
            print(f"\n## {title}\n\n{about}.\n")
            print("| master | step or tolerance | error | stated | s |\n|---|---|---|---|---|")
            for row in rows_of(problem, fmus, ssp):
                print(f"| {' | '.join(row)} |".replace("|  |", "| |"), flush=True)


if __name__ == "__main__":
    main()
