"""Collisions: the error that a run states covers what its own runs differ by, or is not known."""

from __future__ import annotations

import numpy as np
import pytest

import autobalancer as ab
from autobalancer.harness.master import global_error
from autobalancer.harness.master.compared import largest_difference
from autobalancer.harness.master.cosimulation import CoSimulation
from autobalancer.harness.master.expectation import ORDER_OF_JUMPS, expectation
from autobalancer.harness.master.neighbours import RESOLVED, add_parting, turned
from autobalancer.harness.result.tables import as_json

pytestmark = pytest.mark.slow

TOLERANT = {
    "coupling.tolerance": 1e-4,
    "coupling.steps_per_rev": None,
    "coupling.corrections": None,
}


def colliding(rotor, balls, operation, revolutions):
    """Balls or rollers of a size on one plane."""
    return ab.Scene.from_document(
        {
            "rotor": {"kind": "planar", **rotor},
            "balancer": [{"name": "b", "count": len(balls["angles"]), **balls}],
            "operation": operation,
            "run": {"revolutions": revolutions},
        }
    )


FEW_IMPACTS = colliding(
    {
        "mass": 6.23620761501553,
        "stiffness": [123095.20096434357, 76923.67697819333],
        "damping": 459.89795636493875,
        "unbalance": 0.04521937774845061,
    },
    {
        "kind": "rollers",
        "mass": 0.12096853524025697,
        "track_radius": 0.24817224192966075,
        "weight_radius": 0.013825926558814504,
        "restitution": 0.1,
        "drag": 0.2049881267464504,
        "angles": [2.2193098516, 2.46578338477, 4.17816113631, 4.35464172701, 6.08964548353],
    },
    {"speed": 127.4966632531179},
    5.5680814717428255,
)
HARSH = colliding(
    {
        "mass": 7.607039490959682,
        "stiffness": [3092.049836206852, 3921.016828469015],
        "damping": 20.545833031344028,
        "unbalance": 0.11464802105415427,
    },
    {
        "kind": "balls",
        "mass": 1.1600549768165485,
        "track_radius": 0.07883078092264807,
        "weight_radius": 0.0178026797465822,
        "restitution": 0.0,
        "drag": 1.9386963204775531,
        "angles": [
            0.15673010326037415,
            2.335341591707495,
            3.4419288798114804,
            5.210395416760764,
            5.837387171187184,
        ],
        "speeds": [
            -41.44548142184988,
            -19.566477802157603,
            -24.199334837358897,
            42.200077188364574,
            -12.124800687489726,
        ],
    },
    {"speed": 42.872846848914385, "gravity": 3.590987808466584},
    33.51418572703491,
)


def test_the_error_that_a_run_states_covers_what_a_smaller_tolerance_changes():
    runs = [FEW_IMPACTS.replace({"coupling.tolerance": t}).run() for t in (1e-4, 1e-6)]
    angles = [f"b.weight[{k}].angle" for k in range(1, 6)]
    ends = [np.array([run[name][-1] for name in angles]) for run in runs]
    assert np.abs(ends[1] - ends[0]).max() <= 3.0 * runs[0].estimated_error


@pytest.mark.parametrize("separate", [False, True])
def test_a_run_whose_impacts_decide_says_that_its_error_is_not_known(separate):
    run = HARSH.replace({"coupling.tolerance": 1e-4}).run(separate=separate)
    assert not run.error_known
    assert any(note.startswith("the error of this run is not known: ") for note in run.events)
    assert as_json(run)["error_known"] is False
    assert as_json(run)["unknown_error"] == run.unknown_error
    with pytest.raises(AssertionError, match="the error of this run is not known"):
        run.assert_bounded("rotor.x", "1 nm")


def test_a_smooth_run_is_known_and_its_messages_do_not_speak_of_it():
    run = ab.load("two_balls").run()
    assert run.error_known
    with pytest.raises(AssertionError) as failure:
        run.assert_bounded("rotor.x", "1 nm")
    assert "not known" not in str(failure.value)


def test_angles_err_in_rad_and_other_signals_over_the_largest_of_their_kind():
    one = {"b.weight[1].angle": np.array([0.0, 50.0]), "rotor.x": np.array([0.0, 2.0])}
    one["rotor.y"] = np.array([0.0, 1e-3])
    least = {"b.weight[1].angle": 1.0, "rotor.x": 1e-9, "rotor.y": 1e-9}
    turned_by = {**one, "b.weight[1].angle": np.array([0.0, 50.01])}
    assert largest_difference(one, turned_by, least) == pytest.approx(0.01)
    moved = {**one, "rotor.y": np.array([0.0, 1e-3 + 0.02])}
    assert largest_difference(one, moved, least) == pytest.approx(0.01)


def test_a_neighbour_starts_within_what_is_resolved_and_is_the_same_machine():
    near = turned(FEW_IMPACTS, RESOLVED)
    before, after = (np.array(s.balancer[0].angles) for s in (FEW_IMPACTS, near))
    assert 0.0 < np.abs(after - before).max() <= RESOLVED
    assert len(set(np.round((after - before) / RESOLVED, 3))) == 5, "no turn of all together"
    assert near.rotor == FEW_IMPACTS.rotor


def test_collisions_are_expected_to_converge_by_order_one_and_smooth_runs_by_four():
    assert expectation(FEW_IMPACTS, meets_events=True).order == ORDER_OF_JUMPS
    smooth = expectation(ab.load("two_balls"), meets_events=True)
    assert smooth.order == 4
    assert not smooth.can_collide


def counted_starts(monkeypatch):
    """Starts of separate FMUs from here on."""
    starts, start = [], CoSimulation.start

    def counted(self, *args, **options):
        starts.append(self.scene)
        start(self, *args, **options)

    monkeypatch.setattr(CoSimulation, "start", counted)
    return starts


def test_separate_units_run_twice_where_weights_collide_and_one_file_runs_their_neighbours(
    monkeypatch,
):
    starts = counted_starts(monkeypatch)
    run = ab.load("contact_order").replace(TOLERANT).run(separate=True)
    assert len(starts) == 2
    assert run.error_known
    assert 0.0 < run.estimated_error < 1e-4


def test_units_that_one_file_does_not_have_run_their_neighbours_themselves(monkeypatch):
    monkeypatch.setattr(global_error, "why_separate", lambda _scene: "a part of any origin")
    starts = counted_starts(monkeypatch)
    run = ab.load("contact_order").replace(TOLERANT).run(separate=True)
    angles = [scene.balancer[0].angles[0] for scene in starts]
    assert len(angles) == 4
    assert angles[0] == angles[1] != angles[2] != angles[3]
    assert run.error_known


def test_neighbours_that_part_from_each_other_leave_the_error_unknown():
    own, one, other = ({"b.weight[1].angle": np.array([0.0, x])} for x in (1.0, 1.01, 0.99))
    scale = {"b.weight[1].angle": 1.0}
    assert add_parting(1e-5, own, [one, other], scale, 1e-4) == (
        pytest.approx(0.01),
        "runs with weights that start 1e-8 rad elsewhere end 0.01 away",
    )
    assert add_parting(1e-5, own, [one, one], scale, 1e-4) == (pytest.approx(0.01), "")
    assert add_parting(1e-5, own, [own, own], scale, 1e-4) == (1e-5, "")
    assert add_parting(0.2, own, [own, own], scale, 1e-4)[1].endswith("steps differ by 0.2")
