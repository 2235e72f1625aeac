"""The window of a liquid balancer from the coupled units, compared with Dubovik 2006.

Measured without an equation of motion: steady bending is the fixed point of the one-revolution
map, stability its largest multiplier.  Expected: (6), (10), (11) and the roots of the disturbed
motion (7).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np
from scipy.optimize import brentq

from ...models.papers.window import OPEN_END, LiquidWindow
from ..errors import SceneError, SimulationError
from ..scene import Scene
from ..stability.main_motion import MainMotion
from ..stability.revolution import Revolution
from .proved import window_rows
from .row import Row, Rows

# relative; in brackets the largest error over the bundled scenes: that of the coupling, where the
# liquid's inertia goes as a force; as added mass none is above 2e-9
BOUNDARY_TOLERANCE = 1e-4  # of w_* and w^* (3e-6)
GROWTH_TOLERANCE = 1e-3  # of growth rates (9e-5)
BENDING_TOLERANCE = 1e-5  # (7e-10)
PHASE_TOLERANCE = 1e-5  # rad (9e-10)
SPEEDS = 20  # across the window, at which bending and phase are compared
GROWTH_SPEEDS = (0.9, 0.97, 1.03, 1.1)  # fractions of w^*, both sides of it
OPEN_SPAN, OPEN_SPEEDS = 50.0, 25  # of it, end over start: from far below w_*; every 17 %
WIDTHS = (0.02, 0.1, 0.3, 1.0, 3.0)  # of a guess: narrow first, for another change may be near
POSITION = 1e-10  # of a guess: far below any tolerance of a row
BESIDE = 1e-3  # relative: so near a speed of contact, rounding decides whether the float touches

LOWER, UPPER, STEADY = (f"Dubovik 2006 ({number})" for number in (11, 10, 6))
Measured = Callable[[float], float]  # of the speed [rad/s]


def window_of(scene: Scene) -> LiquidWindow:
    """The theory of a scene's liquid balancer.

    Raises:
        SceneError: the scene is not one rotor in a plane with one liquid balancer, or nothing
            bends it.
    """
    try:
        window = LiquidWindow.of(scene.assembly())
    except ValueError as error:
        raise SceneError(f"{scene.label}: check liquid_window: {error}") from error
    if window.unbalance == 0.0:
        raise SceneError(
            f"{scene.label}: check liquid_window: rotor.unbalance = 0 kg m: needs an unbalance, "
            "must be above 0: the window is where the liquid lessens the bending that it causes"
        )
    return window


def steady_displacement(units: Revolution, speed: float) -> complex:
    """x + i y after whole revolutions of the main motion, rotor at its starting angle [m]."""
    state = units.steady(speed)
    return complex(state[0], state[1])


def check_liquid_window(scene: Scene) -> Iterator[Row]:
    """Rows (a) w_*, (b) w^*, (c) bending and phase across the window, (d) growth rates.

    Raises:
        SceneError: the scene is not one rotor in a plane with one liquid balancer, or balanced.
    """
    window = window_of(scene)
    rows = Rows(scene.name, "liquid_window")
    turned = np.exp(-1j * np.angle(scene.assembly().rotor.unbalance[0]))
    alone = scene.without_balancers()
    with MainMotion(scene, separate=True) as motion, Revolution(alone, separate=True) as bare:
        loaded, growth = motion.units, motion.growth

        def bending(speed: float) -> float:
            return abs(steady_displacement(loaded, speed))

        def benefit(speed: float) -> float:
            return bending(speed) - abs(steady_displacement(bare, speed))

        lower = sign_change(benefit, window.lower, "w_*, where the balancer begins to help")
        yield rows.number(
            "lower boundary w_* [rad/s]", window.lower, lower, BOUNDARY_TOLERANCE, LOWER
        )
        upper = None
        if window.upper is None:
            yield _no_upper_limit(rows, growth, OPEN_END * window.lower)
        else:
            upper = sign_change(growth, window.upper, "w^*, where rotation becomes unstable")
            yield rows.number(
                "upper boundary w^* [rad/s]", window.upper, upper, BOUNDARY_TOLERANCE, UPPER
            )
            yield _window(rows, window, lower, upper)
        yield from window_rows(rows, scene, window, lower, upper, BOUNDARY_TOLERANCE)
        end = upper if upper and upper > lower else OPEN_END * lower
        speeds = np.linspace(lower, end, SPEEDS)
        bent = turned * np.array([steady_displacement(loaded, speed) for speed in speeds])
        yield from _bending(rows, window, speeds, bent)
        if upper is not None:
            yield _growth(rows, growth, window, upper)
        yield _contact(rows, bending, window, speeds, np.abs(bent))


def sign_change(function: Measured, guess: float, what: str) -> float:
    """Speed at which a measured function changes sign, searched outward from a guess [rad/s].

    A function that is zero, or not a number, at an end of the range searched has no sign there.

    Raises:
        SimulationError: no change of sign from a quarter of the guess to four times it.
    """
    for width in WIDTHS:
        left, right = guess / (1.0 + width), guess * (1.0 + width)
        below, above = sorted((function(left), function(right)))
        if below < 0.0 < above:
            return float(brentq(function, left, right, xtol=POSITION * guess, rtol=1e-12))
    raise SimulationError(f"{what} was not found between {guess / 4.0:g} and {4.0 * guess:g} rad/s")


def _no_upper_limit(rows: Rows, growth: Measured, end: float) -> Row:
    """p = 0: every measured speed must be stable, up to a stated end."""
    speeds = np.geomspace(end / OPEN_SPAN, end, OPEN_SPEEDS)
    unstable = [speed for speed in speeds if growth(speed) > 0.0]
    measured = f"stable at all {len(speeds)} speeds from {speeds[0]:.4g} to {end:.4g} rad/s"
    if unstable:
        measured = f"grows at {unstable[0]:.4g} rad/s"
    return rows.statement("upper boundary w^*", "none (p = 0)", measured, not unstable, UPPER)


def _window(rows: Rows, window: LiquidWindow, lower: float, upper: float) -> Row:
    """Open or empty, and by which condition."""
    ratio = (1.0 + window.external_damping / window.internal_damping) ** 2
    limit = 2.0 * window.mu / (1.0 + window.mu)
    word, sign = ("empty", "<=") if window.empty else ("open", ">")
    expected = f"{word}: (1+chi/p)^2 = {ratio:.4g} {sign} 2mu/(1+mu) = {limit:.4g}"
    measured = f"open: {lower:.6g} to {upper:.6g} rad/s"
    if upper <= lower:
        measured = f"empty: w^* = {upper:.6g} <= w_* = {lower:.6g} rad/s"
    holds = window.empty == (upper <= lower)
    return rows.statement("window w_* < w < w^*", expected, measured, holds, UPPER)


def _bending(
    rows: Rows, window: LiquidWindow, speeds: np.ndarray, motion: np.ndarray
) -> Iterator[Row]:
    span = f"at {len(speeds)} speeds, {speeds[0]:.4g} to {speeds[-1]:.4g} rad/s"
    quantity, bending = f"steady bending {span} [m]", window.bending(speeds)
    yield rows.number(quantity, bending, np.abs(motion), BENDING_TOLERANCE, STEADY)
    # an angle is compared on the circle, so that -pi and pi are neighbours
    phase = np.asarray(window.phase(speeds))
    measured = phase + np.angle(motion * np.exp(-1j * phase))
    yield rows.number(f"phase {span} [rad]", phase, measured, PHASE_TOLERANCE, STEADY, scale=1.0)


def _growth(rows: Rows, growth: Measured, window: LiquidWindow, upper: float) -> Row:
    speeds = upper * np.array(GROWTH_SPEEDS)
    expected = [window.roots(speed)[0].real for speed in speeds]
    measured = [growth(speed) for speed in speeds]
    quantity = f"growth rate at {', '.join(f'{f:g}' for f in GROWTH_SPEEDS)} w^* [1/s]"
    source = "Dubovik 2006 (7), exact roots"
    return rows.number(quantity, expected, measured, GROWTH_TOLERANCE, source)


def _contact(
    rows: Rows, bending_at: Measured, window: LiquidWindow, speeds: np.ndarray, bending: np.ndarray
) -> Row:
    """Where the float touches the chamber (bending = gap) and the model ends."""
    gap = window.liquid.gap
    low, high = float(speeds[0]), float(speeds[-1])
    touching = [
        (max(start, low), min(end or math.inf, high))
        for start, end in window.touching_speeds()
        if start < high and (end is None or end > low)
    ]
    # a boundary that is an end of the range is not a speed at which contact begins or ends
    inner = [b for pair in touching for b in pair if low < b < high]
    measured = [
        sign_change(lambda w: gap - bending_at(w), b, "the speed at which the float touches")
        for b in inner
    ]
    touched = bending > gap
    expected = np.array([any(a <= w <= b for a, b in touching) for w in speeds])
    near = np.array([any(math.isclose(w, b, rel_tol=BESIDE) for b in inner) for w in speeds])
    agree = all(
        math.isclose(f, b, rel_tol=BOUNDARY_TOLERANCE) for f, b in zip(measured, inner, strict=True)
    )
    return rows.statement(
        f"float clear of the wall, {low:.4g} to {high:.4g} rad/s",
        _contact_text(touched=bool(touching), bounds=inner),
        _contact_text(touched=bool(touched.any()), bounds=measured)
        + f", least clearance {gap - bending.max():.4g} m",
        agree and bool((touched == expected)[~near].all()),
        "Dubovik 2006 (6), bending < r1 - r2",
    )


def _contact_text(*, touched: bool, bounds: list[float]) -> str:
    if not touched:
        return "clear throughout"
    if not bounds:
        return "touches throughout: model invalid"
    return "touches, model invalid: changes at " + ", ".join(f"{b:.6g}" for b in bounds) + " rad/s"
