"""Separate units at stops, dry supports and sticking weights, against integrations in one piece."""

from __future__ import annotations

import numpy as np
import pytest

import autobalancer as ab
from autobalancer.harness import Scene, cosimulate
from autobalancer.harness.master.event_steps import cover_events
from autobalancer.harness.master.fmu import EndedEarly
from autobalancer.models.monolith import simulate
from tests.studies.stops import reference

MOTION = ["rotor.x", "rotor.y"]
ANGLES = ["weights.weight[1].angle", "weights.weight[2].angle"]
TOUCHING = {
    "rotor": {
        "kind": "planar", "mass": 10.0, "stiffness": 9e3, "damping": 20.0, "unbalance": 5e-3,
        "stops": [{"support": 1, "gap": 5e-4, "stiffness": 9e4, "damping": 300.0, "kind": "x"}],
    },
    "balancer": [
        {"kind": "pendulums", "name": "weights", "count": 2, "mass": 0.1, "drag": 0.5,
         "track_radius": 0.1, "angles": [0.4, 2.5]}
    ],
    "operation": {"speed": 45.0},
    "run": {"revolutions": 8, "record": [*MOTION, *ANGLES]},
}  # fmt: skip
STICKING = {
    "rotor": {"kind": "planar", "mass": 2.0, "stiffness": 8e3, "damping": 40.0, "unbalance": 2e-3},
    "balancer": [
        {"kind": "balls", "name": "weights", "count": 2, "mass": 0.02, "track_radius": 0.1,
         "drag": 0.6, "angles": [0.4, 2.5], "rolling_resistance": 5e-3}
    ],
    "operation": {"speed": 150.0},
    "run": {"revolutions": 20, "record": ANGLES},
}  # fmt: skip
SLIDERS = {
    "with springs": {"support": 1, "limit": [6.0, 7.0], "stiffness": 1e5},
    "with a free stroke": {"support": 1, "limit": 6.0, "stiffness": 1e5, "free_stroke": 2e-4},
}


def in_steps(steps: int, document: dict = TOUCHING, scheme: str = "iterated") -> ab.Result:
    """A run of separate units."""
    given = {"steps_per_rev": steps, "scheme": scheme}
    return cosimulate(Scene.from_document({**document, "coupling": given}), separate=True)


def error(run: ab.Result, document: dict = TOUCHING) -> tuple[float, int]:
    """Largest error of x and y over the largest of them, and of angles [rad], and the events.

    Against SciPy from event to event, which shares no equation with the units.
    """
    states, held, _ = reference(Scene.from_document(document), np.asarray(run.time))
    size = np.abs(states[:2]).max()
    worst = max(
        float(np.abs(run[n] - own).max() / size) for n, own in zip(MOTION, states[:2], strict=True)
    )
    turned = np.array([held.profile.angle(t) for t in run.time])
    own = [np.abs(run[name] - states[4 + j] + turned).max() for j, name in enumerate(ANGLES)]
    return max(worst, *own), held.events


@pytest.mark.parametrize("scheme", ["iterated", "auto"])
def test_a_rotor_that_touches_its_stop_is_coupled_by_order_4(scheme):
    coarse, events = error(in_steps(40, scheme=scheme))
    fine, _ = error(in_steps(160, scheme=scheme))
    assert events > 10
    assert fine < min(1e-5, coarse / 4.0**3.3)


@pytest.mark.parametrize("slider", SLIDERS)
def test_a_support_that_sticks_and_slips_is_coupled_by_order_4(slider):
    rotor = {**TOUCHING["rotor"], "stops": [], "friction": [SLIDERS[slider]]}
    document = {**TOUCHING, "rotor": rotor}
    (coarse, events), (fine, _) = (error(in_steps(n, document), document) for n in (40, 160))
    assert events > 10
    assert fine < min(1e-5, coarse / 4.0**3.3)


def test_weights_that_stick_are_coupled_as_exactly():
    scene = Scene.from_document(STICKING)
    run = in_steps(80, STICKING)
    right = simulate(scene.assembly(), scene.profile(), [run.time[-1]], rtol=1e-11)
    assert np.abs(right.angle_rate["weights"][0]).min() < 1e-9
    ends = np.array([run[name][-1] for name in ANGLES])
    assert ends == pytest.approx(right.theta["weights"][0], abs=2e-8)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6])
def test_a_tolerance_is_kept_beside_a_stop_and_the_error_stated(tolerance):
    scene = Scene.from_document({**TOUCHING, "coupling": {"tolerance": tolerance}})
    run = cosimulate(scene, separate=True)
    true, _ = error(run)
    assert true < run.estimated_error <= tolerance
    assert not any("not kept" in note for note in run.events)


def test_a_motor_drives_a_rotor_against_its_stop_by_order_4():
    motor = {"inertia": 0.2, "stall_torque": 60.0, "no_load_speed": 54.0, "from": 30.0}
    document = {**TOUCHING, "operation": {"motor": motor}, "run": {"duration": 1.0}}
    ends = [in_steps(n, document) for n in (20, 80, 320)]
    coarse, fine = (abs(run["rotor.x"][-1] - ends[2]["rotor.x"][-1]) for run in ends[:2])
    assert fine < coarse / 4.0**3.3


def test_steps_end_before_events_and_lead_over_them():
    """A unit of its own with events at 0.3, at 0.3 less half a brief step and at the end."""
    step, brief, events = 1.0, 1e-6, [0.3, 0.3 + 0.5e-6, 0.7, 1.0 - 1e-7]
    now, taken = 0.0, []

    def advance(part: float, at_event: bool, tolerant: bool = False) -> bool:
        nonlocal now
        within = [at for at in events if now < at <= now + part]
        if within and part >= 3.0 * brief:
            raise EndedEarly("rotor", now, within[0] - now)
        taken.append((part, len(within)))
        now += part
        return True

    cover_events(step, brief, advance)
    assert now == pytest.approx(step, rel=1e-14)
    assert sum(within for _, within in taken) == len(events)
    assert all(part < 3.0 * brief for part, within in taken if within)
    assert len(taken) == 6
