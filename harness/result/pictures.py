"""The pictures of a result; drawing libraries are loaded only to draw."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, overload

from ..errors import UserError
from .mixed import Mixed

if TYPE_CHECKING:
    from ..output.picture import Picture
    from ..output.workers import Progress
    from ..scene import Scene
    from .motion import Motion


class Pictures(Mixed):
    """What a result can draw.

    A `Picture` is saved by `save(path)` (png, svg, pdf) and shows itself in a notebook.  Each
    raises `UserError` where the scene has nothing of the kind, or what it needs was not recorded.
    """

    @overload
    def plot(self) -> Picture: ...

    @overload
    def plot(self, path: str | Path) -> Path: ...

    def plot(self, path: str | Path | None = None) -> Picture | Path:
        """Everything recorded against time; drawn into a picture file where a path is given.

        Raises:
            UserError: the file cannot be written, or nothing that can be drawn was recorded.

        >>> run = ab.load("two_balls").run()
        >>> run.plot("history.png").name
        'history.png'
        """
        from .over_time import history

        judged = self.summary() if self.scene else None
        title = self.scene_title or "run"
        try:
            picture = history(
                self.time, self.signals, self.signal_units, title, judged, self.sag(), self.scene
            )
            return picture if path is None else picture.save(path)
        except UserError as error:
            if path is None or str(path) in str(error):
                raise
            raise UserError(f"{path}: {error}") from error

    def plot_weights(self) -> Picture:
        """Displacement of every station and angles of all weights against time.

        >>> run = ab.load("two_balls").run()
        >>> run.plot_weights().save("weights.png").name
        'weights.png'
        """
        from .over_time import motion_with_weights

        return motion_with_weights(self._motion(), self.summary())

    def plot_compared(self) -> Picture:
        """Vibration with balancers and without, against time.

        Raises:
            UserError: there are none, or the rotor without them cannot run.

        >>> run = ab.load("two_balls").run()
        >>> run.plot_compared().save("compared.png").name
        'compared.png'
        """
        from .compared import compare

        return compare(self._scene(), self.time, self.signals)

    def plot_waterfall(self, signal: str | None = None) -> Picture:
        """Spectra of a signal over the speed; by default of the largest displacement.

        >>> run = ab.load("two_balls").run()
        >>> run.plot_waterfall("rotor.x").save("waterfall.png").name
        'waterfall.png'
        """
        from .over_speed import waterfall

        return waterfall(self._motion(), signal)

    def plot_polar(self) -> Picture:
        """Synchronous amplitude and phase as polar (Nyquist) curves over the speed.

        >>> run = ab.load("two_balls").run()
        >>> run.plot_polar().save("polar.png").name
        'polar.png'
        """
        from .over_speed import polar

        return polar(self._motion())

    def plot_orbits(self, revolutions: float = 2.0) -> Picture:
        """Orbits along the shaft in three dimensions, over the last revolutions.

        >>> run = ab.load("two_balls").run()
        >>> run.plot_orbits(revolutions=1.0).save("orbits.png").name
        'orbits.png'
        """
        from .in_space import orbits

        return orbits(self._motion(), revolutions)

    def movie(
        self,
        path: str | Path,
        seconds: float = 8.0,
        progress: Progress | None = None,
    ) -> Path:
        """Write the run as a moving picture of so many seconds: gif, webp, or mp4 by ffmpeg.

        Args:
            progress: called with the finished fraction.

        Raises:
            UserError: it cannot be made here or written, or there is no balancer to show.

        >>> run = ab.load("two_balls").run()
        >>> run.movie("run.gif", seconds=0.5).name
        'run.gif'
        """
        from .movie import write_movie

        return write_movie(self._motion(), Path(path), seconds, progress)

    def _motion(self) -> Motion:
        from .motion import Motion

        return Motion(self._scene(), self.time, self)

    def _scene(self) -> Scene:
        if self.scene is None:
            raise UserError("the result has no scene, which this picture requires")
        return self.scene
