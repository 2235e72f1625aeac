"""What is done with a scene: its methods, one for every command, which calls it.

The work is in the folder of the feature, which is loaded when a method is called.  Numbers are in
SI units; a speed or an amount may be text with a unit, such as "1200 rpm".  `progress` is called
with the finished fraction; `workers` is a number of processes, for which a script needs
`if __name__ == "__main__":`, or an executor.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from autobalancer.harness.stability.methods import DEFAULT_METHODS

if TYPE_CHECKING:
    from autobalancer.harness.accuracy.precision.measure import Precision
    from autobalancer.harness.balancing.cycles import BalancingReport
    from autobalancer.harness.capture.captured import Captured
    from autobalancer.harness.checks.runner import SceneReport
    from autobalancer.harness.design.choices import Design
    from autobalancer.harness.design.fitting import Fitting
    from autobalancer.harness.design.lobes import OutOfRound
    from autobalancer.harness.export.build import Built
    from autobalancer.harness.fit.study import Fit
    from autobalancer.harness.motions.map import MotionsMap
    from autobalancer.harness.motions.outcome import Motions
    from autobalancer.harness.motions.sweep import Sweep
    from autobalancer.harness.output.workers import ItemProgress, Progress, Workers
    from autobalancer.harness.report.page import Written
    from autobalancer.harness.scatter.study import Scatter
    from autobalancer.harness.scene.scene import Scene
    from autobalancer.harness.show.page import Page
    from autobalancer.harness.stability.axis import Axis
    from autobalancer.harness.stability.map import StabilityMap
    from autobalancer.harness.stability.proved_map import ProvedMap
    from autobalancer.harness.stability.run_map import RunMap
    from autobalancer.harness.stability.speeds import Speeds


class Methods:
    """The methods of a scene; its tables `run` and `rotor` are called as well, see `tables`."""

    @property
    def _scene(self) -> Scene:
        scene = cast("Scene", self)
        scene.refuse_guests("this")
        return scene

    def speeds(
        self,
        low: float | str,
        high: float | str,
        methods: str | Iterable[str] = DEFAULT_METHODS,
        *,
        narrowest: float | None = None,
        within: str = "",
        progress: Progress | None = None,
    ) -> Speeds:
        """Speeds at which balancing begins or ends, by independent methods (Filimonikhina 2017).

        Args:
            low, high: ends of the range [rad/s].
            methods: criterion (closed form), floquet (linear stability of the equations), cosim
                (the coupled units), proved (bands); several with commas, or a list.
            narrowest: width of a band that must not be missed [rad/s]; default: range/1000, of
                cosim without floquet range/60.
            within: tolerances for proved, such as "rotor.stiffness=5%".

        Raises:
            UserError: the range is empty, a method is unknown, or the supports have dry friction.
            SceneError: gravity swings the weights.
            SimulationError: a co-simulation fails, and no other method answers.

        >>> found = ab.load("filimonikhina").speeds(0.5, 12.0, "criterion,floquet")
        >>> [round(crossing.speed, 4) for crossing in found.methods["floquet"]]
        [1.0143, 5.0499, 8.3223]
        >>> found.to_pandas()["above it"].iloc[-1]
        'stable'
        """
        from autobalancer.harness.stability.boundaries import speeds

        asked = methods.split(",") if isinstance(methods, str) else list(methods)
        names = [name.strip() for name in asked if name.strip()]
        options: dict[str, Any] = {"progress": progress, "within": within}
        return speeds(self._scene, (low, high), names, narrowest=narrowest, **options)

    def capture(self, speed: float | str | None = None) -> Captured:
        """Whether weights can be left behind at a natural frequency; closed form, without a run.

        Args:
            speed: of the rotor [rad/s]; default: the scene's operating speed.

        Returns:
            Drag from which on they cannot, release speeds, frequency and amplitude meanwhile;
            `sentence()`, `limits()`.

        Raises:
            SceneError: there are no weights, or the supports have dry friction.
            UserError: the speed is not positive.

        >>> found = ab.load("two_balls").replace({"weights.drag": 1e-4}).capture()
        >>> found.found.all_pass, len(found.found.natural)
        (False, 1)
        """
        from autobalancer.harness.capture.captured import captured
        from autobalancer.harness.errors import UserError
        from autobalancer.harness.units import si_number

        wanted = None if speed is None else si_number(speed, "rad/s", "speed")
        if wanted is not None and not wanted > 0.0:
            raise UserError(f"speed {speed}: must be positive")
        return captured(self._scene, wanted)

    def race(self, lobes: str, speed: float | str | None = None) -> OutOfRound:
        """What a race that is not round leaves of the vibration, at rest in the rotor.

        Args:
            lobes: ORDER=AMPLITUDE@ANGLE, several with commas; an order is 2 for an oval, the
                amplitude half of its peak-to-valley, the angle that of a lobe in the rotor.
            speed: of the rotor [rad/s]; default: the scene's operating speed.

        Returns:
            Vibration left by each lobe and by all, at their angles and at the worst one;
            `sentence()`.

        Raises:
            UserError: lobes are not written like that, or the scene is not a planar rotor, alike
                in x and y, with one balancer of equal weights.

        >>> wheel = ab.Scene(
        ...     rotor=ab.Planar(mass=10.0, stiffness=1e4, damping=60.0, unbalance=0.02),
        ...     balancer=[ab.Pendulums(count=2, mass=0.15, track_radius=0.1, drag=0.6)],
        ...     speed=100.0,
        ... )
        >>> found = wheel.race("2=0.2 mm")
        >>> [f"{1e3 * here:.3f} of {1e3 * found.alone:.2f} mm" for here, _ in found.left]
        ['0.702 of 2.22 mm']
        """
        from autobalancer.harness.design.lobes import out_of_round
        from autobalancer.harness.units import si_number

        wanted = None if speed is None else si_number(speed, "rad/s", "speed")
        return out_of_round(self._scene, lobes, wanted)

    def motions(
        self,
        speeds: float | str | Sequence[float | str] | None = None,
        starts: str | Iterable[str] = "rest,turning,run-up",
        n: int = 100,
        *,
        seed: int = 1,
        workers: Workers = 1,
        progress: Progress | None = None,
        store: Path | None = None,
    ) -> Motions:
        """Every steady motion that random starts end in, with its share.

        Args:
            speeds: of the rotor [rad/s]; default: the operating speed.
            starts: rest (the rotor at its speed, weights at rest), turning (with the rotor),
                run-up (from standstill; the scene's own, else a slow one that is stated).
            n: random starts of each.
            seed: the same seed draws the same starts.
            store: as in `map`.

        Returns:
            By speed and start: names, shares with 95 % intervals (Wilson 1927), vibration.

        Raises:
            UserError: a start is unknown, or a speed is not positive.
            SceneError: there are no weights, dry friction, or a motor that stalls.

        >>> found = ab.load("two_balls").motions(starts="turning", n=4)
        >>> found.points[0].shares[0].motion.name
        'balanced'
        """
        from autobalancer.harness.motions.study import find_motions
        from autobalancer.harness.units import si_number

        if speeds is None:
            given: list[float | str] = [self._scene.profile().end]
        elif isinstance(speeds, (int, float, str)):
            given = [speeds]
        else:
            given = list(speeds)
        names = starts.split(",") if isinstance(starts, str) else list(starts)
        return find_motions(
            self._scene,
            [si_number(speed, "rad/s", "speeds:") for speed in given],
            list(dict.fromkeys(name.strip() for name in names if name.strip())),
            n,
            seed=seed,
            workers=workers,
            progress=progress,
            store=store,
        )

    def sweep(self, low: float | str, high: float | str, *, seed: int = 1) -> Sweep:
        """Vibration while the speed rises slowly from `low`, and while it falls from `high`.

        Args:
            low, high: [rad/s].
            seed: draws the angles at the start.

        Raises:
            UserError: the range is empty, or a run fails.
            SceneError: there are no weights.

        >>> found = ab.load("two_balls").sweep(2.0, 3.0)
        >>> [branch.name for branch in found.branches]
        ['rising', 'falling']
        """
        from autobalancer.harness.capture.captured import captured
        from autobalancer.harness.motions.sweep import sweep
        from autobalancer.harness.units import si_number

        captured(self._scene)  # refuses what has no weights
        ends = [si_number(end, "rad/s", "sweep:") for end in (low, high)]
        return sweep(self._scene, *ends, seed=seed)

    def map(
        self,
        x: str | Axis,
        y: str | Axis,
        method: str = "floquet",
        *,
        workers: Workers = 1,
        progress: Progress | None = None,
        store: Path | None = None,
    ) -> StabilityMap | RunMap | ProvedMap | MotionsMap:
        """Where balancing is stable, over two values of the scene.

        Args:
            x, y: "PATH=LOW:HIGH:N" or "PATH=LOW:HIGH:N:log", or an `Axis`.
            method: floquet (growth rates [1/s]), cosim-run (vibration that a run leaves [m]),
                motions (share of 40 run-ups that balances), or proved (of each of N x N cells from
                LOW to HIGH: stable, unstable or undecided).
            store: a file that keeps every point; an interrupted map continues from it.

        Returns:
            Grids of shape (len(y), len(x)).

        Raises:
            UserError: a path or a method is unknown, or a value on an axis is wrong.
            SceneError: gravity swings the weights (floquet).

        >>> found = ab.load("filimonikhina").map("speed=1:6:4", "weights.drag=0.01:1:3:log")
        >>> found.growth.shape, found.to_xarray().sizes["speed [rad/s]"]
        ((3, 4), 4)
        """
        from autobalancer.harness.errors import UserError
        from autobalancer.harness.stability.axis import Axis
        from autobalancer.harness.stability.map import stability_map
        from autobalancer.harness.stability.run_map import run_map

        axes = [a if isinstance(a, Axis) else Axis.parse(a, self._scene) for a in (x, y)]
        options: dict[str, Any] = {"workers": workers, "progress": progress, "store": store}
        if method == "proved":
            return self._proved_map(axes, workers, progress, store)
        if method == "cosim-run":
            return run_map(self._scene, *axes, **options)
        if method == "motions":
            from autobalancer.harness.motions.map import motions_map

            return motions_map(self._scene, *axes, **options)
        if method != "floquet":
            raise UserError(f"method {method!r}: must be floquet, cosim-run, motions or proved")
        return stability_map(self._scene, *axes, **options)

    def _proved_map(
        self, axes: list[Axis], workers: Workers, progress: Progress | None, store: Path | None
    ) -> ProvedMap:
        from autobalancer.harness.errors import UserError
        from autobalancer.harness.stability.boundaries import refuse_missing

        refuse_missing()
        if store is not None:
            raise UserError(f"{store}: the method proved keeps no store; name a picture, or --csv")
        from autobalancer.harness.stability.proved_map import proved_map
        from autobalancer.models.proof.rotors import Unproved

        try:
            return proved_map(self._scene, *axes, workers=workers, progress=progress)
        except Unproved as error:
            raise UserError(f"method proved: {error}") from error

    def scatter(
        self,
        vary: Mapping[str, Any] | Iterable[str],
        n: int = 10_000,
        *,
        seed: int = 1,
        workers: Workers = 1,
        progress: Progress | None = None,
        store: Path | None = None,
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

        space = read_space(unbalance, race, width, material, reserve)
        options: dict[str, Any] = {"workers": workers, "progress": progress}
        return design(self._scene, counts=range(2, most + 1), starts=starts, **space, **options)

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

    def build(
        self,
        output: str | Path = ".",
        *,
        fmi: int = 2,
        platforms: Iterable[str] | None = None,
        python: bool = False,
        one_file: bool = False,
        ssp: bool = False,
        plain: bool = False,
        flat: bool = False,
        reference: bool = False,
        progress: Progress | None = None,
    ) -> Built:
        """Write the FMUs of the scene.

        Args:
            output: folder; with `ssp` also a file.
            fmi: version, 2 or 3.
            platforms: such as "x86_64-linux"; default: all.
            python: units that run Python instead of native ones.
            one_file: the units and their coupling as a single FMU.
            ssp: a system structure package instead of single files.
            plain: with `one_file`, without slopes and figures of the coupling.
            flat: with `one_file`, names without dots and brackets.
            reference: with `one_file`, also the right motion, by an independent integration.

        Raises:
            UserError: the options do not go together, or a file cannot be written.

        >>> built = ab.load("two_balls").build("units", platforms=["x86_64-linux"])
        >>> [path.name for path in built.files]
        ['rotor.fmu', 'weights.fmu']
        """
        from autobalancer.harness.export.build import build_files

        form: dict[str, Any] = {"python": python, "one_file": one_file, "ssp": ssp}
        form |= {"plain": plain, "flat": flat, "reference": reference}
        wanted = None if platforms is None else list(platforms)
        return build_files(self._scene, Path(output), fmi, wanted, progress=progress, **form)

    def show(self, output: str | Path | None = None) -> Page:
        """Write a web page, one file, that runs the scene.

        Args:
            output: the file; default: NAME.html in the current folder.

        Raises:
            UserError: the scene cannot be shown, or the file cannot be written.

        >>> page = ab.load("two_balls").show("two_balls.html")
        >>> page.path.stat().st_size > 100_000
        True
        """
        from autobalancer.harness.show.page import write_page

        return write_page(self._scene, None if output is None else Path(output))

    def report(
        self,
        output: str | Path | None = None,
        *,
        run_up: float | str | None = None,
        limit: float | str | None = None,
        vary: Mapping[str, Any] | Iterable[str] = (),
        n: int = 200,
        progress: Progress | None = None,
    ) -> Written:
        """Write one page about the machine for a colleague: verdict first, and how sure it is.

        Args:
            output: the file; default: NAME_report.html in the current folder.
            run_up: time from standstill to full speed [s]; default: the scene's own drive, else a
                slow run-up that the page states.
            limit: of the vibration velocity [m/s rms].
            vary: tolerances, as of `scatter`; none: they are not judged.
            n: machines drawn from them.

        Raises:
            UserError: a value is wrong, or the file cannot be written.
            SimulationError: the scene itself cannot be run.

        >>> page = ab.load("two_balls").report("two_balls.html")
        >>> page.path.stat().st_size > 50_000, len(page.verdicts)
        (True, 4)
        """
        from autobalancer.harness.errors import UserError
        from autobalancer.harness.report.page import write_report
        from autobalancer.harness.units import si_number

        given = {"run_up": (run_up, "s"), "limit": (limit, "m/s")}
        values: dict[str, Any] = {}
        for name, (value, symbol) in given.items():
            values[name] = None if value is None else si_number(value, symbol, name)
            if values[name] is not None and not values[name] > 0.0:
                raise UserError(f"{name} {value}: must be above 0")
        path = Path(output or f"{self._scene.name}_report.html")
        values |= {"vary": vary, "machines": n, "progress": progress}
        return write_report(self._scene, path, **values)

    def check(self, *, progress: ItemProgress | None = None) -> SceneReport:
        """Every [[check]] of the scene: its theory and measurements beside runs.

        Args:
            progress: called with the scene's name and the finished fraction.

        Raises:
            UserError: there is nothing to check.

        >>> ab.load("liquid_touch").check().holds
        True
        """
        from autobalancer.harness.checks.runner import check_all

        return check_all([self._scene], progress, workers=1)[0]

    def precision(
        self, seconds: float = 75.0, *, progress: Callable[[str, float], None] | None = None
    ) -> Precision:
        """Error against run time of every coupling scheme; errors in parts of a signal's range.

        Args:
            seconds: about how long the measuring may take.
            progress: called with what is measured and the finished fraction.

        Raises:
            UserError: nothing can be measured with the scene.

        >>> short = ab.load("liquid_closed").replace({"run.revolutions": 0.5})
        >>> bool(short.precision(1.0).to_pandas()["error"].min() < 1e-6)
        True
        """
        from autobalancer.harness.accuracy.precision.measure import precision

        return precision(self._scene, seconds=seconds, progress=progress)

    def cite(self) -> str:
        """BibTeX of the program and of the papers and methods that a run of the scene uses.

        A comment above each entry says what it is cited for.

        Raises:
            SimulationError: the scene cannot be started.

        >>> print(*ab.load("drum").cite().splitlines()[:2], sep="\\n")
        % the program that ran the scene
        @software{autobalancer,
        """
        from autobalancer.harness.result.run import is_in_one_piece
        from autobalancer.harness.scene.citations import bibtex

        return bibtex(self._scene, is_in_one_piece(self._scene))
