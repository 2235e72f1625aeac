"""Steady vibration of a rotor under its unbalance, dry friction in the supports by its harmonic.

A slider behind a spring that moves by Re(a e^{i w t}) pulls back with N a, N its describing
function (Jenkins 1962; first harmonic alone).  With s = F/(k_t |a|) < 1, the part of the amplitude
at which it slips, and cos h = 1 - 2 s

    N = k_t/pi (h - sin h cos h) + i 4/pi k_t s (1 - s);      N = k_t where it never slips.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .arrays import Array, Complex
from .rotor import LinearRotor
from .supports import CubicSpring, Slider, Stop

_STEPS, _NEWTON_HALVINGS = 100, 12  # of Newton's method, of one of its steps
SMALL = 0.01  # of the stiffness of the supports: what a cubic spring may add
_SLIDERS_CONVERGED = 1e-9  # of the largest motion without sliders


class NoResponse(ValueError):
    """Harmonic balance does not cover a rotor, or has no answer."""


def unbalance_response(rotor: LinearRotor, speeds: ArrayLike) -> Complex:
    """Displacements (k, 2, n) at constant speeds (k,) [rad/s]: x, y = Re(found e^{i w t}) [m].

    Without friction exact.  Gravity is left out: without friction it only shifts the motion.

    Raises:
        NoResponse: a slider is rigid or has a free stroke; an undamped rotor has no bounded
            response; Newton's method does not settle; or the motion reaches a stop, or bends a
            cubic spring.
    """
    if rotor.varies:
        each = [unbalance_response(rotor.at(float(w)), [w])[0] for w in np.asarray(speeds)]
        return np.array(each).reshape(-1, 2, rotor.stations)
    sliders = [slider for slider in rotor.sliders if slider.limit]
    rows = np.zeros((len(sliders), 2, rotor.stations))
    for number, slider in enumerate(sliders):
        rows[number, slider.axis] = slider.shares(rotor.stations)
    across = rows.reshape(len(sliders), 2 * rotor.stations).T
    spring, limit = np.array([(s.stiffness, s.limit) for s in sliders]).reshape(-1, 2).T
    if not spring.all():
        raise NoResponse(
            "rotor.friction: harmonic balance requires a stiffness (N/m) of every slider"
        )
    if any(slider.free_stroke for slider in sliders):
        raise NoResponse("rotor.friction: harmonic balance does not support a free_stroke")
    w = np.asarray(speeds, float)[:, None, None]
    mass, damping, stiffness = rotor.real_coefficients(0.0)
    _, with_speed, followed = rotor.real_coefficients(1.0)  # both are linear in it
    damping, stiffness = (
        damping + w * (with_speed - damping),
        stiffness + w * (followed - stiffness),
    )
    if rotor.waves:  # they are not linear in it
        _, *each = zip(*(rotor.real_coefficients(one) for one in w[:, 0, 0].tolist()), strict=True)
        damping, stiffness = np.array(each)
    unbalance = np.concatenate([rotor.unbalance, -1j * rotor.unbalance])
    forces = np.column_stack([unbalance, across])
    try:
        solutions = np.linalg.solve(stiffness - w**2 * mass + 1j * w * damping, forces[None])
    except np.linalg.LinAlgError:
        raise NoResponse("an undamped rotor has no bounded response at a critical speed") from None
    motion, compliance = w[:, 0] ** 2 * solutions[..., 0], solutions[..., 1:]
    if sliders:
        slack = limit / spring
        of_sliders = np.einsum("ij,kim->kjm", across, compliance)
        there = _at_sliders(motion @ across, of_sliders, spring, slack)
        pull = _describing(there, spring, slack)[0] * there
        motion = motion - np.einsum("kij,kj->ki", compliance, pull)
    found = motion.reshape(len(w), 2, rotor.stations)
    _refuse_beyond(rotor, found)
    return found


def _refuse_beyond(rotor: LinearRotor, motion: Complex) -> None:
    """Raise NoResponse where a motion (k, 2, n) is not small for what was left out."""
    if not rotor.beside:
        return
    largest = [float(np.abs(rotor.springs[axis, axis]).max()) for axis in (0, 1)]
    stiffness = min(largest)
    for one in rotor.beside:
        if isinstance(one, Slider):
            size = float(np.abs(motion[:, one.axis] @ one.shares(rotor.stations)).max())
            if one.limit and 2.0 * size >= one.free_stroke:
                raise NoResponse(
                    f"the vibration by the linear equations, {1e3 * size:.3g} mm, leaves the free "
                    f"stroke of a damper, {500.0 * one.free_stroke:.3g} mm to each side"
                )
            continue
        across = np.einsum("an,kan->ka", one.rows, motion)
        size = float(largest_displacement(across[:, :, None]).max()) if len(across) else 0.0
        if isinstance(one, Stop) and size >= one.gap:
            raise NoResponse(
                f"the vibration by the linear equations, {1e3 * size:.3g} mm, reaches a stop with "
                f"a gap of {1e3 * one.gap:.3g} mm"
            )
        bent = isinstance(one, CubicSpring) and max(map(abs, one.stiffness)) * size**2
        if bent > SMALL * stiffness:
            raise NoResponse("the vibration by the linear equations bends a cubic spring")


def largest_displacement(displacement: Complex) -> Array:
    """Half the long axes (k, n) of ellipses (k, 2, n): the largest sqrt(x^2 + y^2)."""
    x, y = displacement[:, 0], displacement[:, 1]
    return np.sqrt(0.5 * (abs(x) ** 2 + abs(y) ** 2 + abs(x**2 + y**2)))


def _describing(motion: Complex, spring: Array, slack: Array) -> tuple[Complex, Complex]:
    """N and |a| dN/d|a| of sliders (m,) that move by a (k, m); `slack`: F/k_t [m]."""
    s = slack / np.maximum(abs(motion), slack)
    h, product = np.arccos(1.0 - 2.0 * s), s * (1.0 - s)
    stiffness = spring / np.pi * (h - np.sin(h) * np.cos(h) + 4j * product)
    slope = -4.0 / np.pi * spring * s * (2.0 * np.sqrt(product) + 1j * (1.0 - 2.0 * s))
    return stiffness, np.where(s < 1.0, slope, 0.0)


def _at_sliders(free: Complex, compliance: Complex, spring: Array, slack: Array) -> Complex:
    """a (k, m) with a + compliance N(a) a = free: Newton's method from where all stick."""
    count, settled = free.shape[1], _SLIDERS_CONVERGED * abs(free).max()

    def missing(motion: Complex) -> Complex:
        pull = _describing(motion, spring, slack)[0] * motion
        return motion + np.einsum("kij,kj->ki", compliance, pull) - free

    motion = np.linalg.solve(np.eye(count) + compliance * spring, free[..., None])[..., 0]
    left = missing(motion)
    for _ in range(_STEPS):
        size = np.linalg.norm(left, axis=1)
        if size.max() <= settled:
            return motion
        step, part = _newton_step(motion, left, compliance, spring, slack), np.ones((len(free), 1))
        for _ in range(_NEWTON_HALVINGS):
            left = missing(motion - part * step)
            less = np.linalg.norm(left, axis=1) <= (1.0 - 0.1 * part[:, 0]) * size
            if (less | (size <= settled)).all():
                break
            part[~less] *= 0.5
        motion = motion - part * step
        left = missing(motion)
    raise NoResponse(f"harmonic balance of the sliders has not settled in {_STEPS} steps")


def _newton_step(
    motion: Complex, left: Complex, compliance: Complex, spring: Array, slack: Array
) -> Complex:
    """What to take from a (k, m), by its real and imaginary parts: |a| has no complex slope."""
    count = motion.shape[1]
    stiffness, slope = _describing(motion, spring, slack)
    turn = np.exp(1j * np.angle(motion))
    columns = [
        unit * np.eye(count)
        + compliance * (stiffness * unit + slope * turn * (turn / unit).real)[:, None]
        for unit in (1.0, 1j)
    ]
    matrix = np.concatenate(columns, axis=2)
    step = np.linalg.solve(
        np.concatenate([matrix.real, matrix.imag], axis=1),
        np.concatenate([left.real, left.imag], axis=1)[..., None],
    )
    return step[:, :count, 0] + 1j * step[:, count:, 0]
