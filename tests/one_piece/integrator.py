"""The two-ball scene in one piece in C: compiled, run, and compared with the reference."""

from __future__ import annotations

import ctypes
import subprocess
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate._ivp import dop853_coefficients as dop853

from autobalancer.harness import Scene
from autobalancer.harness.accuracy.precision.reference import right_motion, signal_ranges
from autobalancer.harness.master.recorder import recorded
from autobalancer.harness.master.schedule import end_time, step_size
from autobalancer.models.reference.trajectory import Trajectory

SOURCE = Path(__file__).with_name("one_piece.c")
_SIZE, _REPEATS = 8, 20


class OnePiece:
    """A planar scene with two weights at constant speed; its program is compiled in a folder."""

    def __init__(self, scene: Scene, folder: Path) -> None:
        self._scene, self._names = scene, recorded(scene)
        (folder / "coefficients.h").write_text(_coefficients())
        library = folder / "one_piece.so"
        command = ["cc", "-O2", "-march=native", "-shared", "-fPIC", f"-I{folder}", str(SOURCE)]
        subprocess.run([*command, "-o", str(library), "-lm"], check=True)
        self._run = ctypes.CDLL(str(library)).one_piece
        self._run.restype = ctypes.c_double
        rotor, [balls] = scene.rotor, scene.balancer
        of_rotor = (rotor.mass, *rotor.stiffness, *rotor.damping, rotor.unbalance)
        of_weights = (balls.mass, balls.track_radius, balls.kappa, balls.drag)
        self._machine = np.array([*of_rotor, *of_weights, scene.profile().speed(0.0)])
        self._start = np.array([0.0, 0.0, *balls.angles, 0.0, 0.0, *[self._machine[-1]] * 2])

    def seconds(self, steps: int) -> float:
        """Processor time of a run at so many steps a revolution."""
        return min(self._states(steps)[0] for _ in range(_REPEATS))

    def error(self, steps: int) -> float:
        """Largest over time and signals, relative to each signal's range."""
        _, time, states = self._states(steps)
        right, _ = right_motion(self._scene, self._names, [time])
        ranges = signal_ranges(self._scene, right, self._names)
        found = self._signals(time, states)
        return max(_gap(found[name], right, name) / ranges[name] for name in self._names)

    def _states(self, steps: int) -> tuple[float, NDArray, NDArray]:
        count = round(end_time(self._scene) / step_size(self._scene, steps))
        step = end_time(self._scene) / count
        rows = np.empty((count + 1, _SIZE))
        pointers = [ctypes.c_void_p(a.ctypes.data) for a in (self._machine, self._start, rows)]
        taken = self._run(*pointers[:2], ctypes.c_long(count), ctypes.c_double(step), pointers[2])
        return taken, step * np.arange(count + 1), rows

    def _signals(self, time: NDArray, states: NDArray) -> dict[str, NDArray]:
        angles = states[:, 2:4] - (self._machine[-1] * time)[:, None]
        moment = self._machine[6] * self._machine[7] * np.exp(1j * angles).sum(axis=1)
        return {
            "rotor.x": states[:, 0],
            "rotor.y": states[:, 1],
            "weights.moment_xi": moment.real,
            "weights.moment_eta": moment.imag,
            "weights.weight[1].angle": angles[:, 0],
            "weights.weight[2].angle": angles[:, 1],
        }


def _gap(found: NDArray, right: Trajectory, name: str) -> float:
    return float(np.abs(found - right.signal(name)).max())


def _coefficients() -> str:
    """Of the formula's stages; its error estimate and its dense output are not used."""
    stages = dop853.N_STAGES
    rows = ",\n".join(_braced(row) for row in dop853.A[:stages, :stages])
    square = f"static const double A[STAGES][STAGES] = {{{rows}}};"
    b, c = _braced(dop853.B), _braced(dop853.C[:stages])
    vectors = f"static const double B[STAGES] = {b}, C[STAGES] = {c};"
    return f"enum {{ STAGES = {stages} }};\n{square}\n{vectors}\n"


def _braced(values: NDArray) -> str:
    return "{" + ", ".join(repr(float(value)) for value in values) + "}"
