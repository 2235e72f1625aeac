"""Weights chosen, tolerances drawn, and values found from measurements."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .of_scene import OfScene

if TYPE_CHECKING:
    from autobalancer.harness.balancing.cycles import BalancingReport
    from autobalancer.harness.design.choices import Design
    from autobalancer.harness.design.fitting import Fitting
    from autobalancer.harness.fit.study import Fit
    from autobalancer.harness.output.workers import Progress, Workers
    from autobalancer.harness.scatter.study import Scatter


class DesignMethods(OfScene):
    """See `methods.Methods`."""

    def design(
        self,
        unbalance: float | str | None = None,
        *,
        race: float | str | None = None,
        width: float | str | None = None,
        clearance: float | str = 0.0,
        material: str | float = "steel",
        reserve: float = 1.0,
        start: str = "run-up",
        run_up: float | str | None = None,
        drag: float | str | None = None,
        oil: str | None = None,
        standard: bool = False,
        n: int = 40,
        most: int = 8,
        workers: Workers = 1,
        progress: Progress | None = None,
    ) -> Fitting:
        """Balls or rollers to fit, if any: number and size, judged from the real start.

        Args:
            unbalance: the largest one [kg m], or "LOW..HIGH" with a unit; default: the scene's.
            race: radius of the race [m]; default: that of the scene's weights.
            width: space along the axis [m]; default: the diameter of the scene's weights.
            clearance: of the width that stays free [m].
            material: a name such as "brass", or a density [kg/m^3].
            reserve: capacity over the unbalance that a candidate must have.
            start: run-up, rest, or turning (the friendliest).
            run_up: time from standstill to full speed [s]; default: the scene's own, else a slow
                one that the answer states.
            drag: of every weight [N s/m], or "LOW..HIGH"; default: that of the scene's weights in
                proportion to the mass, else from the oil's bound to ten times it.
            oil: such as "ISO VG 46".
            standard: only standard diameters of balls.
            n: random starts of every candidate, at each end of drag and unbalance.
            most: largest number of weights.

        Returns:
            Every candidate with the share of starts that balance; `words()`.

        Raises:
            UserError: a value is wrong, or two exclude each other.
            SceneError: the scene is no planar rotor at constant speed or with a run-up, or its
                race is not known.

        >>> drum = ab.load("goncharov_balls").replace({"run.revolutions": 20})
        >>> found = drum.design("2..5 g m", race="0.1 m", width="20 mm", n=2, most=2)
        >>> sorted({one.candidate.count for one in found.trials})
        [2]
        """
        from autobalancer.harness.design.study import design
        from autobalancer.harness.errors import refuse_count
        from autobalancer.harness.scene.balancer import MOST_WEIGHTS

        refuse_count(most, "most", 2, MOST_WEIGHTS)
        values: dict[str, Any] = {"race": race, "width": width, "clearance": clearance}
        values |= {"material": material}
        values |= {"reserve": reserve, "start": start, "run_up": run_up, "drag": drag, "oil": oil}
        options: dict[str, Any] = {"workers": workers, "progress": progress}
        options |= {"standard": standard, "starts": n, "counts": range(2, most + 1)}
        return design(self._scene, unbalance, **values, **options)

    def settling(
        self,
        unbalance: float | str | None = None,
        *,
        race: float | str | None = None,
        width: float | str | None = None,
        material: str | float = "steel",
        reserve: float = 1.0,
        starts: int = 200,
        most: int = 8,
        workers: Workers = 1,
        progress: Progress | None = None,
    ) -> Design:
        """Settling times over the number of weights, which start turning (Goncharov 2017).

        Each number has the size of largest capacity that fits.  `design` recommends weights.

        Args:
            unbalance: the largest one [kg m], or "LOW..HIGH" with a unit; default: the scene's.
            race: radius of the race [m]; default: that of the scene's weights.
            width: space along the axis [m]; default: the diameter of the scene's weights.
            material: a name such as "brass", or a density [kg/m^3].
            reserve: capacity over the unbalance that a choice must have.
            starts: random starts of every choice, from which settling times are measured.
            most: largest number of weights.

        Raises:
            UserError: a value is wrong.
            SceneError: the scene is no planar rotor at constant speed without gravity, or its
                race is not known.
            SimulationError: a run fails.

        >>> drum = ab.load("goncharov_balls").replace({"run.revolutions": 20})
        >>> found = drum.settling("2..5 g m", race="0.1 m", width="20 mm", starts=6, most=3)
        >>> [choice.count for choice in found.choices]
        [2, 3]
        """
        from autobalancer.harness.design.choices import design
        from autobalancer.harness.design.space import read_space
        from autobalancer.harness.errors import refuse_count
        from autobalancer.harness.scene.balancer import MOST_WEIGHTS

        refuse_count(most, "most", 2, MOST_WEIGHTS)
        refuse_count(starts, "starts")
        space = read_space(unbalance, race, width, material, reserve)
        options: dict[str, Any] = {"workers": workers, "progress": progress}
        return design(self._scene, counts=range(2, most + 1), starts=starts, **space, **options)

    def scatter(
        self,
        vary: Mapping[str, Any] | Iterable[str],
        n: int = 10_000,
        *,
        seed: int = 1,
        workers: Workers = 1,
        progress: Progress | None = None,
        store: str | Path | None = None,
    ) -> Scatter:
        """Machines whose values scatter within tolerances, each run in C.

        Args:
            vary: a distribution for every path: text such as "normal(0.2,10%)", or one of
                `scipy.stats` with its parameters; or texts "PATH=NAME(NUMBERS)".
            n: machines.
            seed: the same seed draws the same machines.
            store: as in `map`.

        Returns:
            Residual amplitudes [m], ISO 21940-11 grades [mm/s] and more, (n,) each.

        Raises:
            UserError: a path is unknown or cannot vary, or a distribution is wrong.
            SimulationError: every machine has failed.

        >>> short = ab.load("two_balls").replace({"run.revolutions": 5})
        >>> found = short.scatter({"weights.drag": "normal(0.06,10%)"}, n=8)
        >>> found.residual.shape, list(found.to_pandas())[0]
        ((8,), 'weights.drag')
        """
        from autobalancer.harness.scatter.study import scatter
        from autobalancer.harness.scatter.vary import variations

        options: dict[str, Any] = {"workers": workers, "progress": progress, "store": store}
        return scatter(self._scene, variations(vary, self._scene), n, seed=seed, **options)

    def fit(
        self,
        measured: str | Path,
        free: str | Sequence[str],
        *,
        limits: Sequence[str] = (),
        priors: Sequence[str] = (),
        scatter: float = 0.1,
        harmonic: bool = False,
        starts: int = 1,
        progress: Progress | None = None,
    ) -> Fit:
        """Values of the scene from measured amplitudes, by least squares.

        Args:
            measured: a CSV file with heads `speed [rpm]`, paths of values that were set, and
                `amplitude [mm]`, `residual`, `rotor.station[1].residual`, or amplitude and phase
                of one direction, such as `rotor.x.amplitude [um pp]` and
                `rotor.x.phase_lag [deg]`.
            free: paths to find, with commas or as a list; "PATH=PATH" is one value for both.
            limits: "PATH=LOW:HIGH", between which a value stays.
            priors: "PATH=DEVIATION", how far off the start may be.
            scatter: standard deviation of a difference, against which priors are weighed.
            harmonic: search by harmonic balance alone; runs judge the result.
            starts: of harmonic balance.

        Returns:
            Values with 95 % intervals, or none where the residuals are systematic; `scene` is the
            scene with them.

        Raises:
            UserError: the file or a path is wrong, or there are too few measurements.
            SimulationError: a run has failed.

        >>> rotor = ab.load("two_balls").without_balancers()
        >>> rows = ["speed [rad/s],amplitude [mm]", "0.5,0.5", "1.5,2.0", "2.5,1.2"]
        >>> text = open("measured.csv", "w").write("\\n".join(rows))
        >>> found = rotor.fit("measured.csv", "rotor.unbalance", harmonic=True)
        >>> found.scene.rotor.unbalance == float(found.values[0]), len(found.to_pandas())
        (True, 1)
        """
        from autobalancer.harness.fit.measured import read_measured
        from autobalancer.harness.fit.parameters import parse_free
        from autobalancer.harness.fit.study import fit

        paths = [free] if isinstance(free, str) else free
        parameters = parse_free(paths, self._scene, limits, priors, scatter)
        data = read_measured(Path(measured), self._scene)
        options: dict[str, Any] = {"harmonic": harmonic, "starts": starts, "progress": progress}
        return fit(self._scene, data, parameters, **options)

    def balance(self, *, progress: Progress | None = None) -> BalancingReport:
        """Balance the rotor on the virtual machine of [balancing] (Polushkin 2016, ISO 21940-11).

        Returns:
            Influence coefficients (supports, planes) [1/kg], and every run of the machine.

        Raises:
            SceneError: there is no table [balancing], or the planes cannot be told apart.
            SimulationError: the rotor does not run steadily.

        >>> ab.load("balancing_machine").balance().met
        True
        """
        from autobalancer.harness.balancing.cycles import balance

        return balance(self._scene, progress=progress)
