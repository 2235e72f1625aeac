"""What a co-simulation gives back: recorded signals, the facts of the run, and checks on them."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..errors import UserError
from ..scene.messages import did_you_mean
from .assertions import Assertions
from .pictures import Pictures

if TYPE_CHECKING:
    from pandas import DataFrame
    from xarray import Dataset

    from ..output.table import Sheet
    from ..scene import Scene
    from .verdict import Verdict

Signal = NDArray[np.float64]


class UnknownSignalError(UserError, KeyError):
    """A signal that was not recorded."""

    __str__ = Exception.__str__  # KeyError would print the message in quotes


@dataclass(frozen=True, eq=False)
class Result(Pictures, Assertions):
    """A finished run.

    Attributes:
        scene_title: title of the scene.
        time: (T,) communication points [s].
        signals: (T,) each, by name, in SI units.
        velocity: (T,) each, vibration velocity of every station, rms over the last revolution, such
            as `rotor.velocity_rms` [m/s]; `result[name]` finds it also where it was not recorded.
        seconds: wall-clock time of the run without building and loading [s].
        left_out: what the run did without because the scene does not need it.
        units: names of the FMUs loaded, or of the one file as it is built.
        events: what a reader must know, such as the time at which a float touches the wall.
        steps: communication steps taken.
        passes: steps including corrector passes and rejected ones.
        calls: number of FMI calls by kind; none of one file.
        unconverged: steps in which the coupling loop did not converge.
        series_order: of the power series of a machine that is integrated in one piece; 0: its parts
            were coupled by signals.
        collocated_steps: steps by collocation, which a stiff machine in one piece takes once its
            fast vibrations have died down.
        estimated_error: of the motion, relative to itself: of a run with a tolerance, or where
            given steps are too long for the signals; 0 where nothing is estimated.
        unknown_error: why the error of a run with a tolerance is not known, as where impacts
            amplify what no run resolves; empty where it is.
        counts_before: what signals that count, such as touches of a stop, end with in the run of
            larger errors that this one was compared with; empty where none was.
        signal_units: what each signal is measured in.
        scene: that was run, as it was run.
    """

    scene_title: str
    time: Signal
    signals: dict[str, Signal]
    seconds: float
    left_out: tuple[str, ...] = ()
    units: tuple[str, ...] = ()
    events: tuple[str, ...] = ()
    steps: int = 0
    passes: int = 0
    calls: dict[str, int] = field(default_factory=dict)
    unconverged: int = 0
    series_order: int = 0
    collocated_steps: int = 0
    estimated_error: float = 0.0
    unknown_error: str = ""
    counts_before: dict[str, float] = field(default_factory=dict)
    signal_units: dict[str, str] = field(default_factory=dict)
    scene: Scene | None = field(default=None, repr=False)
    velocity: dict[str, Signal] = field(default_factory=dict, repr=False)

    @property
    def error_known(self) -> bool:
        """Whether `estimated_error` can be relied on.

        >>> ab.load("two_balls").run().error_known
        True
        """
        return not self.unknown_error

    def summary(self) -> Verdict:
        """What the run comes to: balanced or why not, vibration, capacity in use, unbalance left.

        Raises:
            UserError: the result does not know its scene.

        >>> run = ab.load("two_balls").run()
        >>> run.summary().balanced, run.summary().after < 30.0
        (True, True)
        """
        return self._verdict

    @cached_property
    def _verdict(self) -> Verdict:
        from .verdict import judge

        return judge(self, self._scene())

    def sag(self) -> dict[str, Signal]:
        """Displacements of every station at rest under gravity, (T,) each [m], by signal.

        Signals and the files made of them hold the sag; pictures and tables show displacements
        from it.  Empty without gravity, and where the result does not know its scene.

        >>> heavy = {"operation.gravity": 9.81, "run.revolutions": 2}
        >>> run = ab.load("two_balls").replace(heavy).run()
        >>> float(abs(run["rotor.y"][0] - run.sag()["rotor.y"][0]))
        0.0
        """
        from .sag import sag_of

        if self.scene is None:
            return {}
        return sag_of(self.scene, self.time, self.signals.get("motor.speed"))

    def __getitem__(self, name: str) -> Signal:
        """Signal by name, (T,).

        Raises:
            UnknownSignalError: it was not recorded; the message lists what was.
        """
        try:
            return self.velocity[name] if name in self.velocity else self.signals[name]
        except KeyError:
            known = ", ".join(self.signals) or "nothing"
            raise UnknownSignalError(
                f"{name!r} was not recorded{did_you_mean(name, list(self.signals))}; "
                f"recorded: {known}; name it in [run] record or in cosimulate(record=...)"
            ) from None

    def __contains__(self, name: object) -> bool:
        return name in self.signals or name in self.velocity

    def __repr__(self) -> str:
        return (
            f"<Result of {self.scene_title!r}: {len(self.signals)} signals at {len(self.time)} "
            f"times to {self.time[-1]:.4g} s>"
        )

    def _ipython_key_completions_(self) -> list[str]:
        """Names that `run["` is completed to."""
        return list(self.signals)

    def to_csv(self, path: str | Path) -> Path:
        """Write time and signals as CSV, completely or not at all.

        Raises:
            UserError: the file cannot be written.

        >>> run = ab.load("two_balls").run()
        >>> open(run.to_csv("run.csv")).readline()[:15]
        'time,rotor.x,ro'
        """
        from ..output.table import Sheet

        rows = np.column_stack([self.time, *self.signals.values()]).tolist()
        return Sheet(["time", *self.signals], rows).write_csv(Path(path))

    def to_pandas(self) -> DataFrame:
        """A frame of the signals over time [s]; `attrs` hold title and units.

        Raises:
            UserError: pandas is not installed.

        >>> run = ab.load("two_balls").run()
        >>> run.to_pandas()["rotor.x"].size == run.time.size
        True
        """
        from .files import to_pandas

        return to_pandas(self)

    def to_xarray(self) -> Dataset:
        """A data set of the signals over time, each with its unit.

        Raises:
            UserError: xarray is not installed.

        >>> run = ab.load("two_balls").run()
        >>> run.to_xarray()["rotor.x"].attrs["units"]
        'm'
        """
        from .files import to_xarray

        return to_xarray(self)

    def save(self, path: str | Path) -> Path:
        """Write a netCDF file with everything the result holds, completely or not at all.

        Raises:
            UserError: the file cannot be written, or xarray is not installed.

        >>> run = ab.load("two_balls").run()
        >>> ab.Result.load(run.save("run.nc")).scene == run.scene
        True
        """
        from .files import save

        return save(self, Path(path))

    @classmethod
    def load(cls, path: str | Path) -> Result:
        """The result that `save` has written: signals, units, scene and facts.

        Raises:
            UserError: the file cannot be read or holds no result, or xarray is not installed.

        >>> run = ab.load("two_balls").run()
        >>> ab.Result.load(run.save("run.nc"))["rotor.x"].shape == run.time.shape
        True
        """
        from .files import load

        return load(Path(path), cls)

    def _repr_html_(self) -> str:
        from .page import html

        return html(self)

    def forces(self) -> Sheet:
        """Forces at supports and feet, vibration at feet and handles: the part that turns.

        The unbalance to which the transmissibility refers is the rotor's, without weights.

        Raises:
            UserError: the speed changes at the end of the run.

        >>> run = ab.load("two_balls").run()
        >>> [row[0] for row in run.forces().rows]
        ['support[1]']
        """
        from .supports import of_run

        return of_run(self)

    def residual_moment(self, balancer: str) -> Signal:
        """Static moment of a balancer's weights |sum m R e^{i theta}|, (T,) [kg m].

        >>> run = ab.load("two_balls").run()
        >>> round(float(run.residual_moment("weights")[-1]), 4)
        0.025
        """
        return np.hypot(self[f"{balancer}.moment_xi"], self[f"{balancer}.moment_eta"])
