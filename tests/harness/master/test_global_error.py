"""A tolerance is kept at the end of a run, whatever becomes of errors on the way."""

import numpy as np
import pytest

from autobalancer.harness import Scene, load_scene
from autobalancer.harness.errors import LoopError
from autobalancer.harness.master.cosimulation import CoSimulation
from autobalancer.harness.master.one_file_run import OneFileRun
from autobalancer.harness.master.recorder import Recorder, recorded
from autobalancer.harness.result.run import cosimulate
from autobalancer.models.monolith import reference, simulate
from tests.studies.truth.judge import deviations, motion

pytestmark = pytest.mark.slow

UNSTABLE = Scene.from_document(  # a disturbance grows 1,900-fold
    {
        "rotor": {
            "kind": "planar",
            "mass": 1.0,
            "stiffness": [1900.0, 6300.0],
            "damping": 6.3,
            "unbalance": 0.37,
        },
        "balancer": [
            {"kind": "pendulums", "count": 1, "mass": 3.4, "track_radius": 0.2, "drag": 6.8}
        ],
        "operation": {"speed": 100.0},
        "run": {"revolutions": 8.0},
    }
)


def error_of(scene, result):
    return max(deviations(result, motion(scene, result)).values())


@pytest.mark.parametrize("tolerance", [1e-1, 1e-2])
def test_steps_that_are_taken_back_do_not_loosen_those_to_come(tolerance):
    """Rejected trials under a loose tolerance reach a thousand times the forces there are."""
    scene = UNSTABLE.replace({"coupling.tolerance": tolerance})
    with OneFileRun(scene) as cosim:
        cosim.start()
        cosim.record(Recorder(cosim.units, []), None)
        assert cosim.facts().steps < 300
    assert error_of(scene, cosimulate(scene)) < tolerance


@pytest.mark.parametrize("separate", [False, True])
@pytest.mark.parametrize(
    ("name", "tolerance"),
    [("two_balls", 1e-3), ("run_up", 1e-3), ("two_plane_rodrigues", 1e-3), ("two_balls", 1e-6)],
)
def test_the_error_stated_is_the_true_one(name, tolerance, separate):
    scene = load_scene(name).replace(
        {"coupling.corrections": None, "coupling.tolerance": tolerance, "run.revolutions": 5}
    )
    result = cosimulate(scene, separate=separate)
    true = error_of(scene, result)
    assert true <= tolerance
    assert result.estimated_error <= tolerance
    # in one piece that of the run before, whose steps erred a hundred times as much
    caution = 10.0 if separate else 1e3
    assert true / 3.0 < result.estimated_error < caution * true


def test_a_run_whose_motions_part_states_the_size_of_the_error():
    """With less damping a disturbance grows more than any steps can make up for."""
    many = {"run.revolutions": 40, "rotor.damping": 1.0, "coupling.tolerance": 1e-4}
    result = cosimulate(UNSTABLE.replace(many))
    (note,) = result.events
    assert note.startswith(
        "tolerance = 0.0001 is not kept: runs with ever shorter steps still differ"
    )
    assert "smaller run.revolutions" in note
    assert result.estimated_error > 0.03


def test_motions_that_part_state_the_size_of_the_error_where_finer_steps_fail(monkeypatch):
    """A finer run would say no more; whether its loop converges at every impact is chance."""
    begin, begun = CoSimulation.start, []

    def start(self, *arguments, parts=1, **options):
        begun.append(parts)
        if parts >= 32:
            raise LoopError("the loop did not converge")
        begin(self, *arguments, parts=parts, **options)

    monkeypatch.setattr(CoSimulation, "start", start)
    many = {"run.revolutions": 40, "rotor.damping": 1.0, "coupling.tolerance": 1e-4}
    result = cosimulate(UNSTABLE.replace(many), separate=True)
    assert begun[-1] == max(n for n in begun if n < 32) < max(begun)
    assert result.estimated_error > 0.03
    assert result.steps == len(result.time) - 1
    assert result.events[0].startswith("tolerance = 0.0001 is not kept: runs with ever shorter")


def test_a_tolerance_is_kept_at_the_end_of_a_run_up_under_heavy_drag():
    document = {
        "rotor": {
            "kind": "planar", "mass": 5.293, "stiffness": [3520.12, 1535.28],
            "damping": [0.02306, 0.2073], "unbalance": 2.427e-6,
        },
        "balancer": [{
            "kind": "pendulums", "count": 1, "mass": 0.327, "track_radius": 0.1492,
            "drag": 10440.0, "angles": [4.76],
        }],
        "operation": {"run_up": {"from": 0.0, "to": 135.7, "seconds": 0.01076}, "gravity": 1.955},
        "run": {"revolutions": 0.34},
        "coupling": {"tolerance": 1e-6},
    }  # fmt: skip
    assert cosimulate(Scene.from_document(document)).estimated_error < 1e-6


COLLIDING = {
    "rotor": {"kind": "planar", "mass": 3.405, "stiffness": 1067.0, "unbalance": 0.004973},
    "balancer": [
        {
            "kind": "pendulums",
            "count": 2,
            "mass": 0.0523,
            "track_radius": 0.06065,
            "weight_radius": 0.02104,
            "angles": [4.2185, 5.3106],
            "restitution": 1.0,
            "speeds": [-8.7514, 23.1802],
        }
    ],
    "operation": {"speed": 74.25},
    "run": {"revolutions": 5.481},
}


def test_collisions_are_met_by_default_and_keep_the_tolerance_within_a_factor_of_3():
    """Against the coupled equations integrated from contact to contact."""
    scene = Scene.from_document(COLLIDING)
    result = cosimulate(scene)
    assert not result.events
    true, _ = reference(scene.assembly(), scene.profile(), result.time)
    for name in ("weight[1].angle", "weight[2].angle"):
        angle = result[f"pendulums.{name}"]
        off = np.abs(angle - true.signal(f"pendulums.{name}"))
        assert off.max() < 3.0 * 1e-4 * np.abs(angle).max()


def test_supports_that_turn_round_at_the_end_of_a_step_keep_the_tolerance():
    """The forces decide whether they still do within it: there, no forces agree with themselves."""
    scene = load_scene("two_balls").replace(
        {
            "weights.speeds": [2.0, -1.0],
            "rotor.friction": [{"limit": 0.018}],
            "coupling.scheme": "auto",
            "coupling.corrections": None,
            "coupling.steps_per_rev": None,
            "coupling.tolerance": 1e-5,
            "run.revolutions": 5.0,
        }
    )
    result = cosimulate(scene)
    assert not result.events
    profile, some = scene.profile(), slice(None, None, 100)
    true = simulate(scene.assembly(), profile, result.time[some], rtol=1e-10)
    size = max(np.abs(true["rotor.x"]).max(), np.abs(true["rotor.y"]).max())
    for name in ("rotor.x", "rotor.y"):
        assert np.abs(result[name][some] - true[name]).max() < 3e-5 * size


def test_no_collision_takes_or_gives_energy():
    """Elastic and undamped: E - w L, the energy seen from the rotor, stays as it was."""
    scene = Scene.from_document(COLLIDING | {"coupling": {"steps_per_rev": 80}})
    rotor, device, speed = scene.rotor, scene.assembly().weights[0].device, 74.25
    record = ["rotor.x", "rotor.y", "rotor.vx", "rotor.vy"]
    record += [f"pendulums.weight[{k}].{what}" for k in (1, 2) for what in ("angle", "speed")]
    run = cosimulate(scene, record=record)
    z, v = run["rotor.x"] + 1j * run["rotor.y"], run["rotor.vx"] + 1j * run["rotor.vy"]
    turned = np.exp(1j * speed * run.time)
    heavy, pulled = 1j * speed * turned, 0.004973
    energy = 0.5 * rotor.mass * np.abs(v) ** 2 + pulled * (v * heavy.conj()).real
    energy += 0.5 * 1067.0 * np.abs(z) ** 2
    turn = rotor.mass * (z.conj() * v).imag
    turn += pulled * ((z.conj() * heavy).imag + (turned.conj() * v).imag)
    for k in (1, 2):
        rate = run[f"pendulums.weight[{k}].speed"] + speed
        arm = device.track_radius * np.exp(1j * run[f"pendulums.weight[{k}].angle"]) * turned
        own = v + 1j * rate * arm
        energy += 0.5 * device.mass * np.abs(own) ** 2
        turn += device.mass * ((z + arm).conj() * own).imag
    seen = energy - speed * turn
    np.testing.assert_allclose(seen, seen[0], rtol=1e-6)


@pytest.mark.parametrize(
    ("name", "engine"),
    [
        ("two_balls", CoSimulation),
        ("run_up", CoSimulation),
    ],
)
def test_a_run_that_begins_again_does_not_know_what_became_of_the_one_before(name, engine):
    scene = load_scene(name).replace({"coupling.tolerance": 1e-3, "run.revolutions": 2})

    def run(cosim, parts=1):
        recorder = Recorder(cosim.units, recorded(scene))
        cosim.start(attempt=0, parts=parts)
        cosim.record(recorder, None)
        return recorder

    with engine(scene) as cosim:
        run(cosim)
        late = run(cosim, 2)
    with engine(scene) as cosim:
        assert run(cosim, 2).rows == late.rows
