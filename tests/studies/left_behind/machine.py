"""Machines for `integrate.c`, with matrices of their own, and the compiled integration."""

from __future__ import annotations

import ctypes
import subprocess
import tempfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

DOF, MOST, CORNERS = 12, 16, 16
STEPS = 60  # a turn of the fastest of rotor, natural frequencies
_D = ctypes.c_double


class _Machine(ctypes.Structure):
    _fields_ = (
        *((name, ctypes.c_int) for name in ("n", "weights", "corners", "windows")),
        *((name, _D * (DOF * DOF)) for name in ("mass", "d0", "d1", "k0", "k1")),
        ("ux", _D * DOF), ("uy", _D * DOF), ("planes", _D * (MOST * DOF)),
        *((name, _D * MOST) for name in ("m", "radius", "kappa", "drag")),
        ("times", _D * CORNERS), ("speeds", _D * CORNERS), ("step", _D), ("end", _D),
    )  # fmt: skip


@cache
def library() -> ctypes.CDLL:
    """`integrate.c`, compiled by the compiler of the project's own build requirement."""
    import ziglang

    source = Path(__file__).with_name("integrate.c")
    target = Path(tempfile.mkdtemp()) / "integrate.so"
    zig = Path(ziglang.__file__).parent / "zig"
    flags = ["-O3", "-march=native", "-shared", "-fPIC", "-lm"]
    subprocess.run([str(zig), "cc", *flags, str(source), "-o", str(target)], check=True)
    found = ctypes.CDLL(str(target))
    found.integrate.restype = ctypes.c_int
    return found


@dataclass
class Rotor:
    """(n, n) matrices and (w, n) shares of the weights' planes; see `integrate.c`."""

    mass: np.ndarray
    damping: tuple[np.ndarray, np.ndarray]
    stiffness: tuple[np.ndarray, np.ndarray]
    unbalance: np.ndarray
    planes: np.ndarray
    gyroscopic: np.ndarray | None = None
    internal: np.ndarray | None = None


def planar(mass, stiffness, damping, unbalance, internal=0.0) -> Rotor:
    kx, ky = np.broadcast_to(stiffness, 2)
    cx, cy = np.broadcast_to(damping, 2)
    cell = lambda v: np.array([[float(v)]])  # noqa: E731
    return Rotor(cell(mass), (cell(cx), cell(cy)), (cell(kx), cell(ky)),
                 np.array([complex(unbalance)]), cell(1.0), None, cell(internal))  # fmt: skip


def two_support(mass, inertia, polar, span, stiffness, damping, places, unbalances) -> Rotor:
    """Displacements at both supports; kinetic energy of the centre of mass in the middle."""
    middle, tilt = np.array([0.5, 0.5]), np.array([-1.0, 1.0]) / span
    at = lambda z: np.array([1.0 - z / span, z / span])  # noqa: E731
    m = mass * np.outer(middle, middle) + inertia * np.outer(tilt, tilt)
    k, c = np.array(stiffness, float), np.array(damping, float)
    u = sum(amount * np.exp(1j * angle) * at(z) for z, amount, angle in unbalances)
    damping, stiffness = (tuple(np.diag(v[:, a]) for a in (0, 1)) for v in (c, k))
    rows = np.array([at(z) for z in places])
    return Rotor(m, damping, stiffness, u, rows, polar * np.outer(tilt, tilt))


def flexible(places, masses, stiffness, damping, bending, unbalances) -> Rotor:
    """Discs on a uniform massless shaft whose first and last one stand on the supports.

    Elastic deflection of inner discs by the simply supported beam's influence numbers.
    """
    z = np.array(places, float) - places[0]
    length, inner = z[-1], z[1:-1]
    a, b = np.minimum.outer(inner, inner), np.maximum.outer(inner, inner)
    compliance = a * (length - b) * (length**2 - a**2 - (length - b) ** 2) / (6 * bending * length)
    line = np.stack([1.0 - inner / length, inner / length], axis=1)
    bent = np.zeros((len(inner), len(z)))
    bent[:, 1:-1] = np.eye(len(inner))
    bent[:, [0, -1]] -= line
    shaft = bent.T @ np.linalg.inv(compliance) @ bent
    ends = np.zeros((2, len(z)))
    ends[0, 0] = ends[1, -1] = 1.0
    k = [shaft + ends.T @ np.diag(np.array(stiffness, float)[:, a]) @ ends for a in (0, 1)]
    c = [ends.T @ np.diag(np.array(damping, float)[:, a]) @ ends for a in (0, 1)]
    u = np.zeros(len(z), complex)
    for station, amount, angle in unbalances:
        u[station] += amount * np.exp(1j * angle)
    return Rotor(np.diag(np.array(masses, float)), tuple(c), tuple(k), u, np.eye(len(z)))


@dataclass
class Weight:
    plane: int
    mass: float
    radius: float
    drag: float
    kappa: float = 1.4


def run(rotor: Rotor, weights: list[Weight], profile, angles, rates, end: float, windows: int,
        steps: int = STEPS) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
    """Windows (k, 2 + 3 N) as in `integrate.c`, and the state at the end.

    Args:
        profile: corners (time, speed).
        angles, rates: of the weights in fixed axes.
    """
    n, N = len(rotor.mass), len(weights)
    a = _Machine(n=n, weights=N, corners=len(profile), windows=windows)
    shares = np.array([rotor.planes[w.plane] for w in weights]).reshape(N, n)
    loaded = rotor.mass + sum(w.mass * np.outer(s, s) for w, s in zip(weights, shares, strict=True))
    zero = np.zeros((n, n))
    g = zero if rotor.gyroscopic is None else rotor.gyroscopic
    ci = zero if rotor.internal is None else rotor.internal
    (cx, cy), (kx, ky) = rotor.damping, rotor.stiffness
    blocks = {
        "mass": [[loaded, zero], [zero, loaded]],
        "d0": [[cx + ci, zero], [zero, cy + ci]],
        "d1": [[zero, g], [-g, zero]],
        "k0": [[kx, zero], [zero, ky]],
        "k1": [[zero, ci], [-ci, zero]],
    }
    for name, block in blocks.items():
        flat = np.block(block).reshape(-1)
        getattr(a, name)[: len(flat)] = flat.tolist()
    a.ux[:n], a.uy[:n] = rotor.unbalance.real.tolist(), rotor.unbalance.imag.tolist()
    a.planes[: N * n] = shares.reshape(-1).tolist()
    for name in ("mass", "radius", "kappa", "drag"):
        getattr(a, "m" if name == "mass" else name)[:N] = [getattr(w, name) for w in weights]
    a.times[: len(profile)] = [t for t, _ in profile]
    a.speeds[: len(profile)] = [s for _, s in profile]
    fastest = np.sqrt(np.linalg.eigvals(np.linalg.solve(loaded, np.maximum(kx, ky))).real.max())
    a.step = np.pi * 2 / steps / max(max(s for _, s in profile), float(fastest))
    a.end = end
    state = np.concatenate([np.zeros(4 * n), np.asarray(angles, float), np.asarray(rates, float)])
    found = np.zeros((windows, 2 + 3 * N))
    pointers = [x.ctypes.data_as(ctypes.POINTER(_D)) for x in (state, found)]
    failed = library().integrate(ctypes.byref(a), *pointers)
    if failed:
        raise ArithmeticError("the integration has diverged")
    return found, state
