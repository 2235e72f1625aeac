"""What the composite cannot compute correctly ends as an error with its reason, or is said."""

from __future__ import annotations

import math
import time as clock
from dataclasses import replace

import pytest
from fmpy import platform_tuple, simulate_fmu
from fmpy.fmi1 import FMICallException

from autobalancer.harness import Scene, cosimulate, load_scene
from autobalancer.harness.errors import SimulationError
from autobalancer.harness.export.one_file import build_one_file
from autobalancer.harness.master.one_file import composition
from autobalancer.models.constants import STATED_ERROR


def stepped(host, scene: Scene, revolutions: float) -> None:
    """At the scene's own steps."""
    step = 2.0 * math.pi / scene.profile().speed(0.0) / scene.coupling.steps_per_rev
    for _ in range(round(revolutions * scene.coupling.steps_per_rev)):
        host.step(step)


COARSE = [
    ("two_balls", 20),
    ("two_balls", 6),
    ("goncharov_balls", 4),
    ("two_plane_rodrigues", 5),
    ("liquid_heavy_force", 8),
]


@pytest.mark.parametrize(("name", "steps"), COARSE)
def test_the_error_of_given_steps_is_estimated_and_logged(instance, name, steps):
    """As the harness states it, whose estimate is compared with the real error elsewhere."""
    changes = {"coupling.steps_per_rev": steps, "run.revolutions": 4}
    scene = load_scene(name).replace(changes)
    expected = cosimulate(scene).estimated_error
    host = instance(scene).begin()
    stepped(host, scene, 4)
    assert host.get("coupling.error") == [pytest.approx(expected, rel=1e-6)]
    logged = any("too long" in text for _, text in host.messages)
    assert logged == (expected >= STATED_ERROR)


REFUSED = [
    ("liquid_heavy_force", {"coupling.scheme": "iterated", "coupling.corrections": 0}),
    (
        "two_balls",
        {
            "coupling.steps_per_rev": 4,
            "operation.speed": 30.0,
            "weights.drag": 0.0,
            "rotor.stiffness": [1e6, 1e6],
            "rotor.damping": [0.0, 0.0],
        },
    ),
    (
        "goncharov_balls",
        {"coupling.steps_per_rev": 4, "rotor.stiffness": 3e9, "rotor.damping": 0.0},
    ),
]


@pytest.mark.parametrize(("name", "changes"), REFUSED)
def test_a_run_that_the_harness_refuses_is_refused_in_the_same_words(instance, name, changes):
    scene = load_scene(name).replace({**changes, "run.revolutions": 30})
    with pytest.raises(SimulationError) as refusal:
        cosimulate(scene)
    host = instance(scene).begin()
    reason = host.refused(lambda: stepped(host, scene, 30))
    assert f"loop gain {host.get('coupling.loop_gain')[0]:.3g}" in reason
    part = str(refusal.value).split(": ")[1].split(";")[0]
    assert part in reason


def test_after_a_refusal_the_state_is_that_before(instance):
    scene = load_scene("liquid_heavy_force").replace(REFUSED[0][1])
    host = instance(scene).begin()
    step = 2.0 * math.pi / scene.profile().speed(0.0) / 7.3
    seen = []

    def run() -> None:
        for _ in range(100):
            seen.append(host.outputs())
            host.step(step)

    host.refused(run)
    assert host.outputs() == seen[-1]


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_tool_that_repeats_discarded_steps_ends_too(tmp_path, fmi):
    """FMPy repeats for ever what FMI 2.0 lets it try again."""
    scene = load_scene("liquid_heavy_force").replace(REFUSED[0][1])
    path = build_one_file(scene, tmp_path / "one.fmu", fmi, platforms=[platform_tuple])
    with pytest.raises(FMICallException, match=f"fmi{fmi}DoStep.*error"):
        simulate_fmu(path, stop_time=1.0, output_interval=1e-3, timeout=10.0)


WRONG = [
    ({"coupling.steps_per_rev": 0.0}, "coupling.steps_per_rev"),
    ({"coupling.steps_per_rev": -1.0}, "coupling.steps_per_rev = -1.0: must be"),
    ({"coupling.steps_per_rev": 3.0}, "coupling.steps_per_rev: must be 0 (not used) or at least 4"),
    ({"coupling.steps_per_rev": 30.0, "coupling.tolerance": 1e-4}, "one must be above 0; set only"),
    ({"coupling.tolerance": 0.11}, "must be at most 0.1"),
    ({"speed": 0.0, "coupling.top_speed": 0.0}, "coupling.top_speed: must be above 0 rad/s"),
    ({"rotor.mass": 0.0}, "rotor.mass = 0.0 kg: must be a finite number above 0 kg"),
    ({"weights.kappa": 0.5}, "weights.kappa = 0.5: must be a finite number, at least 1"),
    ({"weights.weight_radius": 2.0}, "weights: weight_radius = 2.0 m: such weights do not fit"),
]


@pytest.mark.parametrize(("values", "reason"), WRONG)
def test_wrong_parameters_are_refused_by_the_names_they_have_here(instance, values, reason):
    host = instance(load_scene("two_balls"))
    assert reason in host.refused(lambda: host.begin(values))


@pytest.mark.slow
@pytest.mark.parametrize(("step", "reason"), [(1e18, "too short"), (2e6, "too many steps")])
def test_a_step_that_would_take_minutes_is_refused(instance, step, reason):
    host = instance(load_scene("two_balls")).begin()
    begun = clock.process_time()
    assert reason in host.refused(lambda: host.step(step))
    assert clock.process_time() - begun < 60.0


@pytest.mark.parametrize(
    ("part", "change"),
    [(k, change) for k in (0, -1) for change in ({"exchanges_force": True}, {"plane": 1})],
)
def test_neither_rotor_nor_motor_lies_on_a_plane_or_exchanges_force(part, change):
    made = composition(load_scene("sommerfeld"))
    parts = list(made.parts)
    parts[part] = replace(parts[part], **change)
    with pytest.raises(ValueError, match="rotor and motor have plane 0 and exchange no force"):
        replace(made, parts=tuple(parts))
