"""What a test asks of a run: signals that are close, bounded, balanced or settled."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import UserError
from ..units import si_number
from .mixed import Mixed


class Assertions(Mixed):
    """Checks of a result that fail with what is wrong, at the line of the test."""

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
        expected = self._expected(reference, measured.shape)
        relative = si_number(relative, "", "assert_close: relative =")
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
        last = si_number(last, "", "assert_balanced: last =")
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
                    f"{100.0 * last:.0f} % of {self.time[-1]:.6g} s{self._moments()} {self._label}"
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

    def _moments(self) -> str:
        names = [n.removesuffix(".moment_xi") for n in self.signals if n.endswith(".moment_xi")]
        said = [
            f"; weights of {n!r} hold {self.residual_moment(n)[-1]:.6g} kg m"
            for n in names
            if f"{n}.moment_eta" in self.signals
        ]
        return "".join(said)

    def _expected(self, reference: ArrayLike, shape: tuple[int, ...]) -> NDArray[np.float64]:
        try:
            given = np.asarray(reference, float)
            return np.broadcast_to(given, shape)
        except (TypeError, ValueError):
            raise UserError(
                f"assert_close: reference: must be one number, or {shape[0]}, one at every time"
            ) from None

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
