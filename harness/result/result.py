"""What a co-simulation gives back: recorded signals, the facts of the run, and checks on them."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import UserError
from ..scene.messages import did_you_mean
from ..units import si_number
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
class Result(Pictures):
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

    def assert_close(self, name: str, reference: ArrayLike, relative: float) -> None:
        """Fail unless a signal stays within `relative` of the reference's largest magnitude.

        Args:
            name: recorded signal.
            reference: (T,) values at `time`, or one number.

        >>> run = ab.load("two_balls").run()
        >>> run.assert_close("weights.moment_xi", run["weights.moment_xi"], 1e-9)
        """
        __tracebackhide__ = True  # pytest then shows the caller's line
        measured = self[name]
        expected = np.broadcast_to(np.asarray(reference, float), measured.shape)
        difference = np.abs(measured - expected)
        bound = relative * float(np.max(np.abs(expected)))
        bad = ~(difference <= bound)  # written so that NaN fails
        if bad.any():
            k = _worst(difference)
            raise AssertionError(
                f"{name} differs by {difference[k]:.3g} at t = {self.time[k]:.6g} s: is "
                f"{measured[k]:.9g}, expected {expected[k]:.9g}; allowed {bound:.3g} = "
                f"{relative:g} of the largest expected value ({int(bad.sum())} of {len(bad)} "
                f"points off) {self._label}"
            )

    def assert_bounded(self, name: str, limit: float | str, *, after: float | str = 0.0) -> None:
        """Fail unless |signal| <= limit at every point from time `after` [s] on.

        Args:
            limit: in the signal's SI unit, or text with a unit such as "0.5 mm".

        >>> run = ab.load("two_balls").run()
        >>> run.assert_bounded("rotor.x", "1 mm", after="30 s")
        """
        __tracebackhide__ = True  # pytest then shows the caller's line
        limit = si_number(limit, self.signal_units.get(name, ""), f"{name}: limit")
        after = si_number(after, "s", "after")
        late = self._from(after)
        measured = np.abs(self[name][late])
        bad = ~(measured <= limit)
        if bad.any():
            k, first = _worst(measured), int(np.argmax(bad))
            times = self.time[late]
            raise AssertionError(
                f"|{name}| reaches {measured[k]:.6g} at t = {times[k]:.6g} s, limit {limit:g}; "
                f"exceeded first at t = {times[first]:.6g} s {self._label}"
            )

    def assert_balanced(self, below: float | str, *, last: float = 0.1) -> None:
        """Fail unless the rotor's displacement ends below a limit.

        Args:
            below: allowed largest sqrt(x^2 + y^2) of every recorded station [m], under gravity
                from the sag, or text with a unit such as "10 um".
            last: judged over this last fraction of the run.

        >>> run = ab.load("two_balls").run()
        >>> run.assert_balanced(below="0.1 mm")
        """
        from .sag import from_sag

        __tracebackhide__ = True  # pytest then shows the caller's line
        below = si_number(below, "m", "below")
        if not 0.0 < last <= 1.0:
            raise UserError(f"assert_balanced: last = {last:g}: must be above 0 and at most 1")
        stations = [
            n[: -len("x")] for n in self.signals if n.startswith("rotor.") and n[-2:] == ".x"
        ]
        stations = [base for base in stations if f"{base}y" in self.signals and "plane" not in base]
        if not stations:
            self["rotor.x"], self["rotor.y"]  # raises, and says what was recorded
        late = self._from(self.time[-1] - last * (self.time[-1] - self.time[0]))
        moved = from_sag(self.signals, self.sag())
        for base in stations:
            swing = np.hypot(moved[f"{base}x"][late], moved[f"{base}y"][late])
            if not np.all(swing <= below):
                k = _worst(swing)
                raise AssertionError(
                    f"not balanced: {base[:-1]} still moves {swing[k]:.6g} m (0-peak) at "
                    f"t = {self.time[late][k]:.6g} s, expected at most {below:g} m over the last "
                    f"{last:.0%} of {self.time[-1]:.6g} s{self._moments()} {self._label}"
                )

    def assert_settled(self, within: float | str) -> None:
        """Fail unless the rotor is balanced from a time on, as `summary` judges it.

        Args:
            within: latest time from which on the vibration may be less than 5 % of that without
                balancers [s], or text with a unit such as "3 s".

        Raises:
            UserError: the result does not know its scene.

        >>> run = ab.load("two_balls").run()
        >>> run.assert_settled(within="30 s")
        """
        __tracebackhide__ = True  # pytest then shows the caller's line
        latest, found = si_number(within, "s", "within"), self.summary()
        if found.after is None or not found.after <= latest:
            raise AssertionError(f"not settled within {latest:g} s: {found} {self._label}")

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

    def _moments(self) -> str:
        names = [n.removesuffix(".moment_xi") for n in self.signals if n.endswith(".moment_xi")]
        said = [
            f"; weights of {n!r} hold {self.residual_moment(n)[-1]:.6g} kg m"
            for n in names
            if f"{n}.moment_eta" in self.signals
        ]
        return "".join(said)

    @property
    def _label(self) -> str:
        """What the message of a failed check ends with: which scene, and whether to believe it."""
        if self.error_known:
            return f"[{self.scene_title}]"
        return f"[{self.scene_title}]; the error of this run is not known: {self.unknown_error}"

    def _from(self, after: float) -> NDArray[np.bool_]:
        late = self.time >= after
        if not late.any():
            raise UserError(f"the run ends at t = {self.time[-1]:g} s, before t = {after:g} s")
        return late


def _worst(values: NDArray) -> int:
    """Index of the largest value, or of the first that is not a number."""
    bad = np.isnan(values)
    return int(np.argmax(bad)) if bad.any() else int(np.argmax(values))
