"""A scene run on its one file: the result of separate units, whatever is asked of it."""

from __future__ import annotations

import numpy as np
import pytest

from autobalancer.harness import SceneError, SimulationError, UserError, cosimulate, load_scene
from autobalancer.harness.result.run import refuse_separate


def test_a_machine_that_cannot_go_on_is_named_with_its_time():
    changes = {"rotor.stiffness": [1e59, 1e59], "run.revolutions": 30}
    scene = load_scene("two_balls").replace(changes)
    with pytest.raises(SimulationError, match="the motion at t = 0 s is not finite"):
        cosimulate(scene)


NOT_COVERED = [
    ({"coupling.units": "python"}, "coupling.units"),
]


@pytest.mark.parametrize(("changes", "key"), NOT_COVERED)
def test_a_scene_that_it_does_not_cover_is_refused_by_the_key(changes, key):
    scene = load_scene("two_balls").replace({**changes, "run.revolutions": 2})
    with pytest.raises(UserError, match=key), pytest.warns(DeprecationWarning, match="separate"):
        cosimulate(scene, one_file=True)


@pytest.mark.parametrize(("changes", "key"), NOT_COVERED)
def test_a_scene_that_it_does_not_cover_runs_on_separate_units(changes, key):
    scene = load_scene("two_balls").replace({**changes, "run.revolutions": 2})
    result = cosimulate(scene)
    assert result.calls
    assert len(result.units) == 2


def test_inputs_of_units_are_recorded_on_separate_units_alone():
    names = ["weights.a_xi"]
    with pytest.raises(SceneError, match=r"run\.record"):
        cosimulate("two_balls", record=names)
    assert len(cosimulate("two_balls", record=names, separate=True)["weights.a_xi"])


def test_ready_made_units_are_none_of_the_one_file(tmp_path):
    with pytest.raises(UserError, match="one of them"):
        refuse_separate(load_scene("two_balls"), tmp_path)


def test_any_variable_but_inputs_is_recorded_with_the_unit_it_has():
    names = ["rotor.mass", "weights.der(F_xi)", "rotor.plane[1].a_xi", "weights.weight[2].speed"]
    expected, found = (cosimulate("two_balls", record=names, separate=s) for s in (True, False))
    assert found.signal_units == expected.signal_units
    for name in names:
        assert found[name] == pytest.approx(expected[name], abs=3e-3 * np.ptp(expected[name]))


def test_the_fixture_runs_it(cosim):
    result = cosim("two_balls", **{"run.revolutions": 2})
    assert result.units == ("two_balls.fmu",)
    assert not result.calls
