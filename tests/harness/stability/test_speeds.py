"""Critical speeds from the motion of the coupled units, against Floquet and closed forms."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from autobalancer.harness import SimulationError, UserError, check, load_scene, speeds
from autobalancer.harness.checks.critical_speeds import needed_revolutions
from autobalancer.harness.stability.crossings import Measured, measured_regions, nodes_around
from autobalancer.harness.stability.growth_search import GrowthSearch
from autobalancer.harness.stability.main_motion import MainMotion, NoMainMotion
from autobalancer.harness.stability.revolution import Revolution
from autobalancer.harness.stability.speeds import Speeds
from autobalancer.models.linear.balanced import balanced_angles
from autobalancer.models.linear.growth import Growth
from autobalancer.models.linear.linearised import linearise
from autobalancer.models.linear.regions import Crossing
from autobalancer.models.spacing import closest
from autobalancer.models.stability import growth_rates
from tests.floquet import multipliers

pytestmark = pytest.mark.slow

MANY = {  # N weights of the same total mass, next to positions that are not on one line
    2: [0.3, 1.0],
    3: [0.3, 1.9, 4.2],
    4: [0.3, 1.9, 3.5, 5.0],
    6: [0.3, 1.2, 2.1, 3.3, 4.4, 5.6],
}


def weights(count: int):
    return load_scene("filimonikhina").replace(
        {
            "weights.count": count,
            "weights.mass": 0.01 / count,
            "weights.drag": 0.005 / count,
            "weights.angles": MANY[count],
        }
    )


def angles_of(motion: MainMotion) -> list[int]:
    """Places of the weights' angles among the states."""
    return [i for i, s in enumerate(motion.units.states) if s.output.endswith("].angle")]


# -- main motion and multipliers ------------------------------------------------------------------


@pytest.mark.parametrize("count", [2, 3, 4, 6])
def test_multipliers_are_those_of_floquet_but_for_turns_that_change_no_moment(count):
    scene = weights(count)
    with MainMotion(scene) as motion:
        assert motion.neutral.shape[1] == count - 2 == linearise(scene.assembly()).neutral
        found, state = motion.multipliers(3.0), motion.state[angles_of(motion)]
    balanced = scene.replace({"weights.angles": state.tolist()}).assembly()
    np.testing.assert_allclose(balanced_angles(balanced), state, atol=1e-9)
    expected = multipliers(balanced, [3.0])[0]
    assert len(found) == len(expected) - (count - 2)
    assert abs(found[0]) < 1.0, "nothing that does not decay is left"
    # a multiple multiplier (weights' free rates) is split by the root of the differences' error
    for value in found:
        assert np.abs(expected - value).min() < (1e-6 if count == 2 else 1e-4)


def test_neutral_multiplier_does_not_hide_a_growing_one():
    scene = weights(4)
    with MainMotion(scene) as motion:
        found, state = motion.growth(7.0), motion.state[angles_of(motion)]
    balanced = scene.replace({"weights.angles": state.tolist()}).assembly()
    assert found == pytest.approx(float(growth_rates(balanced, 7.0)[0]), rel=1e-6)
    assert found > 0.1


class PulledBack(Revolution):
    """Weights that also creep back to where they balance: nothing that a moment tells of."""

    share, places = 0.0, None

    def __call__(self, states, speed):
        ends = super().__call__(states, speed)
        if self.places is not None:
            ends[:, 4::2] -= self.share * (states[:, 4::2] - self.places)
        return ends


@pytest.mark.parametrize(("share", "refused"), [(1e-3, True), (3e-5, True), (3e-7, False)])
def test_turns_taken_for_neutral_that_do_not_come_back_are_refused(monkeypatch, share, refused):
    scene = weights(4)
    with MainMotion(scene) as motion:
        places = motion.state[4::2]
    monkeypatch.setattr(PulledBack, "share", share)
    monkeypatch.setattr(PulledBack, "places", places)
    monkeypatch.setattr("autobalancer.harness.stability.main_motion.Revolution", PulledBack)
    if refused:
        with pytest.raises(SimulationError, match="without a change of their moment"):
            MainMotion(scene)
    else:
        MainMotion(scene).close()


def test_a_motion_that_dies_within_a_revolution_has_a_rate_that_is_a_number(monkeypatch):
    with MainMotion(load_scene("filimonikhina")) as motion:
        monkeypatch.setattr(motion, "multipliers", lambda speed: np.zeros(1, complex))
        assert -math.inf < motion.growth(3.0) < -300.0


def test_length_of_a_run_is_that_in_which_the_slowest_motion_dies():
    """60 revolutions and e^-9; at a boundary no length is enough, and 3000 is the longest."""
    assert needed_revolutions(-0.1, 2.0 * math.pi) == 60 + 90
    assert needed_revolutions(0.1, 4.0 * math.pi) == 60 + 180
    assert needed_revolutions(0.0, 1.0) == needed_revolutions(1e-12, 1.0) == 3000


def test_too_large_an_unbalance_is_said_to_have_no_main_motion():
    with pytest.raises(NoMainMotion, match="can make at most"):
        MainMotion(load_scene("filimonikhina").replace({"rotor.unbalance": 0.011}))


def test_units_that_do_not_rest_where_the_weights_should_balance_are_refused(monkeypatch):
    monkeypatch.setattr(
        "autobalancer.harness.stability.main_motion.balanced_angles", lambda _: np.array([2.0, 4.0])
    )
    with pytest.raises(NoMainMotion, match="the rotor does not rest"):
        MainMotion(load_scene("filimonikhina"))


def test_steps_that_do_not_resolve_the_rotor_are_refined():
    scene = load_scene("filimonikhina").replace({"coupling.steps_per_rev": 8})
    with MainMotion(scene) as motion:
        assert motion.growth(0.3) == pytest.approx(growth_rates(scene.assembly(), 0.3)[0], rel=1e-2)
        assert motion.units.steps == 8


@pytest.mark.parametrize("count", [4, 5, 6, 7])
def test_balls_of_finite_size_balance_side_by_side_and_units_grow_as_floquet_says(count):
    """Points at the nearest balanced angles would overlap."""
    scene = load_scene("finite_weights").replace({"balls.count": count, "balls.angles": None})
    speed = scene.profile().end
    with MainMotion(scene) as motion:
        touching = 2.0 * scene.balancer[0].half_angle
        assert closest(motion.state[angles_of(motion)])[0] > touching + 1e-3
        found = motion.growth(speed)
    assert found == pytest.approx(float(growth_rates(scene.assembly(), speed)[0]), rel=1e-3)


# -- speeds ---------------------------------------------------------------------------------------


def test_three_methods_stand_side_by_side():
    found = speeds(load_scene("filimonikhina"), (0.5, 12.0))
    assert list(found.methods) == ["criterion", "floquet", "cosim"]
    np.testing.assert_allclose(
        [c.speed for c in found.methods["criterion"]], [1.0026, 5.0407, 6.9254], rtol=1e-4
    )
    for method in ("floquet", "cosim"):
        np.testing.assert_allclose(
            [c.speed for c in found.methods[method]], [1.0143, 5.0499, 8.3223], rtol=1e-4
        )
        assert [c.above for c in found.methods[method]] == ["stable", "unstable", "stable"]
    assert found.lowest == {"criterion": "unstable", "floquet": "unstable", "cosim": "unstable"}
    assert all(len(row) == 3 for row in found.rows())


def test_units_alone_find_the_speeds_by_a_scan_of_their_own():
    found = speeds(load_scene("filimonikhina"), (4.0, 9.0), ["cosim"], narrowest=0.5)
    np.testing.assert_allclose(
        [c.speed for c in found.methods["cosim"]], [5.04992967, 8.32228599], rtol=1e-6
    )


def test_a_method_that_does_not_apply_says_why():
    found = speeds(load_scene("drum"), (100.0, 110.0), ["criterion"])
    assert "stations" in found.refused["criterion"]
    damped = load_scene("filimonikhina").replace({"rotor.internal_damping": 0.1})
    found = speeds(damped, (2.0, 3.0), ["criterion"])
    assert "internal damping" in found.refused["criterion"]
    heavy = load_scene("filimonikhina").replace({"rotor.unbalance": 0.011})
    found = speeds(heavy, (2.0, 3.0), ["floquet", "cosim"])
    assert set(found.refused) == {"floquet", "cosim"}
    assert not found.methods


def test_methods_that_fail_leave_the_answers_of_the_others(monkeypatch, invoke):
    def fails(search, speed):
        raise SimulationError("weights overlap by 0.0345 rad")

    monkeypatch.setattr(GrowthSearch, "find", fails)
    found = speeds(load_scene("filimonikhina"), (4.5, 5.5))
    assert found.refused == {"cosim": "weights overlap by 0.0345 rad"}
    assert list(found.methods) == ["criterion", "floquet"]
    outcome = invoke("speeds", "filimonikhina", "--range", 4.5, 5.5)
    assert outcome.exit_code == 0, outcome.output
    assert "cosim: no answer: weights overlap by 0.0345 rad" in outcome.output
    with pytest.raises(SimulationError, match=r"0\.0345"):  # nothing else answers
        speeds(load_scene("filimonikhina"), (4.5, 5.5), ["cosim"])


def regions_by(growth, nodes, error=0.0):
    """Regions of a growth rate (function of the speed) that is known to an error."""
    return measured_regions(
        lambda w: Measured(Growth(growth(w), error), 1), lambda w, steps: growth(w), nodes
    )


def test_crossings_are_bracketed_and_refined():
    found = regions_by(lambda w: (w - 1.25) * (w - 2.75) * (3.5 - w), [0.5, 2.0, 3.0, 4.0])
    assert found.lowest == "unstable"
    assert [c.above for c in found.crossings] == ["stable", "unstable", "stable"]
    np.testing.assert_allclose([c.speed for c in found.crossings], [1.25, 2.75, 3.5], rtol=1e-6)
    assert all(c.error < 1e-4 for c in found.crossings)


@pytest.mark.parametrize(("error", "decided"), [(1e-8, True), (1e-2, False)])
def test_no_limit_is_stated_where_the_growth_beside_it_is_within_its_error(error, decided):
    found = regions_by(lambda w: 0.1 * (2.0 - w), [1.0, 1.5, 2.5, 3.0], error)
    if decided:
        assert [c.above for c in found.crossings] == ["stable"]
        assert found.crossings[0].speed == pytest.approx(2.0, abs=1e-6)
        return
    assert [c.above for c in found.crossings] == ["undecided", "stable"]
    (region,) = found.undecided
    assert region.low == pytest.approx(1.9, abs=0.01)
    assert region.high == pytest.approx(2.1, abs=0.01)
    assert 0.01 <= region.growth_below < 0.03


def test_a_growth_that_touches_zero_is_undecided_there():
    found = regions_by(lambda w: -((w - 2.0) ** 2), [1.0, 1.5, 2.0, 2.5, 3.0], 1e-4)
    assert found.lowest == "stable"
    assert [c.above for c in found.crossings] == ["undecided", "stable"]
    np.testing.assert_allclose([c.speed for c in found.crossings], [1.99, 2.01], atol=2e-3)


def test_both_sides_of_every_guess_are_looked_at():
    nodes = nodes_around([1.0, 1.003, 5.0], 0.5, 9.0)
    edges = np.array([1.0, 1.003, 5.0])
    cells = np.searchsorted(nodes, edges)
    assert len(set(cells)) == 3, "no two guesses in one bracket"
    assert (np.diff(nodes) > 0.0).all()
    assert (nodes[0], nodes[-1]) == (0.5, 9.0)


def test_an_extra_speed_of_one_method_stands_alone():
    found = Speeds("scene", (1.0, 9.0))
    found.methods["floquet"] = (Crossing(2.0, "stable"), Crossing(5.0, "unstable"))
    found.methods["cosim"] = (Crossing(2.0001, "stable"),)
    found.methods["criterion"] = (Crossing(2.2, "stable"), Crossing(7.0, "stable"))
    rows = [{name: c.speed for name, c in row.items()} for row in found.rows()]
    assert rows == [
        {"floquet": 2.0, "cosim": 2.0001, "criterion": 2.2},
        {"floquet": 5.0},
        {"criterion": 7.0},
    ]


@pytest.mark.parametrize("span", [(0.0, 1.0), (2.0, 1.0), (1.0, math.nan), (1.0, math.inf)])
def test_an_empty_range_is_refused(span):
    with pytest.raises(UserError, match="positive and rising"):
        speeds(load_scene("filimonikhina"), span)


def test_an_unknown_method_is_refused():
    with pytest.raises(UserError, match=r"floquett.*must be one of criterion"):
        speeds(load_scene("filimonikhina"), (1.0, 2.0), ["floquett"])


# -- command --------------------------------------------------------------------------------------


def test_command_prints_and_writes_the_speeds(invoke, tmp_path):
    target = tmp_path / "speeds.json"
    outcome = invoke(
        "speeds", "filimonikhina", "--range", 4.5, 5.5,
        "--method", "criterion,floquet,cosim", "--json", target,
    )  # fmt: skip
    assert outcome.exit_code == 0, outcome.output
    document = json.loads(target.read_text())
    assert document["scene"] == "filimonikhina"
    assert set(document["methods"]) == {"criterion", "floquet", "cosim"}
    for found in document["methods"].values():
        (crossing,) = found
        assert crossing["above"] == "unstable"
        assert crossing["speed"] == pytest.approx(5.045, abs=0.006)


def test_command_refuses_an_empty_range_with_exit_code_2(invoke):
    outcome = invoke("speeds", "filimonikhina", "--range", 5, 4)
    assert outcome.exit_code == 2
    assert "range 5 to 4 rad/s" in outcome.output


def test_a_speed_too_slow_for_a_turn_to_be_computed_is_told_and_not_raised(invoke):
    arguments = ("speeds", "two_balls", "--range", 1e-300, 9, "--method", "criterion,floquet")
    outcome = invoke(*arguments)
    assert outcome.exit_code == 0, outcome.output
    assert "floquet: no answer: 1e-300 rad/s: no double holds" in outcome.output


# -- check ----------------------------------------------------------------------------------------


def quick(**keys):
    scene = load_scene("filimonikhina")
    document = {
        "rotor": scene.rotor.model_dump(),
        "balancer": [scene.balancer[0].model_dump(exclude_none=True)],
        "operation": {"speed": 3.0},
        "check": [{"kind": "critical_speeds", "range": [4.5, 5.5], **keys}],
    }
    return type(scene).from_document(document, label="quick")


def test_check_compares_units_with_floquet():
    rows = check(quick(case="half", set={"rotor.unbalance": 0.004}))
    (row,) = rows
    assert row.holds
    assert "half: critical speed 1, unstable above" in row.quantity
    assert row.error < 1e-3


def test_check_fails_when_floquet_is_not_that_of_the_units(monkeypatch):
    from autobalancer.models import boundaries as module

    true = module.balancing_regions

    def shifted(assembly, low, high, **options):
        found = true(assembly, low, high, **options)
        moved = [Crossing(1.002 * c.speed, c.above) for c in found.crossings]
        return replace(found, crossings=tuple(moved))

    monkeypatch.setattr("autobalancer.harness.stability.boundaries.balancing_regions", shifted)
    (row,) = check(quick())
    assert not row.holds
    assert row.error == pytest.approx(0.002, rel=1e-2)


def test_check_says_when_a_run_ends_otherwise_than_predicted(monkeypatch):
    monkeypatch.setattr(
        "autobalancer.harness.checks.critical_speeds.growth_rates", lambda a, w: np.array([-0.3])
    )
    rows = check(quick(runs_from_rest=[7.0]))
    assert not rows[-1].holds
    assert rows[-1].measured.startswith("not balanced: residual moment")
