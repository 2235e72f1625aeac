"""What the composite cannot compute correctly ends as an error with its reason, or is said."""

from __future__ import annotations

import time as clock
from dataclasses import replace

import pytest

from autobalancer.harness import load_scene
from autobalancer.harness.master.one_file import composition

WRONG = [
    ({"coupling.tolerance": 0.0}, "coupling.tolerance: must be above 0 and at most 0.1"),
    ({"coupling.tolerance": 0.11}, "coupling.tolerance: must be above 0 and at most 0.1"),
    ({"speed": 0.0, "coupling.top_speed": 0.0}, "coupling.top_speed: must be above 0 rad/s"),
    ({"rotor.mass": 0.0}, "rotor.mass = 0.0 kg: must be a finite number above 0 kg"),
    ({"weights.kappa": 0.5}, "weights.kappa = 0.5: must be a finite number, at least 1"),
    ({"weights.weight_radius": 2.0}, "weights: weight_radius = 2.0 m: such weights do not fit"),
]


@pytest.mark.parametrize(("values", "reason"), WRONG)
def test_wrong_parameters_are_refused_by_the_names_they_have_here(instance, values, reason):
    host = instance(load_scene("two_balls"))
    assert reason in host.refused(lambda: host.begin(values))


@pytest.mark.parametrize("step", [1e18, 6e6])
def test_a_step_that_would_take_minutes_is_refused(instance, step):
    host = instance(load_scene("two_balls")).begin()
    begun = clock.process_time()
    assert "is too long: the rotor may turn 2.5e6 times" in host.refused(lambda: host.step(step))
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
