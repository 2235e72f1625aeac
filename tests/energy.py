"""The energy of a planar scene's run: what it has, and what is fed in and lost on the way."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_simpson
from scipy.interpolate import CubicSpline

from autobalancer.harness import Scene
from autobalancer.harness.result.result import Result
from autobalancer.harness.scene.balancer import WeightBalancer

Array = NDArray[np.float64]


def signals(scene: Scene) -> list[str]:
    """What `balance` needs recorded."""
    own = [f"rotor.{name}" for name in ("x", "y", "vx", "vy", "angle")]
    return own + [
        f"{b.label}.weight[{k}].{what}"
        for b in scene.balancer
        for k in range(1, b.count + 1)
        for what in ("angle", "speed")
    ]


def balance(scene: Scene, run: Result) -> tuple[Array, Array]:
    """Energy, and the work done from the start on by drive and dissipation, (T,) each [J].

    Of a rotor with weights that do not stick, stepped evenly.  A body that rolls turns absolutely
    at w - (R/r) theta'; the rotor's own turning and what drives that alone are not counted.
    """
    rotor, gravity, t = scene.assembly().rotor, scene.operation.field, run.time
    z = run["rotor.x"] + 1j * run["rotor.y"]
    v = run["rotor.vx"] + 1j * run["rotor.vy"]
    profile = scene.profile()
    w = np.array([profile.speed(s) for s in t])
    spin_up = np.array([profile.acceleration(s) for s in t])

    def height(place: NDArray[np.complex128]) -> Array:
        return -(place * gravity.conjugate()).real

    mass, unbalance = float(rotor.mass[0, 0]), complex(rotor.unbalance[0])
    stiffness = np.array([rotor.stiffness_x[0, 0], rotor.stiffness_y[0, 0]])
    damping = np.array([rotor.damping_x[0, 0], rotor.damping_y[0, 0]])
    energy = 0.5 * mass * np.abs(v) ** 2 + mass * height(z)
    energy += 0.5 * (stiffness[0] * z.real**2 + stiffness[1] * z.imag**2)
    pull = unbalance * (w**2 - 1j * spin_up) * np.exp(1j * run["rotor.angle"])
    power = (v.conjugate() * pull).real - damping[0] * v.real**2 - damping[1] * v.imag**2
    for b in scene.balancer:
        assert isinstance(b, WeightBalancer)
        R, r, m = b.track_radius, b.weight_radius or 0.0, b.mass
        for k in range(1, b.count + 1):
            theta, rate = (run[f"{b.label}.weight[{k}].{what}"] for what in ("angle", "speed"))
            arm = R * np.exp(1j * (theta + run["rotor.angle"]))
            energy += 0.5 * m * np.abs(v + 1j * (w + rate) * arm) ** 2 + m * height(z + arm)
            rim = r * w - R * rate  # speed of the surface that rolls
            energy += 0.5 * (b.kappa - 1.0) * m * rim**2
            gained = r * spin_up - R * CubicSpline(t, rate).derivative()(t)
            torque = b.drag * R**2 * rate - (b.kappa - 1.0) * m * (R + r) * gained
            power += -b.drag * (R * rate) ** 2 - torque * w
    return energy, cumulative_simpson(power, x=t, initial=0.0)
