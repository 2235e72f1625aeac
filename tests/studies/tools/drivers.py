"""One run in a tool that nobody here wrote, in a process of its own: its libraries meet no other's.

    python drivers.py TOOL FILE STEP COUNT SIGNAL...

prints `RUN` and, in JSON, seconds and a row of the signals at the end of every step.
"""

from __future__ import annotations

import csv
import ctypes
import json
import os
import subprocess
import sys
import tempfile
import time as clock
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

# of the processor, where the caller asks for it: on a busy machine clocks say little
now = clock.process_time if os.environ.get("PROCESSOR_TIME") else clock.perf_counter
Answer = tuple[float, list[list[float]]]
PARAMETERS = "resources/parameters.ssv"


def fmpy_ssp(path: str, step: float, count: int, signals: Sequence[str]) -> Answer:
    from fmpy.ssp.simulation import simulate_ssp
    from fmpy.ssp.ssd import read_ssv

    parameters = read_ssv(path, PARAMETERS)
    begun = now()
    found = simulate_ssp(path, 0.0, (count - 0.5) * step, step, parameters)
    return now() - begun, [[float(row[name]) for name in signals] for row in found]


def fmpy_fmu(path: str, step: float, count: int, signals: Sequence[str]) -> Answer:
    from fmpy import simulate_fmu

    begun = now()
    found = simulate_fmu(
        path, stop_time=count * step, step_size=step, output_interval=step, output=list(signals)
    )
    rows = [[float(row[name]) for name in signals] for row in found]
    return now() - begun, rows[1:]


def libcosim(path: str, step: float, count: int, signals: Sequence[str]) -> Answer:
    from libcosimpy import _internal
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver

    try:
        execution = CosimExecution.from_ssp_file(path, round(step * 1e9))
    except AssertionError:
        said = _internal.libcosimc().cosim_last_error_message
        said.restype = ctypes.c_char_p
        raise RuntimeError(said().decode()) from None
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    reads = []
    for element, name in (signal.split(".", 1) for signal in signals):
        index = execution.slave_index_from_instance_name(element)
        references = {v.name.decode(): v.reference for v in execution.slave_variables(index)}
        reads.append((index, [references[name]]))
    rows = []
    begun = now()
    for _ in range(count):
        if not execution.step():
            break
        rows.append([observer.last_real_values(index, refs)[0] for index, refs in reads])
    return now() - begun, rows


def ecos(path: str, step: float, count: int, signals: Sequence[str]) -> Answer:
    from ecospy import EcosSimulation

    names = [signal.replace(".", "::", 1) for signal in signals]
    with EcosSimulation(step, ssp_path=path) as simulation:
        simulation.init(0, "start")
        rows = []
        begun = now()
        for _ in range(count):
            simulation.step(1)
            rows.append([simulation.get_real(name) for name in names])
        return now() - begun, rows


def cofmupy(
    path: str, step: float, count: int, signals: Sequence[str], method: str = "jacobi"
) -> Answer:
    """It reads no packages: FMUs, connections and start values are handed to it, rotor first."""
    from cofmupy.master.default_master import DefaultMaster
    from fmpy import extract
    from fmpy.ssp.ssd import get_connections, read_ssd, read_ssv

    system, folder = read_ssd(path).system, extract(path)
    connections: dict[tuple[str, str], list[tuple[str, str]]] = {}
    for start, end in get_connections(system):
        target = (end.parent.name, end.name)
        connections.setdefault((start.parent.name, start.name), []).append(target)
    start = [(p.name.partition("."), float(p.value)) for p in read_ssv(path, PARAMETERS).parameters]
    fmus = [
        {
            "id": one.name,
            "path": f"{folder}/{one.source}",
            "initialization": {name: x for (unit, _, name), x in start if unit == one.name},
        }
        for one in system.elements
    ]
    order = [[one.name for one in system.elements]]
    master = DefaultMaster(fmus, connections, order, cosim_method=method)
    master.init_simulation()
    begun = now()
    for _ in range(count):
        master.do_step(step)
    seconds = now() - begun
    found = master.get_results()
    columns = [found[tuple(signal.split(".", 1))] for signal in signals]
    return seconds, [[float(x) for x in row] for row in zip(*columns, strict=True)]


def ecco(path: str, step: float, count: int, signals: Sequence[str]) -> Answer:
    """libcosim's ECCO, whose step follows what the bonds of velocity and force miss in energy."""
    import numpy as np
    from fmpy import extract, read_model_description
    from fmpy.ssp.ssd import get_connections, read_ssd, read_ssv
    from libcosimpy.CosimAlgorithm import CosimAlgorithm, EccoParams
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    system, folder = read_ssd(path).system, extract(path)
    steps = {"step_size": step, "min_step_size": step / 100.0, "max_step_size": step}
    algorithm = CosimAlgorithm.create_ecco_algorithm(EccoParams(**steps))
    execution = CosimExecution.from_algorithm(algorithm)
    index, reference = {}, {}
    for one in system.elements:
        file = f"{folder}/{one.source}"
        index[one.name] = execution.add_local_slave(
            CosimLocalSlave(fmu_path=file, instance_name=one.name)
        )
        reference[one.name] = {
            v.name: v.valueReference for v in read_model_description(file).modelVariables
        }
    for parameter in read_ssv(path, PARAMETERS).parameters:
        unit, _, name = parameter.name.partition(".")
        execution.real_initial_value(index[unit], reference[unit][name], float(parameter.value))
    wires = [(a.parent.name, a.name, b.parent.name, b.name) for a, b in get_connections(system)]
    for a, x, b, y in wires:
        execution.connect_real_variables(index[a], reference[a][x], index[b], reference[b][y])
    for a, x, b, y in wires:  # a velocity, and the force that answers it
        back = [(p, q) for c, p, d, q in wires if (c, d) == (b, a) and q == "F"]
        for p, q in back if x == "v" else ():
            algorithm.add_power_bond(
                index[a], reference[a][x], reference[a][q],
                index[b], reference[b][p], reference[b][y],
            )  # fmt: skip
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    reads = [(index[u], [reference[u][n]]) for u, n in (s.split(".", 1) for s in signals)]
    times, found = [0.0], []
    begun = now()
    while times[-1] < count * step * (1.0 - 1e-9) and execution.step():
        found.append([observer.last_real_values(k, refs)[0] for k, refs in reads])
        times.append(execution.status().current_time * 1e-9)
    seconds = now() - begun
    wanted = step * np.arange(1, count + 1)
    columns = [np.interp(wanted, times[1:], column) for column in zip(*found, strict=True)]
    return seconds, [[float(x) for x in row] for row in zip(*columns, strict=True)]


def pathsim(path: str, step: float, count: int, signals: Sequence[str]) -> Answer:
    """Its blocks step at equal times, each on what the others showed before.

    A step begins at its communication point and shows its end there: rows are read half a step
    later.
    """
    import warnings

    from fmpy import extract
    from fmpy.ssp.ssd import get_connections, read_ssd, read_ssv
    from pathsim import Connection, Simulation

    warnings.simplefilter("ignore")
    try:
        from pathsim_fmi import CoSimulationFMU
    except ImportError:
        from pathsim.blocks import CoSimulationFMU

    system, folder = read_ssd(path).system, extract(path)
    start = [(p.name.partition("."), float(p.value)) for p in read_ssv(path, PARAMETERS).parameters]
    blocks = {
        one.name: CoSimulationFMU(
            f"{folder}/{one.source}",
            one.name,
            {name: x for (unit, _, name), x in start if unit == one.name},
            dt=step,
        )
        for one in system.elements
    }
    wires = [
        Connection(blocks[a.parent.name][a.name], blocks[b.parent.name][b.name])
        for a, b in get_connections(system)
    ]
    simulation = Simulation(list(blocks.values()), wires, dt=0.5 * step, log=False)
    rows: list[list[float]] = []
    begun = now()
    for _ in range(count):
        simulation.run(step if rows else 0.5 * step, reset=False)
        rows.append(
            [float(blocks[unit].outputs[name]) for unit, name in (s.split(".", 1) for s in signals)]
        )
    return now() - begun, rows


def omsimulator(path: str, step: float, count: int, signals: Sequence[str]) -> Answer:
    """It takes its step from the package."""
    options = [f"--stopTime={count * step!r}", "--suppressPath=true", "--skipCSVHeader=true"]
    return _program(
        lambda file: ["OMSimulator", path, *options, f"--resultFile={file}"], step, count, signals
    )


def fmusim(path: str, step: float, count: int, signals: Sequence[str]) -> Answer:
    options = ["--interface-type", "cs", "--stop-time", repr(count * step)]
    options += ["--output-interval", repr(step)]
    options += [word for name in signals for word in ("--output-variable", name)]
    return _program(
        lambda file: ["fmusim", *options, "--output-file", str(file), path], step, count, signals
    )


def _program(
    command: Callable[[Path], list[str]], step: float, count: int, signals: Sequence[str]
) -> Answer:
    """A program that writes a CSV file, whose columns end in the signals' names."""
    with tempfile.TemporaryDirectory(prefix="autobalancer-") as folder:
        file = Path(folder) / "result.csv"
        begun = now()
        subprocess.run(command(file), cwd=folder, check=True, stdout=subprocess.PIPE)
        seconds = now() - begun
        with file.open(newline="", encoding="utf-8") as text:
            header, *table = csv.reader(text)
    columns = [next(i for i, h in enumerate(header) if h.endswith(name)) for name in signals]
    points = {round(float(row[0]) / step): [float(row[i]) for i in columns] for row in table}
    return seconds, [points[k] for k in range(1, count + 1)]


DRIVERS: dict[str, Callable[[str, float, int, Sequence[str]], Answer]] = {
    "fmpy_ssp": fmpy_ssp,
    "fmpy_fmu": fmpy_fmu,
    "libcosim": libcosim,
    "ecos": ecos,
    "cofmupy_jacobi": cofmupy,
    "cofmupy_gauss_seidel": partial(cofmupy, method="gauss_seidel"),
    "ecco": ecco,
    "omsimulator": omsimulator,
    "pathsim": pathsim,
    "fmusim": fmusim,
}

if __name__ == "__main__":
    tool, file_name, step_text, count_text, *names = sys.argv[1:]
    answer = DRIVERS[tool](file_name, float(step_text), int(count_text), names)
    print("RUN " + json.dumps(answer))
