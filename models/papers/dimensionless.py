"""The dimensionless parameters (6)-(8) of Filimonikhina 2017 and the way to them and back.

Scales: time 1/w_x, length L = N m R / M_S, with M_S the mass of rotor and weights.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from ..assembly import Assembly, Mounted
from ..rotor import LinearRotor
from ..weights import Weights
from .tables import ANGLES, STIFFNESS_RATIO, UNBALANCE, TableRow


@dataclass(frozen=True)
class Dimensionless:
    """A planar rotor with one balancer of N equal weights.

    Attributes:
        eps: N m / (kappa M_S).
        mu_xi, mu_eta: damping of the supports, c / (2 M_S w_x).
        mu_w: drag of a weight, b / (kappa m w_x).
        n_eta: w_y / w_x.
        unbalance: over the capacity N m R.
        count: number N of weights.
        kappa: 7/5 ball, 3/2 roller, 1 pendulum.
    """

    eps: float
    mu_xi: float
    mu_eta: float
    mu_w: float
    n_eta: float
    unbalance: float
    count: int = 2
    kappa: float = 1.0

    @classmethod
    def of_row(cls, row: TableRow) -> Dimensionless:
        """The system behind a row of Table 1 or 2."""
        return cls(row.eps, row.mu_xi, row.mu_eta, row.mu_w, STIFFNESS_RATIO, UNBALANCE)

    @classmethod
    def of(cls, assembly: Assembly) -> tuple[Dimensionless, float]:
        """The parameters of an assembly, and its w_x [rad/s] that scales the speeds.

        Raises:
            ValueError: the rotor is not planar, has internal damping, or the balancer is not one of
                weights.
        """
        rotor, weights = assembly.rotor, assembly.weights
        if rotor.stations != 1 or len(assembly.balancers) != 1 or len(weights) != 1:
            raise ValueError("the dimensionless form is for a planar rotor with one set of weights")
        if rotor.internal_damping.any():
            raise ValueError("the dimensionless form has no internal damping")
        device = weights[0].device
        assert isinstance(device, Weights)
        device.refuse_unequal("the dimensionless form")
        total = float(rotor.mass[0, 0]) + device.added_mass
        w_x = math.sqrt(float(rotor.stiffness_x[0, 0]) / total)
        return cls(
            eps=device.added_mass / (device.kappa * total),
            mu_xi=float(rotor.damping_x[0, 0]) / (2.0 * total * w_x),
            mu_eta=float(rotor.damping_y[0, 0]) / (2.0 * total * w_x),
            mu_w=device.damping_rate / w_x,
            n_eta=math.sqrt(float(rotor.stiffness_y[0, 0] / rotor.stiffness_x[0, 0])),
            unbalance=abs(complex(rotor.unbalance[0])) / device.point_capacity,
            count=device.count,
            kappa=device.kappa,
        ), w_x

    def assembly(
        self,
        total_mass: float = 1.0,
        frequency: float = 1.0,
        track_radius: float = 1.0,
        angles: Sequence[float] | None = None,
    ) -> Assembly:
        """The assembly of given mass M_S [kg], w_x [rad/s] and R [m].

        Args:
            angles: of the weights [rad]; those of the paper for two, else evenly spread, which
                serve as the start towards a balanced position.
        """
        if angles is None:
            spread = [2.0 * math.pi * (k + 0.5) / self.count for k in range(self.count)]
            angles = ANGLES if self.count == 2 else spread
        mass = self.eps * self.kappa * total_mass / self.count
        device = Weights(
            count=self.count,
            mass=mass,
            track_radius=track_radius,
            drag=self.mu_w * self.kappa * mass * frequency,
            kappa=self.kappa,
        )
        stiffness = total_mass * frequency**2
        damping = 2.0 * total_mass * frequency
        rotor = LinearRotor.planar(
            mass=total_mass - device.added_mass,
            stiffness=(stiffness, stiffness * self.n_eta**2),
            damping=(damping * self.mu_xi, damping * self.mu_eta),
            unbalance=self.unbalance * device.point_capacity,
        )
        return Assembly(rotor, (Mounted("weights", device, 0, tuple(angles)),))
