"""What was understood of a scene in engineers' units, and values probably in a wrong unit."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...models.papers.capacity import weight_mass
from ...models.readable import readable_apart, readable_unbalance, rounded
from ..errors import outer_level
from ..units import WIDEST, engineers, in_both
from .balancer import Liquid, Ring, WeightBalancer
from .quantities import each_of
from .rotor_flexible import Flexible

if TYPE_CHECKING:
    from .scene import Scene

FASTEST = 100.0  # times the lowest critical speed
SLOWEST = 1e-9  # rad/s: natural frequencies are rounded to it
FASTEST_TRACK = 100.0  # m/s of balls along their track: steel wheels burst at some 300 m/s
FARTHEST = 0.1  # eccentricity over the track's radius
FARTHEST_ALONE = 0.01  # m: eccentricity of a rotor without balancers
LIGHTEST, DENSEST = 500.0, 20_000.0  # kg/m^3 of a ball: wood to tungsten
OVERDAMPED = 1e-6  # of an eigenvalue: with less of it imaginary nothing swings
STIFF = 1e-6  # of the highest frequency: lower ones are those of a free body
MODES_OF_INTEREST = 1.5  # times the speed: slower ones are passed or near
MOST_CHANGE_BY_SIZE = 0.05  # of a natural frequency, by the inertia that a disc must have
MOST_SHOWN = 10.0  # times it: a change beyond is told as more than that
_warnings_given: set[str] = set()  # warnings that this process has given
HELD = 3.0  # times gravity: centrifugal acceleration that surely keeps a liquid at its wall
RING_RADIUS, RING_GAP = 0.15, 0.005  # m: chambers with a float are smaller or their gap is
CAPACITY_ROUNDING = 1e-12  # of what weights hold
MOST_GROWTH = 25.0  # of the logarithm of a motion: its weights then need a million short steps


class ImplausibleWarning(UserWarning):
    """A value of a scene is probably in another unit than it is taken to be."""


def understood(scene: Scene) -> str:
    """One line: speed, rotor, balancers."""
    profile, rotor = scene.profile(), scene.rotor
    parts = [f"{scene.name}: {rounded(rotor.mass, 3)} kg at {in_both(profile.end, 'rad/s')}"]
    rates = _rates_at_rest(scene)
    swings = np.abs(rates.imag) > OVERDAMPED * np.abs(rates)  # the others creep back, as rubber
    found = np.abs(rates[swings]).tolist()
    frequencies = sorted({rounded(w / math.tau, 3) for w in found}, key=float)
    if frequencies:
        parts.append(f"natural frequencies {', '.join(frequencies)} Hz")
    else:
        parts.append("no natural frequency: overdamped")
    if unbalance := _unbalance(scene):
        e = unbalance / rotor.mass
        parts.append(
            f"unbalance {readable_unbalance(unbalance)}, eccentricity {engineers(e, 'm', 3)}"
        )
    several = sum(isinstance(one, WeightBalancer) for one in scene.balancer) > 1
    for one in scene.balancer:
        if isinstance(one, WeightBalancer):
            name = f"{one.label}: " * several
            most = readable_unbalance(one.capacity)
            each = each_of(one.mass) or (one.mass,)
            grams = " to ".join(rounded(1e3 * m, 3) for m in sorted({min(each), max(each)}))
            hold = f"{one.kind} of {grams} g hold"
            if one.count == 1:
                hold = f"{one.kind.removesuffix('s')} of {grams} g holds"
            parts.append(f"{name}{one.count} {hold} {most}")
            if one.weight_radius and one.kind == "balls" and not one.unequal:
                parts[-1] += f", density {_density(one) / 1e3:.3g} g/cm^3"
    return "; ".join(parts)


def implausible(scene: Scene) -> list[str]:
    """Values in a unit that is probably wrong, one line each: key, value, and the reason."""
    return [*scene.once(_lines)]


def _lines(scene: Scene) -> list[str]:
    return list(_implausible(scene))


def _implausible(scene: Scene) -> Iterator[str]:
    speed, rotor = scene.profile().end, scene.rotor
    said = f"speed = {in_both(speed, 'rad/s')}"
    weights = [one for one in scene.balancer if isinstance(one, WeightBalancer)]
    lowest = min(natural_frequencies(scene), default=math.inf)
    fast = max((speed * one.track_radius for one in weights), default=0.0)
    if speed > FASTEST * lowest:
        yield (
            f"{said}: {speed / max(lowest, SLOWEST):.0f} times the critical speed, "
            f'{in_both(lowest, "rad/s")}; is it in rpm? then write "{speed:g} rpm"'
        )
    elif fast > FASTEST_TRACK:
        yield (
            f"{said}: weights move along their track at {fast:.0f} m/s; is the speed in rpm, or "
            f'track_radius in mm? then write "{speed:g} rpm", or the radius with its unit'
        )
    unbalance, mass = _unbalance(scene), rotor.mass
    e, track = unbalance / mass, min((one.track_radius for one in weights), default=0.0)
    if e > (FARTHEST * track if weights else FARTHEST_ALONE):
        than = f"a tenth of the track radius, {engineers(track, 'm')}" if weights else "10 mm"
        yield (
            f"rotor.unbalance = {unbalance:g} kg m: an eccentricity of {engineers(e, 'm')}, more "
            f'than {than}; is it in g mm? then write "{unbalance:g} g mm"'
        )
    total = sum(one.count * one.mass for one in weights)
    if total > mass:
        heaviest = max(weights, key=lambda one: one.mass)
        yield (
            f"{heaviest.label}.mass = {heaviest.mass:g} kg: all weights, {total:g} kg, are "
            f'heavier than the rotor, {mass:g} kg; is it in g? then write "{heaviest.mass:g} g"'
        )
    for one in weights:
        known = one.kind == "balls" and one.weight_radius and not one.unequal
        density = _density(one) if known else None
        if density is not None and not LIGHTEST <= density <= DENSEST:
            yield (
                f"{one.label}.mass = {one.mass:g} kg: a density of {density / 1e3:.3g} g/cm^3 with "
                f"weight_radius = {engineers(one.weight_radius or 0.0, 'm')}; steel has 7.8"
            )
        if any(abs(angle) > WIDEST for angle in one.angles):
            yield (
                f"{one.label}.angles = {[float(f'{a:g}') for a in one.angles]} rad: more than two "
                'turns; are they in degrees? then write "120 deg"'
            )
    yield from _rings_called_liquid(scene)
    yield from _collapsing_rings(scene)
    yield from _short_of_capacity(scene)
    yield from _discs_without_size(scene)
    yield from _growing(scene)
    films = bool(scene.rotor.bearings)  # which damp as they do
    if not films and (ratio := scene.rotor.largest_damping_ratio()) > 1.0:
        yield (
            f"rotor: the supports' damping is {ratio:.3g} times the critical one; usual are 0.01 "
            'to 0.2: give damping_ratio = "5 %" instead if damping is not known'
        )


def _rings_called_liquid(scene: Scene) -> Iterator[str]:
    """Full chambers with a float that have the size of a ring with a free surface."""
    for one in scene.balancer:
        if isinstance(one, Liquid):
            gap = one.chamber_radius - one.float_radius
            if one.chamber_radius >= RING_RADIUS and gap >= RING_GAP:
                yield (
                    f"{one.label}.chamber_radius = {one.chamber_radius:g} m: as large as a ring "
                    'part filled with liquid, and kind = "liquid" is a full chamber with a float, '
                    'without waves; write kind = "ring" for a ring with a free surface'
                )


def _collapsing_rings(scene: Scene) -> Iterator[str]:
    """Rings of liquid about a horizontal axis at speeds at which gravity breaks them."""
    slowest = min(scene.profile().speeds)
    for one in scene.balancer if scene.operation.gravity else ():
        if isinstance(one, Ring):
            least = math.sqrt(HELD * abs(scene.operation.field) / one.device.inner_radius)
            if slowest < least:
                yield (
                    f"operation.gravity: below {in_both(least, 'rad/s')} the liquid of {one.label} "
                    f"does not stay at its wall, and the run begins or ends at "
                    f"{in_both(slowest, 'rad/s')}: the model has a ring of liquid at every speed"
                )


def _short_of_capacity(scene: Scene) -> Iterator[str]:
    for time in (0.0, *(change.time for change in scene.operation.unbalance_changes)):
        assembly, needed, most = scene.assembly().at(time), _unbalance(scene, time), 0.0
        if scene.rotor.kind == "planar":
            most = sum(one.capacity for one in scene.balancer if isinstance(one, WeightBalancer))
        elif assembly.weights:
            from ...models.linear.balanced import CannotBalance, check_reach
            from ...models.linear.weight_table import WeightTable

            try:
                check_reach(assembly, WeightTable.of(assembly))
            except CannotBalance as error:
                needed, most = error.needed, error.capacity
            else:
                continue
        if assembly.weights and needed > most * (1.0 + CAPACITY_ROUNDING):
            wanted, held = readable_apart(needed, most)
            since = f" from {time:g} s on" if time else ""
            yield (
                f"unbalance: {wanted} to balance{since}, "
                f"the weights hold at most {held}: take more or heavier "
                "weights, or a larger track"
            )


def _growing(scene: Scene) -> Iterator[str]:
    """Rotors with weights that whirl by themselves beyond any bound."""
    speed, rotor = scene.operation.speed, scene.rotor
    if speed is None or rotor.is_restrained or rotor.friction or not scene.assembly().weights:
        return
    try:
        rates = scene.assembly().at_speed(speed).loaded_rotor.free_rates(speed)
    except ValueError:  # the run is refused: a bearing's table does not hold the speed
        return
    rate = float(rates.real.max())
    seconds = scene.run.duration or math.tau * scene.run.revolutions / speed
    if rate * seconds > MOST_GROWTH:
        yield (
            f"speed = {in_both(speed, 'rad/s')}: the rotor itself is unstable there, by internal "
            f"damping or its bearings: its motion grows by {rate:.3g} 1/s, e^{rate * seconds:.0f} "
            f"in {seconds:.3g} s, and the run takes ever shorter steps: run it for at most "
            f"{MOST_GROWTH / rate:.2g} s, or slower (`autobalancer rotor` states its modes)"
        )


def _discs_without_size(scene: Scene) -> Iterator[str]:
    """Points that carry a balancer so wide that their disc's inertia matters."""
    rotor = scene.rotor
    if not isinstance(rotor, Flexible) or rotor.transverse_inertias or rotor.compliance:
        return
    across = [0.0] * len(rotor.stations)
    for one in scene.balancer:
        radius = getattr(one, "track_radius", 0.0) or getattr(one, "chamber_radius", 0.0)
        thin = rotor.masses[one.at - 1] * radius**2 / 4.0
        across[one.at - 1] = max(across[one.at - 1], thin)
    if not any(across):
        return
    sized = {"transverse_inertias": tuple(across), "polar_inertias": tuple(2.0 * i for i in across)}
    speed = scene.profile().end
    points, discs = (
        np.sort(np.abs(table.build().free_rates(speed)))
        for table in (rotor, rotor.model_copy(update=sized))
    )
    rigid = STIFF * points.max()  # motions of a free machine: what rounding leaves of 0
    low = (rigid < points) & (points < MODES_OF_INTEREST * speed)
    change = float(np.max(np.abs(discs[: len(points)][low] / points[low] - 1.0), initial=0.0))
    if change > MOST_CHANGE_BY_SIZE:
        station = int(np.argmax(across))
        by = f"{100.0 * min(change, MOST_SHOWN):.0f} %"
        by = by if change < MOST_SHOWN else f"more than {by}"
        yield (
            f"rotor.masses[{station + 1}] = {rotor.masses[station]:g} kg: a point, but a thin disc "
            f"as wide as its balancer would move a natural frequency by {by}: give "
            f"transverse_inertias, here about {across[station]:.3g} kg m^2, and polar_inertias, "
            f"about {2.0 * across[station]:.3g} kg m^2"
        )


def natural_frequencies(scene: Scene) -> list[float]:
    """Natural frequencies of the rotor with its balancers at standstill [rad/s].

    With the rates at which overdamped motions creep back.
    """
    rates = np.abs(_rates_at_rest(scene)).round(9)
    return sorted(set(rates.tolist()))  # np.unique loads masked arrays


def _rates_at_rest(scene: Scene) -> NDArray:
    """Eigenvalues [1/s] at standstill, without the drift of a machine that nothing holds."""
    rates = scene.assembly().resting_rotor.at_bottom.free_rates(0.0)
    if scene.rotor.is_free:
        rates = rates[np.abs(rates) > STIFF * np.abs(rates).max()]
    return rates


def _unbalance(scene: Scene, time: float = 0.0) -> float:
    """Sum of the rotor's unbalances from `time` [s] on [kg m]."""
    rotor = scene.rotor_at(time)
    return rotor.unbalance if rotor.kind == "planar" else sum(u.amount for u in rotor.unbalances)


def _density(one: WeightBalancer) -> float:
    """Of a ball [kg/m^3]."""
    return one.mass / weight_mass("balls", one.weight_radius or 0.0, density=1.0)


def tell(scene: Scene) -> None:
    """Print the line and the warnings, unless --quiet is given."""
    from ..output.terminal import is_quiet, say

    if not is_quiet.get():
        say(understood(scene))
    for line in (found := implausible(scene)):
        tell_warning(line)
    _warnings_given.update(found)


def tell_warning(line: str) -> None:
    """Print a warning, unless --quiet is given."""
    from ..output.terminal import is_quiet, say

    if not is_quiet.get():
        say(f"WARNING: {line}", style="bold yellow", error=True)


def warn(scene: Scene) -> None:
    """Warn a caller of the library, of every value once, unless a command is quiet."""
    from ..output.terminal import is_quiet

    for line in () if is_quiet.get() else implausible(scene):
        if line not in _warnings_given:
            _warnings_given.add(line)
            warnings.warn(f"{scene.label}: {line}", ImplausibleWarning, outer_level())
