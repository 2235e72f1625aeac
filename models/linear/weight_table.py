"""Every single weight of an assembly in one table, and what weights at given angles do."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..assembly import Assembly
from ..weights import Weights


@dataclass(frozen=True, eq=False)
class WeightTable:
    """Every single weight of an assembly, K of them, one row each.

    Attributes:
        angle: in the rotor [rad].
        plane: index of its plane.
        moment: m R [kg m].
        kappa_radius: kappa R [m].
        damping_rate: d = b/(kappa m) [1/s].
        tracks: rows of the weights of each balancer, and radius over track radius of each; 0 where
            weights pass.
    """

    angle: NDArray[np.float64]
    plane: NDArray[np.int_]
    moment: NDArray[np.float64]
    kappa_radius: NDArray[np.float64]
    damping_rate: NDArray[np.float64]
    tracks: tuple[tuple[NDArray[np.int_], NDArray[np.float64]], ...]

    @classmethod
    def of(cls, assembly: Assembly) -> WeightTable:
        """All weights in the order of the balancers, at their starting angles."""
        rows: list[tuple[float, ...]] = []
        tracks = []
        for mounted in assembly.weights:
            device = mounted.device
            assert isinstance(device, Weights)
            if len(mounted.angles) != device.count:
                raise ValueError(
                    f"{mounted.name}: {len(mounted.angles)} angles for {device.count} weights"
                )
            kappa_radius = device.kappa * device.track_radius
            sines = np.full(device.count, math.sin(mounted.half_angle))
            if device.radii:
                sines = np.array(device.radii) / device.track_radius
            tracks.append((len(rows) + np.arange(device.count), sines))
            rows += [
                (angle, mounted.plane, one.moment, kappa_radius, one.damping_rate)
                for angle, one in zip(mounted.angles, device.each, strict=True)
            ]
        angle, plane, *others = np.array(rows, float).reshape(-1, 5).T.copy()
        moment, kappa_radius, damping_rate = others
        return cls(angle, plane.astype(int), moment, kappa_radius, damping_rate, tuple(tracks))


def residual_unbalance(
    assembly: Assembly, table: WeightTable, angles: NDArray[np.float64]
) -> NDArray[np.complex128]:
    """What the weights at `angles` (K,) [rad] leave of the unbalance, S^T moments + u (n,)."""
    pulls = assembly.rotor.planes[table.plane] * table.moment[:, None]
    return assembly.rotor.unbalance + np.exp(1j * angles) @ pulls


def moment_slopes(
    assembly: Assembly, table: WeightTable, angles: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Change of the stations' moments (2n, K) by the weights' `angles` (K,), real parts first."""
    pulls = assembly.rotor.planes[table.plane] * table.moment[:, None]
    slope = 1j * np.exp(1j * angles)[:, None] * pulls
    return np.concatenate([slope.real, slope.imag], axis=1).T
