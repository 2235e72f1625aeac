"""Balancing from amplitudes alone, against rotors that are computed here or co-simulated."""

from __future__ import annotations

import numpy as np
import pytest

from autobalancer.harness import UserError, load_scene
from autobalancer.harness.balancing.correction import correct
from autobalancer.harness.balancing.errors import moved_by_errors
from autobalancer.harness.balancing.machine import Machine
from autobalancer.models.papers.influence import find_correction, influence
from autobalancer.models.papers.siebert import from_amplitudes

TRIALS = np.exp(1j * np.radians([0.0, 130.0, 215.0]))


def jeffcott(unbalance, speed=140.0, mass=5.0, stiffness=7e4, damping=60.0):
    """Amplitude (2,) at two sensors of a Jeffcott rotor whose sensors have unlike gains."""
    motion = speed**2 * unbalance / (stiffness - mass * speed**2 + 1j * speed * damping)
    return np.abs(motion) * np.array([1e6, 0.7e6])


def written(path, readings, masses, unit="um"):
    """readings (r, s), masses (r, p) [g]."""
    planes = range(1, masses.shape[1] + 1)
    lines = [",".join(["run", "sensor", f"amplitude [{unit}]"]
             + [f"mass[{p}] [g],angle[{p}] [deg]" for p in planes])]  # fmt: skip
    for r, (row, mounted) in enumerate(zip(readings, masses, strict=True)):
        cells = [f"{abs(m)},{np.degrees(np.angle(m))}" if m else "," for m in mounted]
        lines += [f"{r},{s},{value}," + ",".join(cells) for s, value in enumerate(row)]
    path.write_text("\n".join(lines))
    return path


def test_four_amplitudes_give_the_correction_of_a_jeffcott_rotor(tmp_path):
    """Unbalance 300 g mm at 77 deg, masses at 60 mm: the correction is 5 g at 257 deg."""
    masses = np.concatenate([[0.0], 8.0 * TRIALS])[:, None]
    own = 300e-6 * np.exp(1j * np.radians(77.0))
    readings = np.array([jeffcott(own + 60e-6 * m[0]) for m in masses])
    found = correct(written(tmp_path / "runs.csv", readings, masses))
    expected = 5.0 * np.exp(1j * np.radians(257.0))
    assert abs(found.exact[0] - expected) < 1e-6
    assert np.abs(found.circles.left).max() < 1e-9 * readings.max()
    assert found.rms < 1e-6 * readings[0].max()
    assert found.ambiguous == []


@pytest.mark.parametrize("seed", range(5))
def test_readings_of_two_digits_leave_a_tenth_of_the_vibration(tmp_path, seed):
    random = np.random.default_rng(seed)
    own = 300e-6 * np.exp(1j * random.uniform(0.0, 2.0 * np.pi))
    masses = np.concatenate([[0.0], 5.0 * TRIALS])[:, None]
    readings = np.array([jeffcott(own + 60e-6 * m[0]) for m in masses])
    noisy = readings * (1.0 + 0.01 * random.standard_normal(readings.shape))
    found = correct(written(tmp_path / "runs.csv", noisy, masses))
    left = abs(own + 60e-6 * found.exact[0]) / abs(own)
    assert left < 0.1
    assert 0.0 < np.abs(found.circles.left).max() < 0.05 * readings.max()


def test_two_planes_of_the_co_simulated_machine_are_balanced_without_phases(tmp_path):
    """Seven runs of the balancing machine, amplitudes alone; the equations say what it carries."""
    scene, arm = load_scene("balancing_machine"), 80e-6  # kg m per g
    masses = np.zeros((7, 2), complex)
    masses[1:4, 0], masses[4:, 1] = 90.0 * TRIALS, 70.0 * TRIALS
    with Machine(scene) as machine:
        readings = np.array([1e6 * np.abs(machine.measure(arm * row)) for row in masses])
        speed = machine.speed
    found = correct(written(tmp_path / "runs.csv", readings, masses))
    rotor = scene.assembly().rotor
    own = influence(rotor, speed)[0]
    planes = influence(rotor, speed, np.eye(2))[0]
    expected = -np.linalg.solve(own, planes @ rotor.unbalance)
    assert np.abs(arm * found.exact - expected).max() < 1e-4 * np.abs(expected).max()
    assert np.isnan(found.uncertainty).all()


def test_a_nearly_mirrored_solution_is_stated(tmp_path):
    """Trial masses nearly on a line, and readings of 2 %: the two solutions are named."""
    trials = np.exp(1j * np.radians([0.0, 180.0, 2.0]))
    masses = np.concatenate([[0.0], 5.0 * trials])[:, None]
    own = 300e-6 * np.exp(1j * np.radians(77.0))
    readings = np.array([jeffcott(own + 60e-6 * m[0]) for m in masses])
    found = correct(written(tmp_path / "runs.csv", readings.round(0), masses))
    assert [(sensor, plane) for sensor, plane, _ in found.ambiguous] == [("0", "1"), ("1", "1")]


@pytest.mark.parametrize("degrees", [(0.0, 130.0, 215.0), (0.0, 9.0, -9.0)])
def test_what_errors_of_readings_move_the_correction_by_is_what_drawn_errors_do(degrees):
    random = np.random.default_rng(5)
    masses = np.concatenate([[0.0], 8.0 * np.exp(1j * np.radians(degrees))])[:, None]
    exact = np.array([jeffcott(300e-6j + 60e-6 * m[0]) for m in masses])
    first = from_amplitudes(exact, masses)
    w = find_correction(first.coefficients, first.responses.astype(complex))
    error = 1e-3
    stated = moved_by_errors(first, masses, w, error)
    moved = []
    for _ in range(60):
        drawn = exact * (1.0 + error * random.standard_normal(exact.shape))
        found = from_amplitudes(drawn, masses)
        moved.append(find_correction(found.coefficients, found.responses.astype(complex)) - w)
    assert np.sqrt(np.mean(np.abs(moved) ** 2)) == pytest.approx(stated[0], rel=0.25)


def test_trial_masses_close_together_move_the_correction_far(invoke, tmp_path):
    for degrees, far in (((0.0, 130.0, 215.0), False), ((0.0, 4.0, -4.0), True)):
        masses = np.concatenate([[0.0], 4.0 * np.exp(1j * np.radians(degrees))])[:, None]
        readings = np.array([jeffcott(300e-6j + 60e-6 * m[0]) for m in masses])
        outcome = invoke("balance", written(tmp_path / "runs.csv", readings.round(1), masses))
        said = " ".join(outcome.output.split())
        assert "Readings that err by 2 % move the correction by" in said
        assert ("(standard deviation). Repeat the trial runs with a larger mass" in said) == far


def test_trial_masses_on_a_line_or_too_few_are_refused():
    masses = np.array([[0.0], [1.0], [-1.0], [2.0]], complex)
    with pytest.raises(ValueError, match="mirror image fit alike"):
        from_amplitudes(np.ones((4, 1)), masses)
    with pytest.raises(ValueError, match=r"needs 3 trial runs in which only its mass .* it has 2"):
        from_amplitudes(np.ones((3, 1)), masses[:3])


def test_the_command_states_what_the_circles_miss(invoke, tmp_path):
    masses = np.concatenate([[0.0], 8.0 * TRIALS])[:, None]
    readings = np.array([jeffcott(300e-6j + 60e-6 * m[0]) for m in masses])
    path = written(tmp_path / "runs.csv", readings.round(1), masses)
    outcome = invoke("balance", path)
    assert outcome.exit_code == 0, outcome.output
    assert "No phases: coefficients are found from the amplitudes" in outcome.output
    assert "Ambiguous" not in outcome.output
    few = written(tmp_path / "few.csv", readings[:3], masses[:3])
    refused = invoke("balance", few)
    assert refused.exit_code == 2
    assert "without phases, plane 1 needs 3 trial runs" in refused.stderr


def test_a_runout_without_phases_is_refused(tmp_path):
    path = tmp_path / "runs.csv"
    path.write_text("run,sensor,amplitude [um],runout [um],mass[1] [g],angle[1] [deg]\na,1,2,1,,\n"
                    "b,1,3,1,1,0\n")  # fmt: skip
    with pytest.raises(UserError, match="a run-out is subtracted as a vector: give its phase"):
        correct(path)
