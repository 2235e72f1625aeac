"""A scene's machine as a drawing: along the shaft from the side, and each balancer from its end."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence

from ..result.verdict.words import millimetres
from ..scene import Scene
from ..scene.balancer import AnyBalancer, Ring, WeightBalancer
from ..scene.bodies import BodyTable
from ..scene.rotor import TwoSupport
from ..scene.rotor_flexible import Flexible
from ..scene.stop import Stop
from ..units import shown_in
from .svg import box, circle, drawing, line, spring, words

_HEIGHT = 280.0  # px
_SHAFT_WIDTH = 420.0  # of the side view, its labels included
_RING_WIDTH = 230.0  # of a balancer from its end
_SPRINGS = 40.0  # beside a planar rotor
_REACH = 78.0  # radius that the largest track is drawn with
_MIDDLE = 112.0  # height of the shaft
_MOST_STOPS = 3  # that are drawn around a planar rotor, and named
_LINE = 16.0  # px, of words below each other
_LEAST_SPAN = 1e-9  # m: a rotor whose stations all lie at one place


def machine_drawing(scene: Scene) -> str:
    """SVG of rotor, supports, unbalance and balancers, with names and sizes."""
    rotor = scene.rotor
    shapes: list[str] = []
    left = 0.0
    if isinstance(rotor, TwoSupport | Flexible):
        shapes += _side_view(scene, rotor)
        left = _SHAFT_WIDTH
    elif not scene.balancer:
        shapes += _end_view(scene, None, 0.0)
        left = _RING_WIDTH + _SPRINGS
    for balancer in scene.balancer:
        shapes += _end_view(scene, balancer, left)
        left += _RING_WIDTH + (_SPRINGS if rotor.kind == "planar" and not left else 0.0)
    lines = _gaps(rotor.stops)
    middle = _SHAFT_WIDTH / 2.0 if rotor.kind != "planar" else _RING_WIDTH / 2.0 + _SPRINGS
    for number, said in enumerate(lines, start=1):
        shapes.append(words(middle, _HEIGHT - 4.0 + _LINE * number, said))
    height = _HEIGHT + _LINE * len(lines)
    return drawing(left, height, shapes, f"Drawing of {scene.heading}")


def _side_view(scene: Scene, rotor: TwoSupport | Flexible) -> Iterator[str]:
    """Shaft with stations, supports, balancers' planes and unbalances."""
    feet = [foot.position for body in rotor.bodies for foot in body.feet]
    places = [*rotor.stations, *rotor.planes, rotor.centre, *feet]
    low, span = min(places), max(max(places) - min(places), _LEAST_SPAN)

    def across(z: float) -> float:
        return 50.0 + (z - low) / span * (_SHAFT_WIDTH - 100.0)

    carrier = rotor.carrier
    foot = _MIDDLE + (50.0 if carrier else 85.0)
    for number, station in enumerate(rotor.supports, start=1):
        x = across(rotor.stations[station - 1])
        yield spring((x, _MIDDLE), (x, foot))
        if not carrier:
            yield words(x, _MIDDLE + 112.0, f"support {number}")
    if carrier:
        yield from _carrier(carrier, [across(z) for z in rotor.support_positions], across)
    yield line([(across(low) - 25.0, _MIDDLE), (across(low + span) + 25.0, _MIDDLE)], "shaft")
    yield from _bodies(rotor, across(rotor.centre), across)
    yield from _bumpers(rotor, across)
    unit, factor = shown_in("kg m")
    for one in rotor.unbalances:
        x = across(one.position)
        yield circle(x, _MIDDLE - 30.0, 5.0, "heavy")
        yield words(x, 20.0, f"{factor * one.amount:.4g} {unit}")
    for balancer in scene.balancer:
        x = across(rotor.planes[balancer.at - 1])
        for side in (-1.0, 1.0):
            yield box(x, _MIDDLE + side * 42.0, 12.0, 12.0, "ring")
        yield words(x, _MIDDLE + 132.0, balancer.label)
    yield words(_SHAFT_WIDTH / 2.0, _HEIGHT - 4.0, f"rotor of {rotor.mass:.4g} kg")


def _carrier(
    body: BodyTable, supports: Sequence[float], across: Callable[[float], float]
) -> Iterator[str]:
    """The body that carries the rotor: a bar under its supports, on its own feet."""
    ends = [*supports, *(across(foot.position) for foot in body.feet), across(body.center)]
    low, high, top = min(ends) - 12.0, max(ends) + 12.0, _MIDDLE + 56.0
    yield box((low + high) / 2.0, top, high - low, 12.0)
    for foot in body.feet:
        yield spring((across(foot.position), top + 6.0), (across(foot.position), top + 40.0))
    held = "" if body.feet else ", free"
    yield words((low + high) / 2.0, _MIDDLE + 112.0, f"{body.name} of {body.mass:.4g} kg{held}")


def _bodies(
    rotor: TwoSupport | Flexible, centre: float, across: Callable[[float], float]
) -> Iterator[str]:
    """Discs of a flexible shaft, higher the heavier; the one body of a rigid rotor."""
    if isinstance(rotor, TwoSupport):
        width = 0.6 * abs(across(rotor.span) - across(0.0))
        yield box(centre, _MIDDLE, width, 56.0)
        return
    most = max(rotor.masses)
    for z, mass in zip(rotor.stations, rotor.masses, strict=True):
        if mass > 0.0:
            yield box(across(z), _MIDDLE, 14.0, 24.0 + 56.0 * (mass / most) ** (1.0 / 3.0))


def _bumpers(rotor: TwoSupport | Flexible, across: Callable[[float], float]) -> Iterator[str]:
    """Stops beside the shaft at a support, and beside the foot of the body that carries it."""
    places = {k: (z, _MIDDLE) for k, z in enumerate(rotor.support_positions, start=1)}
    feet = {
        f"{body.name}.foot[{k}]": (foot.position, _MIDDLE + 76.0)
        for body in rotor.bodies
        for k, foot in enumerate(body.feet, start=1)
    }
    for one in rotor.stops:
        z, height = (places | feet)[one.support]
        for side in (-1.0, 1.0):
            if height == _MIDDLE:
                yield box(across(z), height + 14.0 * side, 22.0, 5.0, "bumper")
            else:
                yield box(across(z) + 14.0 * side, height, 5.0, 22.0, "bumper")


def _gaps(stops: Sequence[Stop]) -> list[str]:
    """What the stops are and how far away, the first lines of them."""
    said = [f"{one.called}, gap {millimetres(one.gap)}" for one in stops[:_MOST_STOPS]]
    more = len(stops) - len(said)
    return said + ([f"and {more} more stops"] if more else [])


def _rings(stops: Sequence[Stop], middle: float, edge: float) -> Iterator[str]:
    """Stops around a planar rotor at its start, with their gaps; not to scale."""
    for number, one in enumerate(stops[:_MOST_STOPS]):
        reach = edge + 7.0 + 5.0 * number
        if one.kind == "ring":
            yield circle(middle, _MIDDLE, reach, "stop")
        for side in (-1.0, 1.0):
            if one.kind == "x":
                yield box(middle + side * reach, _MIDDLE, 5.0, 34.0, "bumper")
            elif one.kind == "y":
                yield box(middle, _MIDDLE + side * reach, 34.0, 5.0, "bumper")


def _end_view(scene: Scene, balancer: AnyBalancer | None, left: float) -> Iterator[str]:
    """A balancer along the axis at its start; a planar rotor with its supports and unbalance."""
    rotor, first = scene.rotor, not left
    on_springs = rotor.kind == "planar" and first
    middle = left + _RING_WIDTH / 2.0 + (_SPRINGS if on_springs else 0.0)
    edge = _REACH + 10.0
    if on_springs:
        yield spring((middle, _MIDDLE + edge), (middle, _MIDDLE + edge + 34.0), 5.0)
        yield spring((middle - edge, _MIDDLE), (middle - edge - 46.0, _MIDDLE), 5.0)
    yield circle(middle, _MIDDLE, edge, "body")
    if rotor.kind == "planar" and rotor.unbalance:
        yield circle(*_at(middle, 0.45 * _REACH, rotor.unbalance_angle), 5.0, "heavy")
    if on_springs:
        yield from _rings(rotor.stops, middle, edge)
    if balancer is None:
        yield words(middle, _HEIGHT - 4.0, f"rotor of {rotor.mass:.4g} kg")
        return
    unit, factor = shown_in("m")
    if isinstance(balancer, WeightBalancer):
        yield circle(middle, _MIDDLE, _REACH, "track")
        scale = _REACH / balancer.track_radius
        for angle, one in zip(balancer.angles, balancer.device.each, strict=True):
            size = scale * one.radius if one.radius else 6.0
            yield circle(*_at(middle, _REACH, angle), max(2.0, size), "weight")
        said = (
            f"{balancer.count} {balancer.kind}, track {factor * balancer.track_radius:.4g} {unit}"
        )
    elif isinstance(balancer, Ring):
        ratio = balancer.device.inner_radius / balancer.wall_radius
        yield circle(middle, _MIDDLE, _REACH, "liquid")
        yield circle(middle, _MIDDLE, ratio * _REACH, "body")
        said = f"ring of liquid, wall {factor * balancer.wall_radius:.4g} {unit}"
    else:
        ratio = balancer.float_radius / balancer.chamber_radius
        yield circle(middle, _MIDDLE, _REACH, "liquid")
        yield circle(middle, _MIDDLE, ratio * _REACH, "body")
        said = f"liquid, chamber {factor * balancer.chamber_radius:.4g} {unit}"
    yield words(middle, _HEIGHT - 20.0, balancer.label)
    yield words(middle, _HEIGHT - 4.0, said)


def _at(middle: float, radius: float, angle: float) -> tuple[float, float]:
    return middle + radius * math.cos(angle), _MIDDLE - radius * math.sin(angle)
