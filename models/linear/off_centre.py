"""Weights on tracks that are off centre: the machine with centred tracks that they balance alike.

Weights come to rest in the rotor where the centre of their track does not move: there nothing
drives them along it.  A track whose centre lies delta beside that of its plane then leaves the
rotor whirling by -delta there: it vibrates by the size of the offset.  On supports that are alike
along x and y this is exact; elsewhere it holds for the part of the motion that turns with the
rotor.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..arrays import Array, Complex
from ..assembly import Assembly
from ..harmonic_balance import unbalance_response
from ..weights import Weights


def track_offsets(assembly: Assembly) -> tuple[Complex, Complex]:
    """Offset (p,) of the tracks of every plane [m], their mean by moments, and the unbalance (n,)
    of the weights' masses on them [kg m]."""
    rotor = assembly.loaded_rotor
    moments: Array = np.zeros(rotor.plane_count)
    shares: Complex = np.zeros(rotor.plane_count, complex)
    unbalance: Complex = np.zeros(rotor.stations, complex)
    for mounted in assembly.weights:
        assert isinstance(mounted.device, Weights)
        held = mounted.device.point_capacity
        moments[mounted.plane] += held
        shares[mounted.plane] += held * mounted.offset
        unbalance += mounted.device.added_mass * mounted.offset * rotor.planes[mounted.plane]
    return np.asarray(shares / np.where(moments, moments, 1.0), complex), unbalance


def centred(assembly: Assembly, speed: float) -> Assembly:
    """The machine with centred tracks in which weights balance at the same angles at this speed.

    Args:
        speed: of the rotor [rad/s].

    Raises:
        NoResponse: see `unbalance_response`.
        ArithmeticError: the weights cannot hold the centres of all tracks.
    """
    if not any(mounted.offset for mounted in assembly.weights):
        return assembly
    rotor = replace(assembly.loaded_rotor, sliders=(), beside=())
    offsets, carried = track_offsets(assembly)
    used = sorted({mounted.plane for mounted in assembly.weights})
    planes = rotor.planes[used]
    each = [replace(rotor, unbalance=unit) for unit in np.eye(rotor.stations, dtype=complex)]
    x, y = np.array([unbalance_response(one, [speed])[0] for one in each]).transpose(1, 2, 0)
    forward = planes @ (0.5 * (x + 1j * y))  # of the planes, by unbalances at the stations
    own = np.asarray(rotor.unbalance, complex) + carried
    try:
        moments = np.linalg.solve(forward @ planes.T, -offsets[used] - forward @ own)
    except np.linalg.LinAlgError:
        raise ArithmeticError("the weights cannot hold the centres of all tracks") from None
    return replace(
        assembly,
        rotor=replace(
            assembly.rotor,
            unbalance=np.asarray(-(moments @ planes), complex)[: assembly.rotor.stations],
        ),
        balancers=tuple(replace(mounted, offset=0j) for mounted in assembly.balancers),
        later=(),
    )
