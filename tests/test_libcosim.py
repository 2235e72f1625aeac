"""The three FMUs in another tool: libcosim with held signals gives our held-signal Jacobi."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from pathlib import Path
from xml.sax.saxutils import quoteattr

import pytest

from autobalancer.harness import Scene
from autobalancer.harness.master import CoSimulation

pytest.importorskip("libcosimpy")

STEP = 1.0 / 64.0  # s: a whole number of nanoseconds, in which libcosim counts time
STEPS = 400
SIGNALS = [
    "rotor.x",
    "rotor.y",
    "rotor.plane[1].a_xi",
    "weights.weight[1].angle",
    "weights.weight[2].speed",
    "weights.F_xi",
    "liquid.F_eta",
]
SCENE = {
    "rotor": {"kind": "planar", "mass": 0.95, "stiffness": [1.0, 9.0], "damping": [0.5, 1.0],
              "unbalance": 0.025},
    "balancer": [
        {"name": "weights", "kind": "pendulums", "count": 2, "mass": 0.025, "track_radius": 1.0,
         "drag": 0.0125, "angles": [0.3, 1.0]},
        # r m2 = rho pi r1^2 h = 0.2 kg: loop gain 0.2, so that held signals are stable
        {"name": "liquid", "kind": "liquid", "chamber_radius": 1.0, "float_radius": 0.5,
         "height": 0.2 / math.pi, "density": 1.0, "inertia_as_force": True},
    ],
    "operation": {"speed": 2.0 * math.pi / (40.0 * STEP)},
    "coupling": {"scheme": "jacobi", "order": 0, "steps_per_rev": 40},
    "run": {"revolutions": STEPS / 40},
}  # fmt: skip

# libcosim runs in a process of its own: it brings its own loader of FMUs, and must end cleanly too
DRIVER = """
import json, sys
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver

config, count, names = sys.argv[1], int(sys.argv[2]), json.loads(sys.argv[3])
execution = CosimExecution.from_osp_config_file(config)
observer = CosimObserver.create_last_value()
assert execution.add_observer(observer)
reads = []
for name in names:
    slave, _, variable = name.partition(".")
    index = execution.slave_index_from_instance_name(slave)
    references = {v.name.decode(): v.reference for v in execution.slave_variables(index)}
    reads.append((index, references[variable]))
rows = []
for _ in range(count):
    assert execution.step(), execution.status()
    rows.append([observer.last_real_values(i, [reference])[0] for i, reference in reads])
print("ROWS", json.dumps(rows))
"""

STRUCTURE = """<?xml version="1.0" encoding="utf-8"?>
<OspSystemStructure xmlns="http://opensimulationplatform.com/MSMI/OSPSystemStructure" version="0.1">
<BaseStepSize>{step!r}</BaseStepSize>
<Algorithm>fixedStep</Algorithm>
<Simulators>{simulators}</Simulators>
<Functions><Sum name="sum_xi" inputCount="2"/><Sum name="sum_eta" inputCount="2"/></Functions>
<Connections>{connections}</Connections>
</OspSystemStructure>
"""


def _simulator(name: str, fmu: Path, values: dict[str, float | bool]) -> str:
    lines = []
    for variable, value in values.items():
        flag = isinstance(value, bool)
        tag = f'Boolean value="{str(value).lower()}"' if flag else f'Real value="{value!r}"'
        lines.append(f"<InitialValue variable={quoteattr(variable)}><{tag}/></InitialValue>")
    return (
        f"<Simulator name={quoteattr(name)} source={quoteattr(fmu.as_uri())}>"
        f"<InitialValues>{''.join(lines)}</InitialValues></Simulator>"
    )


def _variable(simulator: str, name: str) -> str:
    return f'<Variable simulator="{simulator}" name="{name}"/>'


def _connections() -> str:
    lines = []
    for axis in ("xi", "eta"):
        for number, balancer in enumerate(("weights", "liquid")):
            # the rotor's plane takes one force: the sum of both balancers
            lines.append(
                f"<SignalConnection>{_variable(balancer, f'F_{axis}')}"
                f'<Signal function="sum_{axis}" name="in[{number}]"/></SignalConnection>'
            )
            lines.append(
                f"<VariableConnection>{_variable('rotor', f'plane[1].a_{axis}')}"
                f"{_variable(balancer, f'a_{axis}')}</VariableConnection>"
            )
        lines.append(
            f'<SignalConnection><Signal function="sum_{axis}" name="out"/>'
            f"{_variable('rotor', f'plane[1].F_{axis}')}</SignalConnection>"
        )
    lines.append(
        f"<VariableConnection>{_variable('weights', 'added_mass')}"
        f"{_variable('rotor', 'plane[1].added_mass')}</VariableConnection>"
    )
    return "".join(lines)


def _start_inputs(cosim: CoSimulation) -> dict[str, dict[str, float]]:
    """The consistent start of the master, as start values of libcosim's inputs."""
    force = sum(c.force.now[0] for c in cosim.system.connections)
    motion = cosim.system.accelerations[0].now[0]
    held = {"a_xi": motion.real, "a_eta": motion.imag}
    mass = cosim.read("weights", ["added_mass"])[0]
    rotor = {"plane[1].F_xi": force.real, "plane[1].F_eta": force.imag}
    return {"rotor": {**rotor, "plane[1].added_mass": mass}, "weights": held, "liquid": held}


def test_libcosim_couples_the_three_units_to_the_same_digits_as_held_jacobi(tmp_path):
    scene = Scene.from_document(SCENE)
    ours = []
    with CoSimulation(scene) as cosim:
        cosim.start()
        assert 0.1 < cosim.gain < 0.5
        inputs = _start_inputs(cosim)
        simulators = "".join(
            _simulator(unit.name, path.resolve(), {**unit.parameters, **inputs[unit.name]})
            for unit, path in zip(cosim.plans, cosim.paths, strict=True)
        )
        config = tmp_path / "OspSystemStructure.xml"
        structure = STRUCTURE.format(step=STEP, simulators=simulators, connections=_connections())
        config.write_text(structure, encoding="utf-8")
        theirs = _libcosim(config)
        for _ in cosim.run():
            row = [cosim.read(*_split(name))[0] for name in SIGNALS]
            ours.append(row)
    assert len(ours) == len(theirs) == STEPS
    for k, name in enumerate(SIGNALS):
        mine, other = [row[k] for row in ours], [row[k] for row in theirs]
        size = max(map(abs, mine))
        assert size > 1e-3, name
        gap = max(abs(a - b) for a, b in zip(mine, other, strict=True))
        assert gap <= 1e-9 * size, (name, gap / size)


def _split(name: str) -> tuple[str, list[str]]:
    unit, _, variable = name.partition(".")
    return unit, [variable]


def _libcosim(config: Path) -> list[list[float]]:
    done = subprocess.run(
        [sys.executable, "-c", DRIVER, str(config), str(STEPS), json.dumps(SIGNALS)],
        capture_output=True,
        text=True,
        timeout=120,
        cwd=config.parent,
        check=False,
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-4000:]
    (line,) = [line for line in done.stdout.splitlines() if line.startswith("ROWS ")]
    return json.loads(line.removeprefix("ROWS "))
