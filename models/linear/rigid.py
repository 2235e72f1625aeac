"""Small motions of a machine that nothing holds: its rigid motions apart from all others.

A free machine drifts, and precesses at the rate that its polar inertia gives it; nothing damps
either.  Both leave the balance of the weights as it is, and tell nothing of it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..assembly import Assembly
from ..rotor import LinearRotor
from .floquet import constant_matrices
from .growth import Growth, eigenvalues_with_errors, largest
from .linearised import linearise

FREE = 1e-9  # of the largest stiffness: what holds nothing
NEAR = 1e-3  # of the speed: how near to its own rate a rigid motion with weights is


def rigid_rates(rotor: LinearRotor, speed: float) -> NDArray[np.complex128]:
    """Rates in fixed axes of motions that bend no shaft and push no support [1/s]; often none.

    M_R z'' - i w G_R z' = 0 of the motions R without stiffness, z = x + i y.
    """
    _, _, stiffness = rotor.coefficients(0.0)
    elastic = stiffness[: rotor.stations, : rotor.stations].real
    values, vectors = np.linalg.eigh((elastic + elastic.T) / 2.0)
    rows = vectors[:, np.abs(values) <= FREE * np.abs(values).max(initial=0.0)].T
    mass, turned = (rows @ each @ rows.T for each in (rotor.mass, rotor.gyroscopic))
    turns: NDArray = np.zeros(0)
    if len(rows):
        turns = np.linalg.eigvals(np.linalg.solve(mass, 1j * speed * turned))
    return np.concatenate([np.zeros(len(rows)), turns]).astype(complex)


def growth_beside_rigid(assembly: Assembly, speed: float) -> Growth | None:
    """Largest growth rate [1/s] about the main motion, rigid motions apart unless they grow.

    None where coefficients are not constant: supports whose axes differ.

    Raises:
        CannotBalance: the weights cannot undo the unbalance.
    """
    system = linearise(assembly.at_speed(speed))
    if not system.constant:
        return None
    matrices = constant_matrices([system], np.zeros(1, int), np.array([speed]))
    (values,), (errors,) = eigenvalues_with_errors(matrices)
    kept = np.ones(len(values), bool)
    frame = 1j * speed if len(system.angles) else 0.0
    for rate in rigid_rates(assembly.loaded_rotor, speed).tolist():
        for one in (rate - frame, complex(rate - frame).conjugate()):
            apart = np.where(kept, np.abs(values - one), np.inf)
            nearest = int(apart.argmin())
            if apart[nearest] <= NEAR * speed and values[nearest].real <= errors[nearest]:
                kept[nearest] = False
    growth = np.append(values[kept].real, -system.free_decay)
    uncertain = np.append(errors[kept], np.zeros(len(system.free_decay)))
    rates, error = largest(growth[None], uncertain[None])
    return Growth(float(rates[0]), float(error[0]))
