"""The unstable band of a ring of liquid from the coupled units, compared with its closed form.

(a) The ends of the band without damping, where two whirls meet, and (b) growth rates in it with the
scene's damping, c of the supports and p inside the shaft (Dubovik 2006 (7)): roots of
(k + i c nu + i p (nu - w) - M nu^2) q(nu) = m_L nu^2 (q(nu) - f nu^2),
q = (1 + f) nu^2 - 4 w nu + 2 w^2 - i d (nu - w), a quartic as in Li, Wang and Yuan 2018.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.polynomial import Polynomial

from ...models.linear.ring_band import ring_of, unstable_band
from ..errors import SceneError
from ..scene import Scene
from ..stability.main_motion import MainMotion
from .liquid_window import sign_change
from .row import Row, Rows

EDGE_TOLERANCE = 1e-5  # growth rises with the root of the distance from an end
GROWTH_TOLERANCE = 1e-4
JUST_UNSTABLE = 1e-4  # of the speed: a growth rate that is no rounding
WITHIN = (0.25, 0.5, 0.75)  # of the band: where growth rates are compared
_SOURCE = "closed form: stationary values of kappa"


def check_ring_band(scene: Scene) -> Iterator[Row]:
    """Rows for the lower and the upper end, and for growth rates.

    Raises:
        SceneError: the scene is not one rotor in a plane with one ring of liquid.
    """
    try:
        mass, stiffness, ring = ring_of(scene.assembly())
    except ValueError as error:
        raise SceneError(f"{scene.label}: check ring_band: {error}") from error
    rows, name = Rows(scene.name, "ring_band"), scene.assembly().rings[0].name
    low, high = unstable_band(mass, stiffness, ring)
    bare = {"rotor.damping": 0.0, "rotor.internal_damping": 0.0, "rotor.damping_ratio": None}
    waves = {f"{name}.wave_damping": 0.0, f"{name}.viscosity": 0.0}
    with MainMotion(scene.replace({**bare, **waves})) as undamped:

        def rises(speed: float) -> float:
            return undamped.growth(speed) - JUST_UNSTABLE * speed

        def falls(speed: float) -> float:
            return -rises(speed)

        for what, end, function in (("lower", low, rises), ("upper", high, falls)):
            found = sign_change(function, end, f"the {what} end")
            yield rows.number(
                f"{what} end of the unstable band, undamped [rad/s]", end, found, EDGE_TOLERANCE,
                _SOURCE,
            )  # fmt: skip
    speeds = low + (high - low) * np.array(WITHIN)
    expected = [_growth(scene, float(speed)) for speed in speeds]
    with MainMotion(scene) as damped:
        measured = [damped.growth(float(speed)) for speed in speeds]
    at = ", ".join(f"{speed:.4g}" for speed in speeds)
    quantity, source = f"growth rate at {at} rad/s [1/s]", "Li 2018, quartic with all dampings"
    yield rows.number(quantity, expected, measured, GROWTH_TOLERANCE, source)


def _growth(scene: Scene, speed: float) -> float:
    """Largest -Im of the quartic's roots nu."""
    assembly = scene.assembly()
    mass, stiffness, ring = ring_of(assembly)
    outer, inner = (
        float(c[0, 0]) for c in (assembly.rotor.damping_x, assembly.rotor.internal_damping)
    )
    f = ring.hollow
    d, nu = ring.damping(speed), Polynomial([0.0, 1.0])
    wave = (1.0 + f) * nu**2 - 4.0 * speed * nu + 2.0 * speed**2 - 1j * d * (nu - speed)
    rotor = stiffness + 1j * outer * nu + 1j * inner * (nu - speed) - mass * nu**2
    roots = (rotor * wave - ring.liquid_mass * nu**2 * (wave - f * nu**2)).roots()
    return float(-roots.imag.min())
