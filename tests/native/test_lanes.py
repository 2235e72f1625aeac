"""Machines side by side in vector lanes have the bits that each has alone."""

from __future__ import annotations

import numpy as np
import pytest

from autobalancer.fmus.composite.batch import BatchRuns
from autobalancer.harness import load_scene
from autobalancer.harness.master.one_file import composition
from autobalancer.harness.master.schedule import end_time

CLOSE = {"coupling.scheme": "auto", "coupling.steps_per_rev": None, "coupling.tolerance": 1e-5}
# by scene: what differs; some of it changes order, length or kind of the computation
TABLES = {
    "two_balls": {
        "weights.drag": (0.004, 0.05),
        "rotor.stiffness_y": (20.0, 90.0),
        "coupling.tolerance": (1e-8, 1e-3),
    },
    "three_mass_shaft": {"left.drag": (0.005, 0.02)},
    "run_up": {"weights.drag": (0.1, 0.5)},
    "filimonikhina": {"rotor.unbalance": (0.01, 0.3)},
    "balls_and_liquid": {"balls.drag": (1e-5, 1e-4)},
    "sommerfeld": {"rotor.unbalance": (1e-4, 1e-3)},
    "two_plane_rodrigues": {"left.drag": (5e-5, 2e-4)},
}
RUNS, POINTS = 11, 90


# outputs at the end for which each step is looked at many times, and for which none is
LOOKED_AT, NOT_LOOKED_AT = ["vibration"], ["coupling.error"]


def batch(
    name: str,
    table: dict[str, tuple[float, float]],
    side: int,
    points: int = POINTS,
    last: list[str] = LOOKED_AT,
    **changes: object,
):
    """Outputs of runs with random values, those at the end, and why runs have failed."""
    scene = load_scene(name).replace({**CLOSE, "run.revolutions": 6, **changes})
    made, rng = composition(scene), np.random.default_rng(3)
    values = np.column_stack([rng.uniform(*limits, RUNS) for limits in table.values()])
    asked = [f"rotor.{v}" for v in ("x", "y") if f"rotor.{v}" in made.layout.index]
    asked = asked or ["rotor.station[1].x", "rotor.station[2].y"]
    last = ["coupling.steps", "rotor.angle", *last]
    runs = BatchRuns(made, list(table), asked, points, last=last, side_by_side=side)
    return runs.with_last(values, np.full(RUNS, end_time(scene)))


@pytest.mark.parametrize("name", TABLES)
def test_machines_side_by_side_have_the_bits_of_one_alone(name):
    alone = batch(name, TABLES[name], 1)
    assert alone[2] == [""] * RUNS
    assert len({row.tobytes() for row in alone[0]}) == RUNS
    for side in (2, 3, 4):
        beside = batch(name, TABLES[name], side)
        assert beside[0].tobytes() == alone[0].tobytes()
        assert beside[1].tobytes() == alone[1].tobytes()


# machines that stay in their lanes, and what ends that: hundreds of steps to a point, corners of
# the speed; and races with lobes
STAYING: dict[str, dict[str, object]] = {
    "two_balls": {"points": 2, "run.revolutions": 40},
    "three_mass_shaft": {"points": 33},
    "run_up": {"points": 50, "run.revolutions": 20},
    "oval_fan": {},
    "bristol": {"points": 60},
}


@pytest.mark.parametrize("name", STAYING)
def test_machines_that_stay_in_their_lanes_have_the_bits_of_one_alone(name):
    table = TABLES.get(name, {"weights.drag": (0.01, 0.02)})
    if name in ("oval_fan", "bristol"):
        table = {
            next(v for v in composition(load_scene(name)).layout.index if v.endswith(".drag")): (
                0.01,
                0.02,
            )
        }
    alone, *others = (
        batch(name, table, side, last=NOT_LOOKED_AT, **STAYING[name]) for side in (1, 2, 3, 4)
    )
    assert alone[2] == [""] * RUNS
    for beside in others:
        assert beside[0].tobytes() == alone[0].tobytes()
        assert beside[1].tobytes() == alone[1].tobytes()


@pytest.mark.parametrize(
    ("name", "table", "changes"),
    [
        ("two_balls", TABLES["two_balls"], {"points": 3, "run.revolutions": 30}),
        ("run_up", TABLES["run_up"], {"run.revolutions": 20}),
        ("three_mass_shaft", TABLES["three_mass_shaft"], {}),
        ("balls_and_liquid", TABLES["balls_and_liquid"], {"run.revolutions": 30}),
        # the float touches: steps are then looked at again
        ("liquid_touch", {"rotor.unbalance": (1e-3, 1e-2)}, {"run.revolutions": 30}),
    ],
)
def test_smooth_steps_have_the_bits_of_steps_that_are_looked_at(name, table, changes):
    looked_at = batch(name, table, 1, **changes)
    smooth = batch(name, table, 1, last=NOT_LOOKED_AT, **changes)
    assert looked_at[0].tobytes() == smooth[0].tobytes()
    assert looked_at[1][:, :2].tobytes() == smooth[1][:, :2].tobytes()
    assert looked_at[2] == smooth[2]


def test_a_change_of_the_unbalance_ends_a_stay_in_the_lanes():
    """The times of the change and the ends of the runs differ; angles of weights are read, too."""
    changes = [{"time": 2.0, "amount": 0.01, "angle": 0.5}]
    scene = load_scene("two_balls").replace(
        {**CLOSE, "run.revolutions": 12, "operation.unbalance_changes": changes}
    )
    made, rng = composition(scene), np.random.default_rng(8)
    values = rng.uniform(1.0, 9.0, (RUNS, 1))
    ends = end_time(scene) * rng.uniform(0.5, 1.0, RUNS)
    asked = ["rotor.y", "weights.weight[2].angle", "rotor.x"]
    found = []
    for side in (1, 4):
        runs = BatchRuns(
            made,
            ["unbalance_change[1].time"],
            asked,
            POINTS,
            last=["coupling.steps"],
            side_by_side=side,
        )
        found.append(runs.with_last(values, ends))
    assert found[0][2] == [""] * RUNS
    assert found[0][0].tobytes() == found[1][0].tobytes()
    assert found[0][1].tobytes() == found[1][1].tobytes()


def test_a_run_that_fails_leaves_its_lane_to_the_next():
    """Negative drag is refused, too fast a growth is not finite; the others go on as alone."""
    table = {"weights.drag": (-0.05, 0.05)}
    signals, last, reasons = batch("two_balls", table, 4)
    alone = batch("two_balls", table, 1)
    failed = [bool(reason) for reason in reasons]
    assert 0 < sum(failed) < RUNS
    assert reasons == alone[2]
    assert np.isnan(signals).any(axis=(1, 2)).tolist() == failed
    assert np.isnan(last).any(axis=1).tolist() == failed
    assert signals.tobytes() == alone[0].tobytes()


def test_lanes_of_other_kinds_go_on_beside_each_other():
    """An offset track, or a speed that changes, is computed otherwise than none."""
    table = {"weights.track_offset_xi": (-1e-3, 1e-3), "weights.drag": (0.01, 0.02)}
    scene = load_scene("two_balls").replace({**CLOSE, "run.revolutions": 6})
    rng = np.random.default_rng(5)
    values = np.column_stack([rng.uniform(*limits, RUNS) for limits in table.values()])
    values[::3, 0] = 0.0
    ends = np.full(RUNS, end_time(scene))
    found = [
        BatchRuns(composition(scene), list(table), ["rotor.x"], POINTS, side_by_side=side)(
            values, ends
        )[0]
        for side in (1, 4)
    ]
    assert found[0].tobytes() == found[1].tobytes()


def test_cross_terms_of_bearings_act_in_every_lane():
    """They differ between lanes, and without them the motion is another."""
    bearings = [
        {
            "support": k,
            "stiffness": [[1.0, 0.2], [-0.1, 1.1]],
            "damping": [[0.2, 0.03], [0.01, 0.2]],
        }
        for k in (1, 2)
    ]
    changes = {"rotor.bearings": bearings}
    changes |= dict.fromkeys(("rotor.support_stiffness", "rotor.support_damping"))
    table = {
        "rotor.stiffness_xy[1,1]": (0.05, 0.3),
        "rotor.damping_yx[3,3]": (-0.05, 0.05),
    }
    alone, *others = (batch("three_mass_shaft", table, side, **changes) for side in (1, 2, 3, 4))
    assert alone[2] == [""] * RUNS
    assert len({row.tobytes() for row in alone[0]}) == RUNS
    for beside in others:
        assert beside[0].tobytes() == alone[0].tobytes()
        assert beside[1].tobytes() == alone[1].tobytes()
    plain = dict.fromkeys(table, (0.0, 0.0))
    straight = batch("three_mass_shaft", plain, 4, **changes)
    assert np.abs(straight[0] - alone[0]).max() > 1e-4 * np.abs(alone[0]).max()


def test_gravity_acts_in_every_lane():
    table = {"weights.drag": (0.01, 0.05)}
    heavy, beside = (
        batch("two_balls", table, side, **{"operation.gravity": 0.1}) for side in (1, 4)
    )
    assert heavy[0].tobytes() == beside[0].tobytes()
    assert heavy[0].tobytes() != batch("two_balls", table, 1)[0].tobytes()
