"""Errors that a second, finer run measures: against integrations of the motion in one piece."""

import json
import math

import numpy as np
import pytest
from typer.testing import CliRunner

from autobalancer.harness import cosimulate, load_scene
from autobalancer.harness.__main__ import program
from autobalancer.harness.errors import UserError
from autobalancer.harness.master.names import kin
from autobalancer.harness.scene import Scene
from autobalancer.models.monolith import reference
from tests.truth.judge import growth

pytestmark = pytest.mark.slow

AUTO = {"coupling.scheme": "auto", "coupling.corrections": None, "coupling.steps_per_rev": None}
EXPLICIT = {"coupling.scheme": "gauss-seidel", "coupling.corrections": None}
MEASURED = {
    "a tolerance": ("two_balls", {**AUTO, "coupling.tolerance": 1e-3}),
    "given steps": ("two_balls", {}),
    "many steps": ("two_balls", {"coupling.steps_per_rev": 200, "run.revolutions": 5}),
    "few steps": ("two_balls", {"coupling.steps_per_rev": 8}),
    "extrapolated cubics": ("two_balls", EXPLICIT),
    "compensated": ("two_balls", {**EXPLICIT, "coupling.scheme": "compensated"}),
    "straight lines": ("two_balls", {"coupling.order": 1}),
    "held signals": ("two_balls", {"coupling.order": 0, "run.revolutions": 5}),
    "a run-up": ("run_up", {"run.revolutions": 40}),
    "given steps in a run-up": (
        "run_up",
        {"coupling.steps_per_rev": 20, "run.revolutions": 40.3},
    ),
    "two supports": ("two_plane_rodrigues", {"run.revolutions": 10}),
    "a shaft whose errors gather": (
        "grinder",
        {"coupling.steps_per_rev": 8, "run.revolutions": 10},
    ),
    "liquid as a force": ("liquid_heavy_force", {"run.revolutions": 10}),
    "balls and liquid": ("balls_and_liquid", {"run.revolutions": 10}),
}
CHAOTIC = {
    "rotor": {
        "kind": "planar",
        "mass": 1.0,
        "stiffness": [100.0, 140.0],
        "damping": 0.3,
        "unbalance": 0.05,
    },
    "balancer": [
        {
            "kind": "balls",
            "name": "weights",
            "count": 2,
            "mass": 0.5,
            "track_radius": 0.3,
            "drag": 0.02,
            "angles": [0.3, 2.0],
        }
    ],
    "operation": {"speed": 9.0},
    "coupling": {"steps_per_rev": 40},
    "run": {"revolutions": 60},
}


def true_errors(scene, result):
    """Largest errors of a result's motion, by signal, against two integrations in one piece.

    With each, what the integrations themselves leave open.
    """
    start = scene.run.initial.motion()
    right, own = reference(scene.assembly(), scene.profile(), result.time, initial=start)
    assert own < 1e-8
    names = [name for name in result.signals if not name.endswith(("angle", "clearance"))]
    found = {name: np.abs(right.signal(name) - result[name]).max() for name in names}
    return {name: (found[name], 3.0 * own * np.ptp(result[name])) for name in names}


@pytest.mark.parametrize("name", MEASURED)
def test_the_measured_error_is_the_true_one(name):
    bundled, changes = MEASURED[name]
    scene = load_scene(bundled).replace(changes)
    result = cosimulate(scene, verify=True)
    assert result.verification.parting is None
    for signal, (true, own) in true_errors(scene, result).items():
        # what the second run errs itself is added: a thirtieth
        assert result.error[signal] == pytest.approx(true, rel=0.1, abs=own), signal
        shared = max(np.ptp(result[other]) for other in kin(signal, result.signals))
        relative = result.verification.relative[signal]
        assert relative == pytest.approx(result.error[signal] / shared, rel=0.02)


def test_what_given_steps_do_not_see_is_measured():
    """Heavy drag takes these weights along within a tenth of the first step: error 5e-4, and at
    three times as many steps still.
    """
    liquid = {
        "kind": "liquid",
        "chamber_radius": 0.2001,
        "float_radius": 0.1645,
        "height": 0.005994,
        "density": 1000.0,
    }
    weights = {
        "kind": "rollers",
        "count": 2,
        "mass": 0.0004458,
        "track_radius": 0.2001,
        "drag": 2.582,
        "angles": [0.05141, 1.617],
        "speeds": [-121.2, 56.86],
    }
    rotor = {"kind": "planar", "mass": 22.76, "stiffness": [7407.2, 15993.5], "damping": 9.858}
    scene = Scene.from_document(
        {
            "rotor": {**rotor, "unbalance": 0.001616},
            "balancer": [liquid, weights],
            "operation": {"speed": 41.2},
            "coupling": {"steps_per_rev": 40},
            "run": {"revolutions": 2.051},
        }
    )
    result = cosimulate(scene, record=["rotor.x", "rotor.y"], verify=True)
    for signal, (true, own) in true_errors(scene, result).items():
        assert result.error[signal] == pytest.approx(true, rel=0.1, abs=own)
    assert result.verification.relative["rotor.y"] > 1e-4


def test_steps_as_long_as_may_be_are_shortened_all_the_same():
    """A smooth run takes the fewest steps there may be, and at a thirtieth as many."""
    scene = load_scene("liquid_heavy_force").replace(
        {**AUTO, "coupling.tolerance": 0.1, "liquid.density": 1.0, "run.revolutions": 5}
    )
    result = cosimulate(scene, verify=True)
    for signal, (true, own) in true_errors(scene, result).items():
        assert result.error[signal] == pytest.approx(true, rel=0.1, abs=own)


@pytest.mark.parametrize("restitution", [0.0, 0.3])
def test_the_error_of_weights_that_collide_is_right_within_a_factor_of_three(restitution):
    """Collisions are met; here against 32 times as many steps."""
    collide = {"balls.angles": [1.7, 2.6, 4.6], "balls.speeds": [8.0, -8.0, 0.0]}
    changes = {"run.revolutions": 4, "balls.restitution": restitution, **collide}
    scene = load_scene("finite_weights").replace(changes)
    result = cosimulate(scene, verify=True)
    right = cosimulate(scene.replace({"coupling.steps_per_rev": 32 * 40}))
    assert np.allclose(right.time[::32], result.time)
    for name, values in result.signals.items():
        true = float(np.abs(right[name][::32] - values).max())
        assert true / 3.0 < result.error[name] < 3.0 * true, name
    assert 1e-9 < max(result.verification.relative.values()) < 1e-6


@pytest.mark.parametrize("changes", [{}, {"coupling.steps_per_rev": 60}, {"operation.speed": 8.0}])
def test_chaotic_runs_part_at_the_rate_of_neighbouring_motions(changes):
    """That of a disturbance of 1e-9 in the motion integrated in one piece, over the same time."""
    scene = Scene.from_document(CHAOTIC).replace(changes)
    result = cosimulate(scene, verify=True)
    parting, speed = result.verification.parting, scene.operation.speed
    assert any("neighbouring motions diverge" in event for event in result.events)

    def grown(revolutions: float) -> float:
        ends = np.linspace(0.0, 2.0 * math.pi * revolutions / speed, 100)
        return math.log(growth(scene, ends))

    begin, end = 0.1 * parting.revolution, parting.revolution
    expected = (grown(end) - grown(begin)) / (end - begin)
    assert parting.rate == pytest.approx(expected, rel=0.4)  # rates vary along the motion
    for name in ("rotor.x", "weights.moment_xi"):
        assert result.error[name] > 0.1 * np.ptp(result[name])


def test_a_run_that_is_merely_coarse_does_not_part():
    """Held signals err by the size of the motion itself, and from the first revolution on."""
    scene = load_scene("two_balls").replace({"coupling.order": 0, "coupling.steps_per_rev": 4})
    result = cosimulate(scene, verify=True)
    assert max(result.verification.relative.values()) > 0.1
    assert result.verification.parting is None
    for signal, (true, own) in true_errors(scene, result).items():
        assert result.error[signal] == pytest.approx(true, rel=0.1, abs=own)


def test_without_verify_nothing_is_measured_and_nothing_else_changes():
    scene = load_scene("two_balls").replace({"run.revolutions": 2})
    plain, verified = cosimulate(scene), cosimulate(scene, verify=True)
    assert plain.error is None
    assert plain.verification is None
    assert set(verified.error) == set(plain.signals)
    for name, values in plain.signals.items():
        assert np.array_equal(values, verified[name])


def test_a_balanced_rotor_at_rest_has_no_relative_error():
    balanced = [2.0 * math.pi / 3.0, 4.0 * math.pi / 3.0]
    scene = load_scene("two_balls").replace({"weights.angles": balanced})
    verification = cosimulate(scene, verify=True).verification
    assert max(verification.relative.values()) < 0.01
    assert verification.parting is None


def test_nothing_recorded_cannot_be_verified():
    with pytest.raises(UserError, match="nothing is recorded"):
        cosimulate("two_balls", record=[], verify=True)


def test_run_prints_errors_and_writes_them(tmp_path):
    target = tmp_path / "run.json"
    arguments = ["run", "two_balls", "--set", "run.revolutions=2", "--verify", "--json", target]
    outcome = CliRunner().invoke(program(), [str(a) for a in arguments])
    assert outcome.exit_code == 0, outcome.output
    assert "of range" in outcome.output
    assert "tolerance = 3.33e-06" in outcome.output
    document = json.loads(target.read_text(encoding="utf-8"), parse_constant=pytest.fail)
    scene = load_scene("two_balls").replace({"run.revolutions": 2})
    expected = cosimulate(scene, verify=True)
    for name, signal in document["signals"].items():
        assert signal["error"] == expected.error[name]
    assert document["verification"]["parting"] is None


@pytest.mark.parametrize(("steps", "told"), [(8, True), (10, False)])
def test_few_given_steps_are_told_of_where_nothing_estimates_what_gathers(steps, told):
    """On this shaft 8 err by 2 % of the range of a ball that hardly moves, which no step shows."""
    changes = {"coupling.steps_per_rev": steps, "run.revolutions": 2}
    result = cosimulate(load_scene("grinder").replace(changes))
    assert any("steps per revolution are few" in event for event in result.events) is told
