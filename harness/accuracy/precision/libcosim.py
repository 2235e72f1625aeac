"""The same FMUs in libcosim, as most tools couple them: Jacobi with held signals.

libcosim brings its own loader of FMUs, so it runs in a process of its own; loading is not timed.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from xml.sax.saxutils import quoteattr

import numpy as np

from ...errors import SimulationError
from ...master.cosimulation import CoSimulation
from ...master.names import by_unit
from ...master.plan import Port
from ...master.schedule import end_time, step_size
from ...master.start import start_inputs
from ...scene import Scene
from .runner import TimedRun

NANOSECOND = 1e-9  # s: libcosim counts time in whole ones
_TIMEOUT = 600  # s

_DRIVER = """
import json, sys, time
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimObserver import CosimObserver

log_output_level(CosimLogLevel.ERROR)
config, count, record = sys.argv[1], int(sys.argv[2]), json.loads(sys.argv[3])
execution = CosimExecution.from_osp_config_file(config)
observer = CosimObserver.create_last_value()
assert execution.add_observer(observer)
reads = []
for unit, names in record.items():
    index = execution.slave_index_from_instance_name(unit)
    references = {v.name.decode(): v.reference for v in execution.slave_variables(index)}
    reads.append((index, [references[name] for name in names]))
rows = []
begun = time.perf_counter()
for _ in range(count):
    if not execution.step():
        break
    rows.append([x for index, refs in reads for x in observer.last_real_values(index, refs)])
seconds = time.perf_counter() - begun
print("RUN " + json.dumps({"seconds": seconds, "rows": rows}))
"""

_STRUCTURE = """<?xml version="1.0" encoding="utf-8"?>
<OspSystemStructure xmlns="http://opensimulationplatform.com/MSMI/OSPSystemStructure" version="0.1">
<BaseStepSize>{step!r}</BaseStepSize>
<Algorithm>fixedStep</Algorithm>
<Simulators>{simulators}</Simulators>
<Functions>{functions}</Functions>
<Connections>{connections}</Connections>
</OspSystemStructure>
"""


class LibcosimRunner:
    """A scene in libcosim at the scene's steps.

    Raises:
        SimulationError: libcosim is not there, or cannot run this scene.
    """

    def __init__(self, scene: Scene, names: Sequence[str]) -> None:
        if find_spec("libcosimpy") is None:
            raise SimulationError("libcosimpy is not installed")
        if scene.profile().rises:
            raise SimulationError("libcosimpy: nobody tells the units there of a changing speed")
        self._cosim = CoSimulation(scene)
        self._step = round(step_size(scene) / NANOSECOND) * NANOSECOND
        self._count = round(end_time(scene) / self._step)
        self._record = by_unit(names)
        self._cosim.start()

    def _structure(self) -> str:
        """The system as libcosim reads it, with consistent start values."""
        held = start_inputs(self._cosim)
        simulators = "".join(
            _simulator(one.name, path.resolve(), {**one.start, **held.get(one.name, {})})
            for one, path in zip(self._cosim.plan.units, self._cosim.paths, strict=True)
        )
        functions, connections = [], []
        for target, sources in self._cosim.plan.inputs("signal", "value", "mass").items():
            if len(sources) == 1:
                connections.append(_wire(sources[0], target))
            else:
                functions.append(_sum(connections, sources, target))
        return _STRUCTURE.format(
            step=self._step,
            simulators=simulators,
            functions="".join(functions),
            connections="".join(connections),
        )

    def run(self) -> TimedRun:
        with TemporaryDirectory(prefix="autobalancer-") as directory:
            config = Path(directory) / "OspSystemStructure.xml"
            config.write_text(self._structure(), encoding="utf-8")
            arguments = [str(config), str(self._count), json.dumps(self._record)]
            done = subprocess.run(
                [sys.executable, "-c", _DRIVER, *arguments],
                capture_output=True,
                text=True,
                timeout=_TIMEOUT,
                check=False,
            )
        lines = [line for line in done.stdout.splitlines() if line.startswith("RUN ")]
        if not lines:
            said = (done.stderr.strip() or done.stdout.strip()).splitlines()
            reason = said[-1] if said else f"its process ended with code {done.returncode}"
            raise SimulationError(f"libcosimpy: {reason}")
        answer = json.loads(lines[-1].removeprefix("RUN "))
        rows = np.array(answer["rows"])
        if len(rows) < self._count or not np.isfinite(rows).all():
            raise SimulationError(f"libcosimpy: ended after {len(rows)} of {self._count} steps")
        names = [f"{unit}.{v}" for unit, variables in self._record.items() for v in variables]
        time = np.arange(1.0, self._count + 1.0, dtype=np.float64) * self._step
        signals = {name: rows[:, i].copy() for i, name in enumerate(names)}
        return TimedRun(answer["seconds"], time, signals, self._count)

    def close(self) -> None:
        self._cosim.close()


def _simulator(name: str, fmu: Path, values: Mapping[str, float | bool]) -> str:
    lines = []
    for variable, value in values.items():
        flag = isinstance(value, bool)
        tag = f'Boolean value="{str(value).lower()}"' if flag else f'Real value="{value!r}"'
        lines.append(f"<InitialValue variable={quoteattr(variable)}><{tag}/></InitialValue>")
    return (
        f"<Simulator name={quoteattr(name)} source={quoteattr(fmu.as_uri())}>"
        f"<InitialValues>{''.join(lines)}</InitialValues></Simulator>"
    )


def _sum(lines: list[str], sources: Sequence[Port], target: Port) -> str:
    """The function that adds outputs for an input; its connections go into `lines`."""
    total = f"sum of {target.unit}.{target.variable}"
    for k, source in enumerate(sources):
        lines.append(
            f"<SignalConnection>{_variable(source)}"
            f'<Signal function={quoteattr(total)} name="in[{k}]"/></SignalConnection>'
        )
    lines.append(
        f'<SignalConnection><Signal function={quoteattr(total)} name="out"/>'
        f"{_variable(target)}</SignalConnection>"
    )
    return f'<Sum name={quoteattr(total)} inputCount="{len(sources)}"/>'


def _wire(source: Port, target: Port) -> str:
    """An output connected to an input."""
    return f"<VariableConnection>{_variable(source)}{_variable(target)}</VariableConnection>"


def _variable(port: Port) -> str:
    return f"<Variable simulator={quoteattr(port.unit)} name={quoteattr(port.variable)}/>"
