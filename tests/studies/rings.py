"""Random machines with rings of liquid, run in one piece and integrated by equations written anew.

    python -m tests.studies.rings COUNT [SEED]

Planar rotors with unlike supports, internal damping, gravity, constant speeds and run-ups, one or
two rings with damping of both kinds, some with balls.  Prints the largest error of machines over
the range of their signals, and in the end how many exceed their tolerance or what they state.
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np

import autobalancer as ab
from autobalancer.harness import cosimulate
from tests.studies.planar import draw_drive, draw_rotor, draw_supports, solve_between_corners

KAPPA = 1.4
REVOLUTIONS = 12
TOLERANCE = 1e-6  # of the runs


def machine(rng: np.random.Generator) -> ab.Scene:
    """A random machine whose waves stay finite over the run."""
    mass, natural, stiffness, damping = draw_supports(rng)
    rings = []
    for k in range(rng.integers(1, 3)):
        wall = rng.uniform(0.08, 0.3)
        film = {"viscosity": 10.0 ** rng.uniform(-6.0, -3.5)}
        waves = {"wave_damping": rng.uniform(0.0, 3.0), "viscosity": 0.0}
        inner = wall * rng.uniform(0.3, 0.97)
        share = rng.uniform(0.02, 0.4) * mass
        height = share / (1000.0 * np.pi * (wall**2 - inner**2))
        rings.append({"kind": "ring", "name": f"ring{k + 1}", "wall_radius": wall,
                      "inner_radius": inner, "height": height, "density": 1000.0,
                      **(film if rng.random() < 0.5 else waves)})  # fmt: skip
    balls = []
    if rng.random() < 0.4:
        balls = [{"kind": "balls", "count": int(rng.integers(1, 4)), "mass": 0.01 * mass,
                  "track_radius": 0.2, "drag": rng.uniform(0.1, 3.0)}]  # fmt: skip
    operation, run = draw_drive(rng, natural, REVOLUTIONS)
    if rng.random() < 0.2 and "run_up" not in operation:
        operation["gravity"] = 9.81
    return ab.Scene(
        rotor=draw_rotor(rng, mass, stiffness, damping),
        balancer=[*rings, *balls], operation=operation,
        run={**run, "record": ["rotor.x", "rotor.y", *(
            f"{r['name']}.{s}" for r in rings for s in ("wave_xi", "wave_eta", "F_xi"))]},
        coupling={"tolerance": TOLERANCE},
    )  # fmt: skip


def integrated(scene: ab.Scene, times: np.ndarray) -> dict[str, np.ndarray]:
    """x, y and the waves, seen in the turning rotor, by equations in fixed axes."""
    rotor, profile = scene.rotor, scene.profile()
    rings = [b.device for b in scene.balancer if b.kind == "ring"]
    balls = [b for b in scene.balancer if b.kind == "balls"]
    (ball,) = balls or (None,)
    r, n = len(rings), ball.count if ball else 0
    f = np.array([(ring.inner_radius / ring.wall_radius) ** 2 for ring in rings])
    liquid = np.array([ring.density * np.pi * ring.height for ring in rings])
    liquid *= [ring.wall_radius**2 - ring.inner_radius**2 for ring in rings]
    film = np.array([_film(ring, share) for ring, share in zip(rings, f, strict=True)])
    plain = np.array([ring.wave_damping for ring in rings])
    (kx, ky), (cx, cy), p = rotor.stiffness, rotor.damping, rotor.internal_damping
    u = rotor.unbalance * np.exp(1j * rotor.unbalance_angle)
    g = complex(scene.operation.field)
    m, radius, drag = (ball.mass, ball.track_radius, ball.drag) if ball else (0.0, 1.0, 0.0)

    def rhs(t: float, s: np.ndarray) -> np.ndarray:
        z, v, y, rate = s[0] + 1j * s[1], s[2] + 1j * s[3], s[4 : 4 + r], s[4 + 2 * r : 4 + 3 * r]
        y = y + 1j * s[4 + r : 4 + 2 * r]
        rate = rate + 1j * s[4 + 3 * r : 4 + 4 * r]
        phi, turning = s[4 + 4 * r : 4 + 4 * r + n], s[4 + 4 * r + n :]
        w, w1, angle = profile.speed(t), profile.acceleration(t), profile.angle(t)
        d = plain + film * np.sqrt(w)
        # unknown: A = z'' - g, y'' of each ring, phi'' of each ball, real parts first
        size = 2 + 2 * r + n
        matrix, right = np.zeros((size, size)), np.zeros(size)
        push = u * (w * w - 1j * w1) * np.exp(1j * angle) - p * (v - 1j * w * z)
        push -= kx * z.real + cx * v.real + 1j * (ky * z.imag + cy * v.imag)
        matrix[0, 0] = matrix[1, 1] = rotor.mass + liquid.sum() + n * m
        for k in range(r):
            wave = 4j * w * rate[k] + 2.0 * w * w * y[k] - d[k] * (rate[k] - 1j * w * y[k])
            for axis, part in ((0, wave.real), (1, wave.imag)):
                at = 2 + 2 * k + axis
                matrix[axis, at] = liquid[k] * f[k]
                matrix[at, axis], matrix[at, at], right[at] = 1.0, 1.0 + f[k], part
        for k in range(n):
            at, e = 2 + 2 * r + k, np.exp(1j * phi[k])
            matrix[0, at], matrix[1, at] = -m * radius * e.imag, m * radius * e.real
            push += m * radius * turning[k] ** 2 * e
            matrix[at, 0], matrix[at, 1] = -m * radius * e.imag, m * radius * e.real
            matrix[at, at] = KAPPA * m * radius**2
            right[at] = -drag * radius**2 * (turning[k] - w) + (KAPPA - 1.0) * m * radius**2 * w1
        right[0], right[1] = push.real, push.imag
        found = np.linalg.solve(matrix, right)
        waves = found[2 : 2 + 2 * r]
        return np.concatenate(
            [s[2:4], found[:2] + np.array([g.real, g.imag]), rate.real, rate.imag, waves[::2],
             waves[1::2], turning, found[2 + 2 * r :]]
        )  # fmt: skip

    start = np.zeros(4 + 4 * r + 2 * n)
    if g:  # at rest in the sag, and waves at rest under gravity
        w = profile.start
        k = np.array([[kx, p * w], [-p * w, ky]])
        total = rotor.mass + liquid.sum() + n * m
        start[:2] = np.linalg.solve(k, total * np.array([g.real, g.imag]))
        rest = -g / (2.0 * w * w + 1j * w * (plain + film * np.sqrt(w)))
        start[4 : 4 + r], start[4 + r : 4 + 2 * r] = rest.real, rest.imag
    start[4 + 4 * r : 4 + 4 * r + n] = ball.angles if ball else ()
    start[4 + 4 * r + n :] = profile.start
    solved = solve_between_corners(rhs, start, times, profile.times, 1e-10, 1e-13)
    back = np.exp(-1j * np.array([profile.angle(t) for t in times]))
    found = {"rotor.x": solved[0], "rotor.y": solved[1]}
    for k in range(r):
        wave = (solved[4 + k] + 1j * solved[4 + r + k]) * back
        found |= {f"ring{k + 1}.wave_xi": wave.real, f"ring{k + 1}.wave_eta": wave.imag}
    return found


def _film(ring: Any, f: float) -> float:
    """d over the root of the speed: the wall layer at the slow free wave."""
    slow = (2.0 - np.sqrt(2.0 * (1.0 - f))) / (1.0 + f)
    behind = 1.0 - slow
    return (
        np.sqrt(2.0) * f * slow**2 / (ring.wall_radius * behind) * np.sqrt(ring.viscosity / behind)
    )


def errors(scene: ab.Scene) -> tuple[float, float]:
    """Largest error of displacements and waves over the largest of each, and the stated one."""
    result = cosimulate(scene)
    truth = integrated(scene, np.asarray(result.time))
    worst = 0.0
    for pair in {name[:-1] if name[-2] == "." else name.rpartition("_")[0] for name in truth}:
        names = [name for name in truth if name.startswith(pair)]
        reach = max(float(np.abs(truth[name]).max()) for name in names)
        worst = max(worst, *(float(np.abs(result[n] - truth[n]).max()) / reach for n in names))
    return worst, float(result.estimated_error or 0.0)


def main(count: str = "200", seed: str = "1") -> None:
    """Run machines; count errors above the tolerance, or above three times what is stated."""
    rng, found = np.random.default_rng(int(seed)), []
    for k in range(int(count)):
        scene = machine(rng)
        worst, stated = errors(scene)
        found.append((worst, stated))
        if worst > TOLERANCE or worst > 3.0 * stated or k % 20 == 0:
            print(f"{k}: error {worst:.1e}, stated {stated:.1e}", flush=True)
    true, said = np.array(found).T
    print(f"{count} machines: largest error {true.max():.1e}, median {np.median(true):.1e}; "
          f"above the tolerance {int((true > TOLERANCE).sum())}, "
          f"above three times what is stated {int((true > 3.0 * said).sum())}")  # fmt: skip


if __name__ == "__main__":
    main(*sys.argv[1:])
