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

from ..errors import SimulationError
from ..master.cosimulation import CoSimulation
from ..master.plan import AXES
from ..master.schedule import end_time, step_size
from ..scene import Scene
from .runner import Run

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


class InLibcosim:
    """A scene in libcosim at the scene's steps.

    Raises:
        SimulationError: libcosim is not there, or cannot run this scene.
    """

    def __init__(self, scene: Scene, names: Sequence[str]) -> None:
        if find_spec("libcosimpy") is None:
            raise SimulationError("libcosimpy is not installed")
        if scene.profile().start != scene.profile().end:
            raise SimulationError("libcosimpy: nobody tells the units there of a changing speed")
        self._cosim = CoSimulation(scene)
        self._step = round(step_size(scene) / NANOSECOND) * NANOSECOND
        self._count = round(end_time(scene) / self._step)
        self._record: dict[str, list[str]] = {}
        for name in names:
            unit, _, variable = name.partition(".")
            self._record.setdefault(unit, []).append(variable)
        self._cosim.start()

    def _structure(self) -> str:
        """The system as libcosim reads it, with consistent start values."""
        held = self._start_inputs()
        simulators = "".join(
            _simulator(unit.name, path.resolve(), {**unit.parameters, **held.get(unit.name, {})})
            for unit, path in zip(self._cosim.plans, self._cosim.paths, strict=True)
        )
        functions, connections = self._connections()
        return _STRUCTURE.format(
            step=self._step, simulators=simulators, functions=functions, connections=connections
        )

    def _start_inputs(self) -> dict[str, dict[str, float]]:
        system = self._cosim.system
        held: dict[str, dict[str, float]] = {"rotor": {}}
        for unit, plane in zip(system.balancers, system.planes, strict=True):
            mass = self._cosim.read(unit.name, ["added_mass"])[0]
            _add(held["rotor"], f"plane[{plane}].added_mass", mass)
        for connection in system.connections:
            plane, force = system.connected[connection.plane], connection.force.now[0]
            _add(held["rotor"], f"plane[{plane}].F_xi", force.real)
            _add(held["rotor"], f"plane[{plane}].F_eta", force.imag)
            motion = system.accelerations[connection.plane].now[0]
            held[connection.unit.name] = {"a_xi": motion.real, "a_eta": motion.imag}
        return held

    def _connections(self) -> tuple[str, str]:
        """A sum of forces and of masses for every plane, and what is connected to what."""
        system = self._cosim.system
        exchanging = {c.unit.name for c in system.connections}
        sums: list[str] = []
        lines: list[str] = []
        for plane in sorted(set(system.planes)):
            units = zip(system.balancers, system.planes, strict=True)
            here = [unit for unit, at in units if at == plane]
            names = [unit.name for unit in here]
            forced = [name for name in names if name in exchanging]
            for axis in AXES if forced else ():
                sums.append(_sum(lines, forced, f"F_{axis}", plane))
                lines += [_wire(plane, f"a_{axis}", name) for name in forced]
            sums.append(_sum(lines, names, "added_mass", plane))
            watched = [unit.name for unit in here if "clearance" in unit.variables]
            lines += [_wire(plane, axis, name) for name in watched for axis in "xy"]
        return "".join(sums), "".join(lines)

    def run(self) -> Run:
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
        return Run(answer["seconds"], time, signals, self._count)

    def close(self) -> None:
        self._cosim.close()


def _add(values: dict[str, float], name: str, value: float) -> None:
    values[name] = values.get(name, 0.0) + value


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


def _sum(lines: list[str], names: Sequence[str], output: str, plane: int) -> str:
    """The function that adds an output of several units for a plane; its connections in `lines`."""
    total = f"sum_{plane}_{output}"
    for k, name in enumerate(names):
        lines.append(
            f"<SignalConnection>{_variable(name, output)}"
            f'<Signal function="{total}" name="in[{k}]"/></SignalConnection>'
        )
    lines.append(
        f'<SignalConnection><Signal function="{total}" name="out"/>'
        f"{_variable('rotor', f'plane[{plane}].{output}')}</SignalConnection>"
    )
    return f'<Sum name="{total}" inputCount="{len(names)}"/>'


def _wire(plane: int, output: str, name: str) -> str:
    """What the rotor's plane shows, connected to the balancer's input of the same name."""
    source = _variable("rotor", f"plane[{plane}].{output}")
    return f"<VariableConnection>{source}{_variable(name, output)}</VariableConnection>"


def _variable(simulator: str, name: str) -> str:
    return f"<Variable simulator={quoteattr(simulator)} name={quoteattr(name)}/>"
