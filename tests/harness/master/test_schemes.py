"""Coupling schemes: their orders on every bundled scene, and the limits of their stability."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.interpolate import BPoly

from autobalancer.harness import SimulationError, cosimulate, load_scene
from autobalancer.harness.master.cosimulation import CoSimulation
from autobalancer.harness.master.schedule import step_size
from autobalancer.harness.master.schemes.compensated import Compensated, carried
from autobalancer.harness.master.schemes.explicit import BEFORE, NOW
from autobalancer.harness.master.schemes.gauss_seidel import GaussSeidel
from autobalancer.harness.master.schemes.jacobi import Jacobi
from autobalancer.harness.master.signals import Signals, end_of
from autobalancer.models.monolith import reference
from tests.scenes import driven_scenes

pytestmark = pytest.mark.slow

ORDERS = {  # of convergence, as the schemes' docstrings state them, by order of the signals
    "jacobi": {0: 1, 1: 2, 3: 3},
    "gauss-seidel": {0: 1, 1: 2, 3: 3},
    "compensated": {3: 4},
    "iterated": {0: 1, 1: 2, 3: 4},
}
GAIN_LIMIT = {  # 1 where nothing is said of an explicit scheme; the others know none
    ("jacobi", 3): 1.0 / 169.0,
    ("gauss-seidel", 1): 1.0 / 3.0,
    ("gauss-seidel", 3): 1.0 / 13.0,
}
EXACT = 1e-9  # of the amplitude: reference and rounding of a motion without coupling error
STEPS = {0: (40, 80), 1: (40, 80), 3: (40, 80, 160)}  # per revolution, by order of the signals
FINER = {("rubber_drive", "jacobi"): 8}  # times as many: so its rubber is followed


RUBBING = [name for name in driven_scenes() if load_scene(name).rotor.friction]
# without one whose fastest mode turns fifty times as fast as the rotor: the reference takes long
DRIVEN = [name for name in driven_scenes() if name != "bristol_flexible"]
EXCHANGING = [n for n in DRIVEN if any(b.exchanges_force for b in load_scene(n).balancer)]


def gain_of(scene) -> float:
    with CoSimulation(scene) as cosim:
        cosim.start()
        return cosim.gain


@pytest.mark.parametrize(
    ("name", "scheme", "order"),
    [
        (name, scheme, order)
        for name in EXCHANGING
        for scheme, orders in ORDERS.items()
        for order in orders
    ],
)
def test_every_scheme_converges_with_its_order_or_says_that_it_is_unstable(
    against, name, scheme, order
):
    runs = against(name, {"run.revolutions": 2, "run.record": None})
    coupling = {"scheme": scheme, "order": order, "corrections": None, "tolerance": None}

    def error(steps):
        # cubics of C are the same to rounding, see tests/native/test_composite.py
        result = runs.run({**coupling, "steps_per_rev": steps}, separate=True)
        return runs.of_amplitude(result, max(1, steps // 40))

    gain = gain_of(runs.scene)
    if scheme in ("jacobi", "gauss-seidel") and gain > GAIN_LIMIT.get((scheme, order), 1.0):
        with pytest.raises(SimulationError, match=rf"unstable.*F.*gain {gain:.3g}"):
            error(40)
        return
    times = FINER.get((name, scheme), 1)
    errors = np.array([error(times * steps) for steps in STEPS[order]])
    assert np.isfinite(errors).all()
    observed = np.log2(errors[:-1] / errors[1:])
    expected = ORDERS[scheme][order]
    assert observed[-1] >= expected - 0.3 or errors[-1] <= EXACT, (errors, observed)


@pytest.mark.parametrize("name", [n for n in DRIVEN if n not in EXCHANGING + RUBBING])
def test_where_no_force_is_exchanged_nothing_can_be_missed(against, name):
    runs = against(name, {"run.revolutions": 2, "run.record": None})
    held = {"scheme": "jacobi", "order": 0, "corrections": None, "tolerance": None}
    result = runs.run({**held, "steps_per_rev": 40})
    assert gain_of(runs.scene) == 0.0
    assert runs.of_amplitude(result) <= EXACT


def test_extrapolation_matrices_continue_any_cubic():
    # the cubic t^3 - 2 t^2 + 3 t - 4 from its values and slopes at 0 and 1
    value, slope = np.polynomial.Polynomial([-4.0, 3.0, -2.0, 1.0]), None
    slope = value.deriv()
    ends = [np.array([value(t), slope(t)]) for t in (0.0, 1.0, 2.0)]
    assert NOW @ ends[1] + BEFORE @ ends[0] == pytest.approx(ends[2], rel=1e-14)


@pytest.mark.parametrize(
    ("scheme", "order", "limit"),
    [
        (Jacobi, 0, 1.0),
        (Jacobi, 1, 1.0),
        (Jacobi, 3, 1.0 / 169.0),
        (GaussSeidel, 0, 1.0),
        (GaussSeidel, 1, 1.0),
        (GaussSeidel, 3, 1.0 / 13.0),
    ],
)
def test_explicit_schemes_are_stable_up_to_their_documented_gain(scheme, order, limit):
    assert scheme.amplification([0.999 * limit], order) < 1.0
    assert scheme.amplification([1.001 * limit], order) > 1.0
    assert scheme.amplification([limit], order) == pytest.approx(1.0, abs=1e-9)


def test_linear_gauss_seidel_is_stable_up_to_a_third_where_force_opposes_acceleration():
    # e(n+1) = J e(n) + J d(n), d(n+1) = (J - 1) e(n) + J d(n): lambda = J +- sqrt(J (J - 1))
    assert GaussSeidel.amplification([-1.0 / 3.0], 1) == pytest.approx(1.0, abs=1e-12)
    assert GaussSeidel.amplification([-0.97], 1) == pytest.approx(0.97 + (0.97 * 1.97) ** 0.5)


def liquid_limit(scheme, order) -> float:
    """Gain at which the scheme stops being stable for a liquid, whose loop eigenvalue is -gain."""
    low, high = 1e-4, 2.0
    while high - low > 1e-9:
        middle = 0.5 * (low + high)
        if scheme.amplification([-middle], order) > 1.0:
            high = middle
        else:
            low = middle
    return low


def stepped(scene, steps: int) -> float:
    """Step by step, past the refusal of `run`: the rotor's largest displacement [m]."""
    with CoSimulation(scene) as cosim:
        cosim.start()
        rotor, step = cosim.units["rotor"], step_size(scene)
        worst = 0.0
        for _ in range(steps):
            cosim.step(step)
            worst = max(worst, *map(abs, rotor.get(rotor.group(["x", "y"]))))
    return worst


@pytest.mark.parametrize(
    ("name", "scheme", "order"),
    [("jacobi", Jacobi, o) for o in (0, 3)] + [("gauss-seidel", GaussSeidel, o) for o in (0, 1, 3)],
)
def test_a_liquid_as_force_settles_below_the_limit_and_diverges_above_it(
    liquid_of_gain, name, scheme, order
):
    limit = liquid_limit(scheme, order)
    # hardly damped and in short steps, so that nothing but the exchange decides
    changes = {"rotor.damping": 3.0, "rotor.internal_damping": 1.0, "coupling.steps_per_rev": 400}
    changes |= {"coupling.scheme": name, "coupling.order": order}
    below = liquid_of_gain(0.97 * limit).replace(changes)
    assert stepped(below, 4000) < 1e-3  # m: resting on a bending of some 1e-5 m
    above = liquid_of_gain(1.03 * limit).replace(changes)
    gain = rf"loop gain {1.03 * limit:.3g}"
    with pytest.raises(
        SimulationError, match=rf"too long at t = .* s: liquid\.F .*diverges.*{gain}"
    ):
        stepped(above, 4000)
    with pytest.raises(SimulationError, match=rf"unstable from t = 0 s.*liquid\.F.*{gain}"):
        cosimulate(above, separate=True)


def test_no_corrections_is_gauss_seidel(against):
    runs = against("two_balls", {"run.revolutions": 5})
    none = runs.run({"scheme": "iterated", "corrections": 0}, separate=True)
    explicit = runs.run({"scheme": "gauss-seidel", "corrections": None})
    for name in explicit.signals:
        none.assert_close(name, explicit[name], relative=1e-10)
    assert none.steps == none.passes == explicit.passes == 100


@pytest.mark.parametrize("corrections", [1, 2, 3])
def test_a_step_passes_as_often_as_asked(corrections):
    scene = load_scene("two_balls").replace(
        {"coupling.corrections": corrections, "run.revolutions": 2}
    )
    with CoSimulation(scene) as cosim:
        cosim.start()
        rotor = cosim.units["rotor"].calls
        cosim.step(0.1)  # the first step has no past and takes as many as it needs
        first = rotor["step"]
        for _ in range(10):
            cosim.step(0.1)
        assert rotor["step"] - first <= 10 * (1 + corrections)
        assert rotor["step"] - first >= 10
        assert rotor["restore"] == rotor["step"] - 11


# -- compensated ----------------------------------------------------------------------------------


@pytest.mark.parametrize("turn", [0.0, 0.3, 2.0])
@pytest.mark.parametrize(("past", "step"), [(0.1, 0.1), (0.1, 0.2), (0.3, 0.07)])
def test_what_is_made_good_gives_a_free_mass_the_velocity_and_the_way_it_missed(turn, past, step):
    end = [0.7 - 0.2j, (-0.4 + 1.1j) / past]  # of the past step
    times = past ** np.arange(2)
    nodes, shares = np.polynomial.legendre.leggauss(30)
    over, rate = past + step, turn / past

    def force(polynomial, begin, length):
        """In fixed axes, with times and shares of an integral."""
        t = 0.5 * length * (nodes + 1.0)
        return begin + t, 0.5 * length * shares * polynomial(t) * np.exp(1j * rate * (begin + t))

    def motion(polynomial, begin, length):
        """Velocity of a unit mass at the end of both steps, and its integrals."""
        t, push = force(polynomial, begin, length)
        return [(push * (over - t) ** k).sum() for k in range(2)]

    missed = BPoly.from_derivatives([0.0, past], [[0.0] * 2, end])
    start = carried(turn, past, step) @ (times * end)
    given = np.polynomial.Polynomial(start / [math.factorial(k) for k in range(4)])
    assert motion(given, past, step) == pytest.approx(motion(missed, 0.0, past), rel=1e-11)
    left = [abs(given.deriv(k)(step)) * step**k for k in range(2)]
    assert max(left) < 1e-12 * np.abs(start * step ** np.arange(4)).max()


class Echo:
    """Units whose force is a share of the one assumed, while the rotor stays at rest."""

    def __init__(self, share: complex) -> None:
        self.share, self.has_no_past, self.force_names = share, False, ["unit.F"]
        self.coupled = True
        start, now = np.array([[1.0, 0.3]]), np.array([[0.8, -0.2]])
        self.forces, self.accelerations = Signals(1), Signals(1)
        self.forces.now = start
        self.forces.accept(now, 1.0)
        self.accelerations.last_step = 1.0

    def rotor_pass(self, forces, time, step):
        self.assumed = end_of(forces, step)
        return np.zeros((1, 2), complex)

    def balancer_pass(self, accelerations, time, step):
        return self.share * self.assumed

    def accept(self, accelerations, forces, time, step):
        self.forces.accept(forces, step)
        self.accelerations.accept(accelerations, step)


def test_compensated_stands_a_jacobian_that_is_wrong_by_a_thirteenth():
    """The scheme knows no loop, and the units have one."""

    def size(share):
        units, sizes = Echo(share), []
        scheme = Compensated(np.zeros((4, 4)), np.zeros((4, 4)), 1.0, lambda _: 0.0)
        for step in range(800):
            scheme.step(units, float(step), 1.0)
            sizes.append(abs(units.forces.now[0, 0]))
        return max(sizes[-50:])

    assert size(0.97 / 13.0) < 1e-3
    assert size(1.03 / 13.0) > 1e3


@pytest.mark.parametrize("name", ["two_balls", "finite_weights", "three_mass_shaft"])
def test_compensated_is_as_cheap_as_gauss_seidel_and_ten_times_as_exact(against, name):
    runs = against(name, {"run.revolutions": 4, "run.record": None})
    coupling = {"corrections": None, "steps_per_rev": 20}
    plain = runs.run({"scheme": "gauss-seidel", **coupling})
    found = runs.run({"scheme": "compensated", **coupling}, separate=True)
    assert found.passes - plain.passes == Compensated.startup_halvings  # of the first step's parts
    assert found.calls["save"] == found.calls["restore"] == 0
    assert runs.of_amplitude(found) <= 0.1 * runs.of_amplitude(plain)


@pytest.mark.parametrize("gain", [0.5, 19.0, 1e3])
def test_compensated_knows_no_limit_of_the_loop_gain(against, liquid_of_gain, gain):
    density = liquid_of_gain(gain).balancer[0].density
    runs = against("liquid_heavy_force", {"liquid.density": density, "run.revolutions": 4})
    errors = [
        runs.of_amplitude(runs.run({"scheme": "compensated", "steps_per_rev": steps}))
        for steps in (80, 160)
    ]
    assert errors[1] <= errors[0] / 2**3.5
    assert errors[1] <= 1e-6 * (1.0 + gain)  # the loop turns an error of the force into that much


STIFF = {  # mode of the y axis at 20 steps per revolution, 0.105 s each
    1.5: {"rotor.stiffness": [1.0, 200.0]},
    7.4: {"rotor.stiffness": [1.0, 5000.0]},
}
RUN_UP = {"operation.run_up": {"from": 0.3, "to": 3.0, "seconds": 8.0}, "operation.speed": None}
DRAGGED = {2.1: {"weights.drag": 0.5}, 8.4: {"weights.drag": 2.0}}  # d = b/m times the step


@pytest.mark.parametrize(
    ("changes", "times"), [(STIFF[1.5], 1.8), (DRAGGED[2.1], 50.0)], ids=["stiff", "drag"]
)
def test_compensated_is_better_than_gauss_seidel_while_a_step_is_short(against, changes, times):
    runs = against("two_balls", changes)
    plain = runs.run({"scheme": "gauss-seidel", "corrections": None})
    found = runs.run({"scheme": "compensated", "corrections": None})
    assert runs.of_range(found) * times <= runs.of_range(plain)


@pytest.mark.parametrize("changes", [STIFF[7.4], DRAGGED[8.4]], ids=["stiff", "drag"])
def test_compensated_says_that_it_cannot_follow_what_a_long_step_hides(changes):
    scene = load_scene("two_balls").replace({"coupling.scheme": "compensated", **changes})
    with pytest.raises(SimulationError, match=r"t = .*use "):
        cosimulate(scene, separate=True)


@pytest.mark.parametrize(
    ("scheme", "order"), [("gauss-seidel", 2.7), ("compensated", 3.2), ("iterated", 3.7)]
)
def test_the_end_of_a_run_up_costs_no_scheme_its_order(scheme, order):
    # the force jumps there: a share of it left in the loop would be an error of order 1 or less
    scene = load_scene("two_balls").replace(
        {
            **RUN_UP,
            "run.revolutions": 6,
            "coupling.scheme": scheme,
            "coupling.corrections": 1 if scheme == "iterated" else None,
        }
    )
    errors = []
    for steps in (80, 320):
        given = scene.replace({"coupling.steps_per_rev": steps})
        result = cosimulate(given, separate=True)
        late = result.time > 8.0
        right = reference(scene.assembly(), scene.profile(), result.time, rtol=1e-12)[0]
        gaps = [
            np.abs(result[name] - right.signal(name))[late].max() / np.ptp(right.signal(name))
            for name in ("rotor.x", "rotor.y", "weights.moment_xi")
        ]
        errors.append(max(gaps))
    assert np.log(errors[0] / errors[1]) / np.log(4.0) >= order, errors


@pytest.mark.parametrize("drive", [{}, RUN_UP], ids=["constant", "run_up"])
def test_a_track_off_the_centre_costs_no_order(against, drive):
    aside = {"weights.track_offset_xi": 0.02, "weights.track_offset_eta": -0.01}
    runs = against("two_balls", {**aside, **drive, "run.revolutions": 4})
    steps = {"scheme": "iterated", "corrections": 1}
    errors = [
        runs.of_amplitude(runs.run({**steps, "steps_per_rev": n}, separate=True)) for n in (20, 40)
    ]
    assert errors[1] <= errors[0] / 2**3.5
