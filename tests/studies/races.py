"""Random machines on races with lobes, run in one piece and integrated by equations written anew.

    python -m tests.studies.races COUNT [SEED]

Planar rotors with unlike supports, internal damping and gravity at constant speeds and in run-ups;
one or two balancers, each with one to three orders of lobes, some with an offset or with weights
that differ.  The equations are those of the turning frame, solved by SciPy; the machine's own are
in fixed axes, as series.  Prints the largest error of machines over the range of their signals,
and in the end how many exceed three times the error that the run states; a silent miss exceeds the
tolerance while the run states less.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from typing import Any

import numpy as np

import autobalancer as ab
from autobalancer.harness import cosimulate
from autobalancer.models.weights import KAPPA
from tests.studies.planar import draw_drive, draw_rotor, draw_supports, solve_between_corners

REVOLUTIONS = 15
RTOL = 3e-14  # weights that gravity drags round are so sensitive: 1e-10 grows to 1e-2
SIZES = {"balls": 0.4, "rollers": 0.5, "pendulums": 0.0}  # inertia of a body that rolls over m r^2


@dataclass(frozen=True)
class Drawn:
    """A balancer as the equations here need it; arrays are (N,) of its weights."""

    mass: np.ndarray
    drag: np.ndarray
    radius: float
    roll: float
    offset: complex
    lobes: np.ndarray  # (L, 3) order, amplitude, angle

    def path(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """rho and two derivatives."""
        n, size, at = (column[:, None] for column in self.lobes.T)
        turned = n * (theta - at)
        rho = self.radius + (size * np.cos(turned)).sum(axis=0)
        return (
            rho,
            -(n * size * np.sin(turned)).sum(axis=0),
            -(n * n * size * np.cos(turned)).sum(axis=0),
        )


def machine(rng: np.random.Generator) -> ab.Scene:
    """A random machine; weights are points on their race."""
    mass, natural, stiffness, damping = draw_supports(rng)
    balancers = []
    for k in range(rng.integers(1, 3)):
        count, radius = int(rng.integers(1, 5)), rng.uniform(0.05, 0.3)
        left = radius * 10.0 ** rng.uniform(-5.0, -1.0)
        lobes = [
            {"lobes": int(n), "amplitude": left / max(n * n - 1, 1) * rng.uniform(0.1, 1.0) / 3.0,
             "angle": rng.uniform(0.0, 6.0)}
            for n in rng.choice(np.arange(1, 13), int(rng.integers(1, 4)), replace=False)
        ]  # fmt: skip
        one = mass * rng.uniform(0.001, 0.02)
        drag = one * natural * rng.choice([0.0, 10.0 ** rng.uniform(-3.0, 0.5)])
        table: dict[str, Any] = {
            "kind": str(rng.choice(list(SIZES))), "name": f"balls{k + 1}", "count": count,
            "mass": one, "track_radius": radius, "drag": drag, "race": lobes,
            "angles": rng.uniform(0.0, 6.0, count).tolist(),
            "speeds": (rng.normal(0.0, 0.3, count) * natural).tolist(),
        }  # fmt: skip
        if rng.random() < 0.3 and count > 1:
            table["mass"] = (one * rng.uniform(0.5, 1.5, count)).tolist()
        if rng.random() < 0.3:
            table |= {"track_offset_xi": rng.normal(0.0, 1e-3),
                      "track_offset_eta": rng.normal(0.0, 1e-3)}  # fmt: skip
        balancers.append(table)
    operation, run = draw_drive(rng, natural, REVOLUTIONS)
    if rng.random() < 0.2:
        operation["gravity"] = 9.81
    names = [f"{b['name']}.weight[{k + 1}].angle" for b in balancers for k in range(b["count"])]
    return ab.Scene(
        rotor=draw_rotor(rng, mass, stiffness, damping),
        balancer=balancers, operation=operation,
        run={**run, "record": ["rotor.x", "rotor.y", *names]},
    )  # fmt: skip


def drawn(scene: ab.Scene) -> list[Drawn]:
    """The balancers of a scene."""
    found = []
    for b in scene.balancer:
        each = np.array(getattr(b.mass, "each", None) or [float(b.mass)] * b.count)
        lobes = np.array([[o.lobes, o.amplitude, o.angle] for o in b.race], float).reshape(-1, 3)
        drag = np.full(b.count, float(b.drag))
        found.append(Drawn(each, drag, b.track_radius, SIZES[b.kind], b.offset, lobes))
        assert KAPPA[b.kind] == 1.0 + SIZES[b.kind]
    return found


def integrated(scene: ab.Scene, times: np.ndarray) -> dict[str, np.ndarray]:
    """x, y and the weights' angles by equations in axes that turn with the rotor."""
    rotor, profile, balancers = scene.rotor, scene.profile(), drawn(scene)
    (kx, ky), (cx, cy), inner = rotor.stiffness, rotor.damping, rotor.internal_damping
    u = rotor.unbalance * np.exp(1j * rotor.unbalance_angle)
    g, count = complex(scene.operation.field), sum(len(b.mass) for b in balancers)

    def rhs(t: float, s: np.ndarray) -> np.ndarray:
        zeta, rate, theta, turning = (
            s[0] + 1j * s[1],
            s[2] + 1j * s[3],
            s[4 : 4 + count],
            s[4 + count :],
        )
        w, w1, e = profile.speed(t), profile.acceleration(t), np.exp(1j * profile.angle(t))
        # displacement and velocity in fixed axes pull supports; the mass feels the turning frame
        z, v = zeta * e, (rate + 1j * w * zeta) * e
        pull = -(kx * z.real + cx * v.real) - 1j * (ky * z.imag + cy * v.imag)
        frame = 2j * w * rate + (1j * w1 - w * w) * zeta - g / e
        push = pull / e - inner * rate - rotor.mass * frame - u * (1j * w1 - w * w)
        size = 2 + count
        matrix, right = np.zeros((size, size)), np.zeros(size)
        matrix[0, 0] = matrix[1, 1] = rotor.mass + sum(b.mass.sum() for b in balancers)
        at = 2
        for b in balancers:
            mine = slice(at - 2, at - 2 + len(b.mass))
            th, dth, turn = theta[mine], turning[mine], np.exp(1j * theta[mine])
            rho, slope, bend = b.path(th)
            q, curved = (slope + 1j * rho) * turn, (bend + 2j * slope - rho) * turn
            place = b.offset + rho * turn
            rest = curved * dth**2 + 2j * w * q * dth + (1j * w1 - w * w) * place + frame
            length = np.abs(q)
            stretched = (slope * bend + slope * rho) / length
            rolling = b.roll * b.mass * length
            for k in range(len(b.mass)):
                row = at + k
                matrix[0, row] = matrix[row, 0] = b.mass[k] * q[k].real
                matrix[1, row] = matrix[row, 1] = b.mass[k] * q[k].imag
                matrix[row, row] = (1.0 + b.roll) * b.mass[k] * length[k] ** 2
                right[row] = -b.mass[k] * (rest[k] * np.conj(q[k])).real
                right[row] -= rolling[k] * stretched[k] * dth[k] ** 2
                right[row] -= b.drag[k] * length[k] ** 2 * dth[k]
            push -= complex((b.mass * rest).sum())
            at += len(b.mass)
        right[0], right[1] = push.real, push.imag
        found = np.linalg.solve(matrix, right)
        return np.concatenate([s[2:4], found[:2], turning, found[2:]])

    start = np.zeros(4 + 2 * count)
    w = profile.speed(0.0)
    if g:
        total = rotor.mass + sum(b.mass.sum() for b in balancers)
        held = np.array([[kx, inner * w], [-inner * w, ky]])
        start[:2] = np.linalg.solve(held, total * np.array([g.real, g.imag]))
    start[2:4] = w * start[1], -w * start[0]
    start[4 : 4 + count] = [a for b in scene.balancer for a in b.angles]
    start[4 + count :] = [a for b in scene.balancer for a in b.speeds]
    solved = solve_between_corners(rhs, start, times, profile.times, RTOL, 1e-16)
    z = (solved[0] + 1j * solved[1]) * np.exp(1j * np.array([profile.angle(t) for t in times]))
    names = [n for n in scene.run.record if n.endswith("angle")]
    return {"rotor.x": z.real, "rotor.y": z.imag, **dict(zip(names, solved[4:], strict=False))}


def errors(scene: ab.Scene) -> tuple[float, float]:
    """Largest error of a signal over its range, displacements over the larger one, and the stated
    one."""
    result = cosimulate(scene)
    truth = integrated(scene, np.asarray(result.time))
    reach = {name: float(np.ptp(values)) for name, values in truth.items()}
    reach["rotor.x"] = reach["rotor.y"] = max(reach["rotor.x"], reach["rotor.y"])
    angles = [v for n, v in reach.items() if n.endswith("angle")]
    worst = max(
        float(np.abs(result[name] - values).max())
        / (reach[name] if name.startswith("rotor") else max(reach[name], 1e-2 * max(angles)))
        for name, values in truth.items()
    )
    return worst, float("nan" if result.estimated_error is None else result.estimated_error)


def main(count: str = "100", seed: str = "1") -> None:
    """Run machines; count errors above three times what is stated, and silent misses."""
    rng, found = np.random.default_rng(int(seed)), []
    for k in range(int(count)):
        scene = machine(rng)
        worst, stated = errors(scene)
        found.append((worst, stated, scene.coupling.tolerance))
        if not worst <= 3.0 * stated or k % 20 == 0:
            print(f"{k}: error {worst:.1e}, stated {stated:.1e}", flush=True)
    true, said, asked = np.array(found, float).T
    known = np.isfinite(said)
    silent = int(((true > asked) & (said <= asked) & (true > 3.0 * said)).sum())
    print(f"{count} machines: largest error {true.max():.1e}, median {np.median(true):.1e}; error "
          f"stated {int(known.sum())}, within three times {int((true <= 3.0 * said).sum())}; "
          f"silent misses {silent}")  # fmt: skip


if __name__ == "__main__":
    main(*sys.argv[1:])
