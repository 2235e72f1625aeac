"""The loop between force and acceleration: its gain, its start, and what auto makes of it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest

from autobalancer.harness import SimulationError, cosimulate, load_scene
from autobalancer.harness.master.cosimulation import CoSimulation
from autobalancer.harness.master.loop import QuasiNewton, consistent_start, value_eigenvalues
from autobalancer.harness.master.schemes.gauss_seidel import GaussSeidel
from autobalancer.harness.master.schemes.iterated import Iterated
from autobalancer.harness.master.system import Signals


def started(scene) -> CoSimulation:
    cosim = CoSimulation(scene)
    cosim.start()
    return cosim


def spread(angles) -> float:
    return float(abs(np.mean(np.exp(2j * np.array(angles)))))


# -- gain -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("gain", [1e-6, 0.5, 1.0, 19.0, 1e5])
def test_gain_of_a_liquid_as_force_is_its_added_mass_over_the_rotor_mass(liquid_of_gain, gain):
    with started(liquid_of_gain(gain)) as cosim:
        assert cosim.gain == pytest.approx(gain, rel=1e-9)


def test_gain_of_a_liquid_carried_by_the_rotor_is_nothing():
    with started(load_scene("liquid_heavy")) as cosim:
        assert cosim.gain == 0.0
        assert cosim.system.exchanges == []


@pytest.mark.parametrize("angles", [[0.3, 1.0], [0.0, 0.0], [0.0, np.pi / 2], [1.0, 4.0]])
@pytest.mark.parametrize("kind", ["balls", "rollers", "pendulums"])
def test_gain_of_carried_weights_is_half_eps_times_one_plus_their_spread(kind, angles):
    # the weights' tangents t_k feel the force (m/kappa) sum t_k t_k^T a / M, of eigenvalues
    # N m (1 +- p) / (2 kappa M)
    scene = load_scene("two_balls").replace({"weights.kind": kind, "weights.angles": angles})
    weights = scene.balancer[0]
    total = scene.rotor.mass + 2 * weights.mass
    eps = 2 * weights.mass / (weights.kappa * total)
    with started(scene) as cosim:
        assert cosim.gain == pytest.approx(0.5 * eps * (1.0 + spread(angles)), rel=1e-9)
        assert cosim.gain <= eps * (1 + 1e-12)


@pytest.mark.parametrize("angles", [[0.3, 1.0], [0.0, 0.0], [0.0, np.pi / 2]])
def test_gain_of_weights_as_force_is_their_mass_less_what_may_roll(angles):
    # F = -N m a + (m/kappa) sum t_k t_k^T a on the bare rotor
    scene = load_scene("two_balls").replace(
        {"weights.kind": "balls", "weights.angles": angles, "weights.inertia_as_force": True}
    )
    ratio = 2 * scene.balancer[0].mass / scene.rotor.mass
    expected = ratio * (1.0 - (1.0 - spread(angles)) / (2.0 * 1.4))
    with started(scene) as cosim:
        assert cosim.gain == pytest.approx(expected, rel=1e-9)


# -- what auto chooses ----------------------------------------------------------------------------


def test_auto_takes_one_pass_for_a_weak_loop_and_converges_a_strong_one(heavy_weights):
    weak = load_scene("two_balls").replace(
        {"coupling.scheme": "auto", "coupling.corrections": None}
    )
    with started(weak) as cosim:
        assert isinstance(cosim.scheme, Iterated)
        assert cosim.scheme.corrections == 1
    with started(weak.replace(heavy_weights)) as cosim:
        assert isinstance(cosim.scheme, Iterated)
        assert cosim.scheme.corrections is None
    with started(load_scene("liquid_disc")) as cosim:
        assert isinstance(cosim.scheme, GaussSeidel), "there is no loop to iterate"
    with started(weak.replace({"coupling.tolerance": 1e-4})) as cosim:
        assert isinstance(cosim.scheme, Iterated)
        assert cosim.scheme.corrections is None


# -- consistent start -----------------------------------------------------------------------------


@dataclass
class LinearLoop:
    """Units whose forces answer any forces u with A u + b, values and slopes alike."""

    matrix: np.ndarray
    constant: np.ndarray

    def __post_init__(self) -> None:
        self.coupled = True
        self.forces = Signals(len(self.constant))
        self.accelerations = Signals(len(self.constant))

    def rotor_answer(self, forces):
        return self.matrix @ forces[:, :2] + self.constant[:, None]

    def balancer_answer(self, accelerations):
        return accelerations[:, :2]

    def drop_past(self) -> None:
        self.forgotten = True


@pytest.mark.parametrize("eigenvalue", [-1e6, -19.0, -1.0, -0.5, 0.0, 0.5, 0.999, 1.001, 1.5, 30.0])
def test_start_values_converge_for_affine_loops_of_any_gain_but_1(eigenvalue):
    mix = np.array([[2.0, 1.0], [1.0, 1.0]])
    matrix = mix @ np.diag([eigenvalue, 0.3]) @ np.linalg.inv(mix)
    constant = np.array([1.0 + 2.0j, -3.0j])
    loop = LinearLoop(matrix, constant)
    jacobian = consistent_start(loop, 0.01)[: 4 * len(constant)]
    expected = np.linalg.solve(np.eye(2) - matrix, constant)
    found = loop.forces.now[:, 0]
    accuracy = 1e-12 * max(1.0, abs(eigenvalue), 1.0 / abs(1.0 - eigenvalue))
    assert np.abs(found - expected).max() <= 10.0 * accuracy * np.abs(expected).max()
    assert max(map(abs, value_eigenvalues(jacobian))) == pytest.approx(
        max(abs(eigenvalue), 0.3), rel=1e-6
    )


@pytest.mark.parametrize("off", [0.0, 1e-15, -1e-14])
def test_a_loop_of_gain_1_has_no_start_and_says_so(off):
    loop = LinearLoop(np.array([[1.0 + off]]), np.array([1.0 + 0.5j]))
    with pytest.raises(SimulationError, match="gain 1"):
        consistent_start(loop, 0.01)


def test_a_loop_without_a_digit_of_its_own_gain_is_refused():
    """1 - dG/du is dG/du there, and of less than full rank."""
    with pytest.raises(SimulationError, match="gain 1"):
        QuasiNewton(np.full((4, 4), 1e20), 0.1)


def test_a_motion_beyond_all_bounds_teaches_the_loop_nothing(recwarn):
    newton = QuasiNewton(np.zeros((4, 4)), 0.1)
    far = np.array([1e200 + 0j, 0j])
    newton.learn(far, far, -far)
    assert (newton.inverse == np.eye(4)).all()
    assert not recwarn


def test_a_start_that_does_not_settle_says_by_how_much():
    class Restless(LinearLoop):
        def rotor_answer(self, forces):
            return np.array([[complex(*noise.normal(size=2)), 0j]])

    noise = np.random.default_rng(1)
    with pytest.raises(SimulationError, match=r"start values were not found.*still change.*gain"):
        consistent_start(Restless(np.zeros((1, 1)), np.ones(1)), 0.01)


@pytest.mark.parametrize("gain", [0.5, 19.0, 1e4])
def test_start_of_a_liquid_as_force_is_that_of_the_loaded_rotor(liquid_of_gain, gain):
    scene = liquid_of_gain(gain)
    with started(scene) as cosim:
        (force,) = cosim.system.forces.now[:, 0]
        pull = scene.rotor.unbalance * scene.operation.speed**2
        acceleration = pull / (scene.rotor.mass * (1.0 + gain))  # along xi, rotor at rest
        assert force == pytest.approx(-gain * scene.rotor.mass * acceleration, rel=1e-9)


# -- a strong loop --------------------------------------------------------------------------------


def test_a_loop_of_gain_19_is_solved_by_iteration(against):
    runs = against("liquid_heavy_force", {"run.revolutions": 5})
    assert runs.of_amplitude(runs.run({})) <= 2e-4
    carried = cosimulate(load_scene("liquid_heavy").replace({"run.revolutions": 5}))
    sent = runs.run({"steps_per_rev": 160})
    assert sent["rotor.x"][::4] == pytest.approx(
        carried["rotor.x"], abs=2e-6 * np.abs(carried["rotor.x"]).max()
    )


@pytest.mark.parametrize("order", [0, 1, 3])
@pytest.mark.parametrize("scheme", ["jacobi", "gauss-seidel"])
@pytest.mark.parametrize("revolutions", [0.25, 20])
def test_a_loop_of_gain_19_ends_an_explicit_run_with_time_signal_and_gain(
    scheme, order, revolutions
):
    scene = load_scene("liquid_heavy_force").replace(
        {"coupling.scheme": scheme, "coupling.order": order, "run.revolutions": revolutions}
    )
    with pytest.raises(SimulationError, match=r"t = .* s.*liquid\.F.*loop gain 19\b"):
        cosimulate(scene, separate=True)


def test_a_step_refused_by_a_unit_names_time_signal_and_gain():
    with started(load_scene("liquid_heavy_force").replace({"coupling.steps_per_rev": 40})) as cosim:
        for _ in range(3):
            cosim.step(1e-3)
        cosim.system.forces.now[0, 0] = math.nan
        with pytest.raises(SimulationError, match=r"t = 0\.003 s.*F_xi.*loop gain 19\b"):
            cosim.step(1e-3)


def test_too_few_corrections_for_heavy_weights_end_the_run(heavy_weights):
    scene = load_scene("two_balls").replace({**heavy_weights, "coupling.corrections": 0})
    with pytest.raises(SimulationError, match=r"t = .* s: weights\.F .*loop gain 0\.26"):
        cosimulate(scene, separate=True)


def test_steps_left_unconverged_are_counted_and_said(heavy_weights):
    scene = load_scene("two_balls").replace(
        {**heavy_weights, "coupling.corrections": 1, "run.revolutions": 20}
    )
    result = cosimulate(scene, separate=True)
    assert 0 < result.unconverged < result.steps
    assert any(event.startswith(f"{result.unconverged} of 400 steps") for event in result.events)
    converged = cosimulate(scene.replace({"coupling.corrections": None}), separate=True)
    assert converged.unconverged == 0
