"""Moving pictures of a run: rotor and weights seen along the axis, the vibration beside them.

They are seen from axes that turn with the rotor: weights stand still where they balance.  Stops, if
there are any, are seen beside them in axes that do not turn.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.animation import FFMpegWriter, FuncAnimation, PillowWriter
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from ...models.arrays import Array, Complex
from ...models.race import path
from ...models.readable import brief
from ...models.weights import Lobes
from ..errors import UserError
from ..output.files import movie_format, write_whole
from ..output.picture import GREY, colour, unbroken
from ..output.plot import harmless, metres
from ..scene import Scene
from ..scene.balancer import Liquid, Ring, WeightBalancer
from ..units import si_number
from .motion import Motion
from .movie_stops import draw_stop, stop_views

if TYPE_CHECKING:
    from ..output.workers import Progress

FRAMES_PER_SECOND = 20
SHORTEST, LONGEST = 0.5, 600.0  # s, of a movie
REACH = 0.45  # of the radius: the largest displacement as it is drawn
_RESOLUTION = 80  # dots an inch
_NOMINAL = 0.09  # of the radius: a weight that is a point
_TRAIL = np.linspace(-1.0, 0.0, 41)  # revolutions: the way that is shown
_HEAVY = 0.55  # of the radius: where the unbalance is marked
_LOBES = 0.08  # of the radius: smaller lobes are drawn larger, up to this
_TURN = np.linspace(0.0, math.tau, 361)


@dataclass(frozen=True, eq=False)
class View:
    """A balancer as the frames show it, in axes that turn with the rotor.

    Attributes:
        radius: of track or chamber [m].
        radii: of the weights (N,) [m].
        trail: (F, t) displacement of its plane over the last revolution, magnified [m].
        weights: (N, F) places [m].
        race: (c,) path of the weights, or wall, about its middle [m]; lobes are magnified.
        lobes: how often they are; 1 of a round one.
        heavy: (frames,) direction of the unbalance in the rotor [rad]; NaN where there is no one.
    """

    label: str
    radius: float
    radii: Array
    trail: Complex
    weights: Complex
    heavy: Array
    race: Complex
    lobes: float


def refuse_unwritable(path: Path) -> None:
    """Refuse a movie that cannot be made here.

    Raises:
        UserError: the format is unknown, or there is no ffmpeg for an mp4.
    """
    if movie_format(path) == "mp4" and not FFMpegWriter.isAvailable():
        raise UserError(f"{path}: an mp4 needs ffmpeg, and there is none: take .gif or .webp")


def refuse_unseen(scene: Scene, seconds: float) -> None:
    """Refuse a movie that would show nothing.

    Raises:
        UserError: there is no balancer, or the movie is too short or too long.
    """
    if not scene.balancer:
        raise UserError(f"{scene.heading}: has no balancer to show")
    seconds = si_number(seconds, "s", "length of the movie =")
    if not SHORTEST <= seconds <= LONGEST:
        raise UserError(
            f"length of the movie = {seconds:g} s: must be {SHORTEST:g} to {LONGEST:g} s"
        )


def write_movie(
    motion: Motion, path: Path, seconds: float = 8.0, progress: Progress | None = None
) -> Path:
    """Write the whole run as a movie of so many seconds, completely or not at all.

    Raises:
        UserError: it cannot be written, or the scene has no balancer.
    """
    refuse_unwritable(path)
    refuse_unseen(motion.scene, seconds)
    count = round(seconds * FRAMES_PER_SECOND)
    times = np.linspace(motion.time[0], motion.time[-1], count)
    figure, move = _stage(motion, times, *views(motion, times))
    movie = FuncAnimation(figure, move, frames=count)
    kind = FFMpegWriter if movie_format(path) == "mp4" else PillowWriter

    def report(frame: int, _count: int) -> None:
        if progress:
            progress((frame + 1) / count)

    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / f"movie{path.suffix.lower()}"
        writer = kind(fps=FRAMES_PER_SECOND)
        movie.save(made, writer, dpi=_RESOLUTION, progress_callback=report)
        with write_whole(path, "wb") as stream:
            stream.write(made.read_bytes())
    return path


def views(motion: Motion, times: Array) -> tuple[float, list[View]]:
    """How often displacements are magnified, and every balancer at the times (F,)."""
    scene = motion.scene
    planes = scene.assembly().rotor.planes
    z = motion.displacement[:, 0] + 1j * motion.displacement[:, 1]
    # straight between records in the rotor, where all of it is slow
    steady = (z * np.exp(-1j * motion.angle)[:, None]) @ planes.T
    angle = np.interp(times, motion.time, motion.angle)
    past = angle[:, None] + math.tau * _TRAIL
    paths = [np.interp(past, motion.angle, column) for column in steady.T]
    factor = _factor(scene, steady.T)
    angles, seen = {}, []
    if any(isinstance(b, WeightBalancer) for b in scene.balancer):
        angles = {b.label: each for b, each in motion.weights()}
    light = motion.light_side(times)
    for balancer in scene.balancer:
        trail = factor * paths[balancer.at - 1]
        radius, places, size = _radius(balancer), np.zeros((0, len(times)), complex), np.zeros(0)
        lobes: tuple[Lobes, ...] = ()
        off, times_lobes = 0j, 1.0
        if isinstance(balancer, WeightBalancer):
            size = np.array([one.radius or _NOMINAL * radius for one in balancer.device.each])
            at = [np.interp(times, motion.time, angle) for angle in angles[balancer.label]]
            off = factor * complex(balancer.track_offset_xi, balancer.track_offset_eta)
            lobes, times_lobes = _magnified(balancer)
            arm = path(radius, lobes, np.array(at))[0]
            places = trail[:, -1] + off + arm * np.exp(1j * np.array(at))
        race = off + path(radius, lobes, _TURN)[0] * np.exp(1j * _TURN)
        heavy = light + math.pi
        seen.append(View(balancer.label, radius, size, trail, places, heavy, race, times_lobes))
    return factor, seen


def _magnified(balancer: WeightBalancer) -> tuple[tuple[Lobes, ...], float]:
    """Lobes of a race as they are drawn, and how often they are magnified."""
    built = [one.build() for one in balancer.race]
    largest = math.fsum(abs(one.amplitude) for one in built)
    times = max(1.0, _LOBES * balancer.track_radius / largest) if largest else 1.0
    return tuple(replace(one, amplitude=times * one.amplitude) for one in built), times


def _radius(balancer: WeightBalancer | Liquid | Ring) -> float:
    """Of the track, the chamber or the ring's wall [m]."""
    if isinstance(balancer, WeightBalancer):
        return balancer.track_radius
    return balancer.wall_radius if isinstance(balancer, Ring) else balancer.chamber_radius


def _factor(scene: Scene, moved: Any) -> float:
    """1, 2 or 5 times a power of ten that has the largest displacement fill `REACH`."""
    largest = [(_radius(b), float(np.abs(moved[b.at - 1]).max())) for b in scene.balancer]
    wanted = min(REACH * radius / max(size, 1e-12 * radius) for radius, size in largest)
    power = 10.0 ** math.floor(math.log10(wanted))
    return power * max(step for step in (1, 2, 5) if step * power <= wanted * (1.0 + 1e-9))


def _stage(
    motion: Motion, times: Array, factor: float, seen: list[View]
) -> tuple[Figure, Callable[[int], None]]:
    """The figure, and what moves it to a frame."""
    stops = stop_views(motion, times)
    columns = len(seen) + len(stops)
    figure = Figure(figsize=(3.6 * columns + 4.2, 4.0), layout="constrained")
    figure.suptitle(
        f"{motion.scene.heading}\ndisplacement magnified {factor:g} times", fontsize="medium"
    )
    grid = figure.add_gridspec(2, columns + 1, width_ratios=[*([3.6] * columns), 4.2])
    canvases = [figure.add_subplot(grid[:, k]) for k in range(columns)]
    moves = [_actor(*each) for each in zip(canvases, seen, strict=False)]
    moves += [draw_stop(*each) for each in zip(canvases[len(seen) :], stops, strict=True)]
    moves.append(_curves(motion, times, *(figure.add_subplot(grid[k, -1]) for k in range(2))))
    harmless(figure)
    moves[0](0)
    figure.draw_without_rendering()
    figure.set_layout_engine("none")  # laid out once: nothing jumps

    def move(frame: int) -> None:
        for each in moves:
            each(frame)

    return figure, move


def _actor(canvas: Any, view: View) -> Callable[[int], None]:
    """Draws a balancer, and moves it."""
    reach = 1.1 * view.radius + np.abs(view.trail).max() + view.radii.max(initial=0.0)
    canvas.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal", xticks=[], yticks=[])
    title = f"{view.label}, turning with the rotor"
    if view.lobes > 1.0:
        title += f"\nlobes magnified {brief(view.lobes)} times"
    canvas.set_title(title, fontsize="small")
    canvas.plot(view.race.real, view.race.imag, ":", color=GREY, lw=1.0)
    canvas.plot(0.0, 0.0, "+", color=GREY, ms=9)
    (ring,) = canvas.plot([], [], color="black", lw=1.6)
    (trail,) = canvas.plot([], [], color=colour(1), lw=1.0)
    (centre,) = canvas.plot([], [], "o", color=colour(1), ms=5)
    (spoke,) = canvas.plot([], [], color="black", lw=2.0, marker="s", ms=7, markevery=[1])
    name = canvas.text(0.0, 0.0, "unbalance", fontsize="x-small", ha="center", va="top")
    balls = [
        Circle((0, 0), radius, color=colour(k), zorder=3) for k, radius in enumerate(view.radii)
    ]
    for ball in balls:
        canvas.add_patch(ball)

    def move(frame: int) -> None:
        past = view.trail[frame]
        at = past[-1]
        ring.set_data((at + view.race).real, (at + view.race).imag)
        trail.set_data(past.real, past.imag)
        centre.set_data([at.real], [at.imag])
        name.set_visible(heavy := bool(np.isfinite(view.heavy[frame])))
        tip = at + _HEAVY * view.radius * np.exp(1j * view.heavy[frame])
        spoke.set_data([at.real, tip.real], [at.imag, tip.imag])
        if heavy:
            name.set_position((tip.real, tip.imag - 0.07 * view.radius))
        for ball, place in zip(balls, view.weights[:, frame], strict=True):
            ball.center = (place.real, place.imag)

    return move


def _curves(motion: Motion, times: Array, above: Any, below: Any) -> Callable[[int], None]:
    """Vibration over time, and the weights' angles or the speed below; a line moves through."""
    size = np.hypot(motion.displacement[:, 0], motion.displacement[:, 1])
    factor, unit = metres(float(size.max()))
    for j in range(size.shape[1]):
        above.plot(motion.time, size[:, j] * factor, color="black", lw=0.8, alpha=1.0 / (1 + j))
    from_sag = " from the sag" if motion.scene.operation.gravity else ""
    above.set_ylabel(f"vibration{from_sag} [{unit}]", fontsize="small")
    above.tick_params(labelbottom=False)
    weights = [b for b in motion.scene.balancer if isinstance(b, WeightBalancer)]
    if weights:
        for k, angle in enumerate(next(motion.weights())[1]):
            below.plot(motion.time, unbroken(np.degrees(angle)), color=colour(k), lw=1.2)
        below.set(ylim=(-5.0, 365.0), yticks=range(0, 361, 90))
        below.set_ylabel(f"{weights[0].label}, angle [deg]", fontsize="small")
    else:
        below.plot(motion.time, motion.speed, color="black", lw=1.0)
        below.set_ylabel("speed [rad/s]", fontsize="small")
    below.set_xlabel("time [s]", fontsize="small")
    now = [each.axvline(times[0], color=colour(1), lw=1.2) for each in (above, below)]
    speed = np.interp(times, motion.time, motion.speed)

    def move(frame: int) -> None:
        for line in now:
            line.set_xdata([times[frame], times[frame]])
        above.set_title(f"t = {times[frame]:.2f} s, {speed[frame]:.0f} rad/s", fontsize="small")

    for each in (above, below):
        each.grid(alpha=0.3)
        each.tick_params(labelsize="small")
    return move
