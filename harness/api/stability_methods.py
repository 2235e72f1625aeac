"""The steady motions of a scene: where they are stable, and which of them is reached."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from autobalancer.harness.stability.methods import DEFAULT_METHODS

from .of_scene import OfScene

if TYPE_CHECKING:
    from autobalancer.harness.capture.captured import Captured
    from autobalancer.harness.design.lobes import OutOfRound
    from autobalancer.harness.motions.map import MotionsMap
    from autobalancer.harness.motions.outcome import Motions
    from autobalancer.harness.motions.sweep import Sweep
    from autobalancer.harness.output.workers import Progress, Workers
    from autobalancer.harness.stability.axis import Axis
    from autobalancer.harness.stability.map import StabilityMap
    from autobalancer.harness.stability.proved_map import ProvedMap
    from autobalancer.harness.stability.run_map import RunMap
    from autobalancer.harness.stability.speeds import Speeds


class StabilityMethods(OfScene):
    """See `methods.Methods`."""

    def speeds(
        self,
        low: float | str | None = None,
        high: float | str | None = None,
        methods: str | Iterable[str] = DEFAULT_METHODS,
        *,
        narrowest: float | None = None,
        within: str = "",
        progress: Progress | None = None,
    ) -> Speeds:
        """Speeds at which balancing begins or ends, by independent methods (Filimonikhina 2017).

        Args:
            low, high: ends of the range [rad/s]; default: from half the lowest natural frequency,
                or half the highest speed of the operation where that is lower, to 1.25 times this
                speed, or twice the lowest natural frequency where that is higher, within the
                tables of bearings.
            methods: criterion (closed form), floquet (linear stability of the equations), cosim
                (the coupled units), proved (bands); several with commas, or a list.
            narrowest: width of a band that must not be missed [rad/s]; default: range/1000, on
                races with lobes range/200, of cosim without floquet range/60.
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
        from autobalancer.harness.errors import UserError, texts_of
        from autobalancer.harness.stability.boundaries import speeds

        if (low is None) != (high is None):
            raise UserError("range: give both of its ends, low and high, or none")
        ends = None if low is None or high is None else (low, high)
        asked = ",".join(texts_of(methods, "methods", "'floquet,cosim'")).split(",")
        names = [name.strip() for name in asked if name.strip()]
        if not names:
            raise UserError(f"methods = {methods!r}: name at least one, such as 'floquet,cosim'")
        options: dict[str, Any] = {"progress": progress, "within": within}
        return speeds(self._scene, ends, names, narrowest=narrowest, **options)

    def map(
        self,
        x: str | Axis,
        y: str | Axis,
        method: str = "floquet",
        *,
        workers: Workers = 1,
        progress: Progress | None = None,
        store: str | Path | None = None,
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
        self,
        axes: list[Axis],
        workers: Workers,
        progress: Progress | None,
        store: str | Path | None,
    ) -> ProvedMap:
        from autobalancer.harness.errors import UserError
        from autobalancer.harness.stability.boundaries import refuse_missing

        refuse_missing()
        if store is not None:
            raise UserError(f"{store}: the method proved keeps no store; name a picture, or --csv")
        from autobalancer.harness.stability.proved_map import proved_map
        from autobalancer.models.proof.arrays import Unproved

        try:
            return proved_map(self._scene, *axes, workers=workers, progress=progress)
        except Unproved as error:
            raise UserError(f"method proved: {error}") from error

    def capture(self, speed: float | str | None = None) -> Captured:
        """Whether weights can be left behind at a natural frequency; closed form, without a run.

        Args:
            speed: of the rotor [rad/s]; default: the scene's operating speed.

        Returns:
            Drag from which on they cannot, release speeds, frequency and amplitude meanwhile;
            `sentence()`, `limits()`.

        Raises:
            SceneError: there are no weights, the supports have dry friction, or the speed is not
                positive.

        >>> found = ab.load("two_balls").replace({"weights.drag": 1e-4}).capture()
        >>> found.found.all_pass, len(found.found.natural)
        (False, 1)
        """
        from autobalancer.harness.capture.captured import captured
        from autobalancer.harness.units import si_number

        wanted = None if speed is None else si_number(speed, "rad/s", "speed")
        return captured(self._scene, wanted)

    def motions(
        self,
        speeds: float | str | Sequence[float | str] | None = None,
        starts: str | Iterable[str] = "rest,turning,run-up",
        n: int = 100,
        *,
        seed: int = 1,
        workers: Workers = 1,
        progress: Progress | None = None,
        store: str | Path | None = None,
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
        from autobalancer.harness.errors import texts_of
        from autobalancer.harness.motions.study import find_motions
        from autobalancer.harness.units import si_number

        if speeds is None:
            given: list[float | str] = [self._scene.profile().end]
        elif isinstance(speeds, (int, float, str)):
            given = [speeds]
        else:
            given = list(speeds)
        names = ",".join(texts_of(starts, "starts", "'rest,run-up'")).split(",")
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

    def race(self, lobes: str | None = None, speed: float | str | None = None) -> OutOfRound:
        """What a race that is not round leaves of the vibration, at rest in the rotor.

        Args:
            lobes: ORDER=AMPLITUDE@ANGLE, several with commas; an order is 2 for an oval, the
                amplitude half of its peak-to-valley, the angle that of a lobe in the rotor;
                default: the scene's own, of all its races together.
            speed: of the rotor [rad/s]; default: the scene's operating speed.

        Returns:
            Vibration left by each lobe and by all, at their angles and at the worst one, all
            races turned together; `sentence()`.

        Raises:
            UserError: lobes are not written like that, the scene's supports are not alike in x and
                y, or, with lobes given here, it is not a planar rotor with one balancer of equal
                weights.

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
