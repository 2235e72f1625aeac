"""The pictures of a result; drawing libraries are loaded only to draw."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal, overload

import numpy as np
from numpy.typing import NDArray

from ..errors import UserError

if TYPE_CHECKING:
    from ..output.picture import Picture
    from ..output.workers import Progress
    from ..scene import Scene
    from .pictures.motion import Motion
    from .summary import Summary

    class _Result:
        time: NDArray[np.float64]
        signals: dict[str, NDArray[np.float64]]
        signal_units: dict[str, str]
        scene_title: str
        scene: Scene | None

        def __getitem__(self, name: str) -> NDArray[np.float64]: ...

        def summary(self) -> Summary: ...
else:
    _Result = object


class Pictures(_Result):
    """What a result can draw.

    A `Picture` is saved by `save(path)` (png, svg, pdf) and shows itself in a notebook.  Each
    raises `UserError` where the scene has nothing of the kind, or what it needs was not recorded.
    """

    @overload
    def plot(self) -> Picture: ...

    @overload
    def plot(self, path: str | Path) -> Path: ...

    def plot(self, path: str | Path | None = None) -> Picture | Path:
        """The time history as a `Picture`, or drawn into a picture file where a path is given.

        Raises:
            UserError: the file cannot be written, or nothing that can be drawn was recorded.

        >>> run = ab.load("two_balls").run()
        >>> run.plot("history.png").name
        'history.png'
        """
        if path is None:
            return self.plot_history()
        try:
            return self.plot_history().save(path)
        except UserError as error:
            said = str(error)
            raise UserError(said if str(path) in said else f"{path}: {said}") from error

    def plot_history(self) -> Picture:
        """Everything recorded against time.

        >>> run = ab.load("two_balls").run()
        >>> run.plot_history().save("history.svg").name
        'history.svg'
        """
        from .pictures.over_time import history

        judged = self.summary() if self.scene else None
        title = self.scene_title or "run"
        return history(self.time, self.signals, self.signal_units, title, judged)

    def plot_weights(self) -> Picture:
        """Displacement of every station and angles of all weights against time.

        >>> run = ab.load("two_balls").run()
        >>> run.plot_weights().save("weights.png").name
        'weights.png'
        """
        from .pictures.over_time import motion_with_weights

        return motion_with_weights(self._motion(), self.summary())

    def plot_weights_over_speed(self) -> Picture:
        """Angles of all weights in the rotor against speed, over time where that is constant.

        >>> run = ab.load("two_balls").run()
        >>> run.plot_weights_over_speed().save("angles.png").name
        'angles.png'
        """
        from .pictures.over_speed import weights

        return weights(self._motion())

    def plot_waterfall(self, signal: str | None = None) -> Picture:
        """Spectra of a signal over the speed; by default of the largest displacement.

        >>> run = ab.load("two_balls").run()
        >>> run.plot_waterfall("rotor.x").save("waterfall.png").name
        'waterfall.png'
        """
        from .pictures.over_speed import waterfall

        return waterfall(self._motion(), signal)

    def plot_orders(self, orders: Sequence[float] = (1.0, 2.0, 3.0)) -> Picture:
        """Amplitude of the stations' orders (0.5, 1, ...) over the speed, phase of the first.

        >>> run = ab.load("two_balls").run()
        >>> run.plot_orders([1.0, 2.0]).save("orders.png").name
        'orders.png'
        """
        from .pictures.over_speed import orders as picture

        return picture(self._motion(), orders)

    def plot_polar(self) -> Picture:
        """Synchronous amplitude and phase as polar (Nyquist) curves over the speed.

        >>> run = ab.load("two_balls").run()
        >>> run.plot_polar().save("polar.png").name
        'polar.png'
        """
        from .pictures.over_speed import polar

        return polar(self._motion())

    def plot_orbits(self, revolutions: float = 2.0) -> Picture:
        """Orbits along the shaft in three dimensions, over the last revolutions.

        >>> run = ab.load("two_balls").run()
        >>> run.plot_orbits(revolutions=1.0).save("orbits.png").name
        'orbits.png'
        """
        from .pictures.in_space import orbits

        return orbits(self._motion(), revolutions)

    def plot_modes(self, speed: float | None = None) -> Picture:
        """Mode shapes of the rotor alone with their whirl, at a speed [rad/s]: the scene's.

        >>> run = ab.load("two_balls").run()
        >>> run.plot_modes(speed=1.5).save("modes.png").name
        'modes.png'
        """
        from .pictures.in_space import mode_shapes

        return mode_shapes(self._scene(), speed)

    def plot_settling(self, points: int = 21) -> Picture:
        """Settling time over the angles at which the first two weights start, `points` of each.

        The scene is run `points`^2 times, by the coupling in C.

        >>> run = ab.load("two_balls").run()
        >>> run.plot_settling(points=3).save("settling.png").name
        'settling.png'
        """
        from .many import cosimulate_many
        from .pictures.settling import first_weights, settling_map
        from .schedule import end_time

        if points < 2:
            raise UserError(f"points = {points}: must be at least 2")
        scene = self._scene()
        names = first_weights(scene)
        angles = np.linspace(0.0, math.tau, points)
        upward, across = np.meshgrid(angles, angles, indexing="ij")
        table: Mapping[str, NDArray] = dict(
            zip(names, (across.ravel(), upward.ravel()), strict=True)
        )
        found = cosimulate_many(scene, table, results=("settling_time",))
        failed = sum(map(bool, found["failure"]))
        seconds = found["settling_time"].reshape(points, points)
        return settling_map(scene, names, angles, seconds, failed, end_time(scene))

    def movie(
        self,
        path: str | Path,
        axes: Literal["rotor", "fixed"] = "rotor",
        seconds: float = 8.0,
        progress: Progress | None = None,
    ) -> Path:
        """Write the run as a moving picture of so many seconds: gif, webp, or mp4 by ffmpeg.

        Args:
            axes: that turn with the rotor, or stand still.
            progress: called with the finished fraction.

        Raises:
            UserError: it cannot be made here or written, or frames are too few for fixed axes.

        >>> run = ab.load("two_balls").run()
        >>> run.movie("run.gif", seconds=0.5).name
        'run.gif'
        """
        from .pictures.movie import write_movie

        return write_movie(self._motion(), Path(path), axes, seconds, progress)

    def _motion(self) -> Motion:
        from .pictures.motion import Motion

        return Motion(self._scene(), self.time, self)

    def _scene(self) -> Scene:
        if self.scene is None:
            raise UserError("the result does not know its scene, which this picture needs")
        return self.scene
