"""What a run comes to: the summary's figures against closed forms, and each of its reasons."""

import json
import math

import numpy as np
import pytest

from autobalancer.harness import Scene, cosimulate, load_scene
from autobalancer.models.stability import growth_rates

SPEED, UNBALANCE, HELD = 150.0, 0.02, 0.03  # rad/s, kg m; what three balls hold [kg m]
DRUM = {
    "rotor": {"kind": "planar", "mass": 8.0, "stiffness": [20e3, 30e3], "damping": [80.0, 100.0],
              "unbalance": UNBALANCE},
    "balancer": [{"kind": "balls", "count": 3, "mass": 0.05, "track_radius": 0.2, "drag": 0.2}],
    "operation": {"speed": SPEED},
    "run": {"revolutions": 150},
}  # fmt: skip


def drum(**changes):
    return Scene(**DRUM).replace({path.replace("__", "."): each for path, each in changes.items()})


def summary(**changes):
    return cosimulate(drum(**changes)).summary()


def test_a_balanced_drum_has_the_figures_of_its_record():
    run = cosimulate(drum())
    found = run.summary()
    assert found.balanced
    late = run.time >= run.time[-1] - math.tau / SPEED
    distance = np.hypot(run["rotor.x"], run["rotor.y"])
    assert found.vibration == pytest.approx(distance[late].max(), rel=1e-14)
    beyond = distance > 0.05 * found.alone
    assert run.time[beyond][-1] < found.after <= run.time[np.flatnonzero(beyond)[-1] + 1]
    held = run.residual_moment("balls")[-1]
    assert found.used == (("balls", pytest.approx(held / HELD), pytest.approx(HELD)),)
    left = abs(UNBALANCE + complex(run["balls.moment_xi"][-1], run["balls.moment_eta"][-1]))
    assert found.left == pytest.approx((left, 1e3 * left * SPEED / 8.0))
    assert str(found).startswith(f"Balanced after {found.after:.3g} s: vibration 0.00")
    assert "Balls use 67 % of their capacity (30 g m)." in str(found)
    assert str(found).endswith("g mm: G0.4.")


def test_vibration_and_velocity_of_the_rotor_alone_are_those_of_its_equations():
    run = cosimulate(drum(run__revolutions=100).without_balancers())
    found = run.summary()
    x, y = (
        UNBALANCE * SPEED**2 / abs(k - 8.0 * SPEED**2 + 1j * c * SPEED)
        for k, c in ((20e3, 80.0), (30e3, 100.0))
    )
    assert found.alone == pytest.approx(max(x, y), rel=5e-3)  # the axes are nearly in phase
    assert found.vibration == pytest.approx(found.alone, rel=5e-3)
    assert found.velocity == run["rotor.velocity_rms"][-1]
    assert found.velocity == pytest.approx(max(x, y) * SPEED / math.sqrt(2.0), rel=2e-3)
    assert found.balanced is None
    assert "Unbalance of the rotor 20 g m: G630." in str(found)


def test_velocity_is_recorded_without_changing_the_run():
    names = ["rotor.x", "balls.weight[1].angle"]
    plain = cosimulate(drum(run__revolutions=20), record=names)
    run = cosimulate(drum(run__revolutions=20), record=[*names, "rotor.velocity_rms"])
    assert list(run.signals) == [*names, "rotor.velocity_rms"]
    assert run.signal_units["rotor.velocity_rms"] == "m/s"
    assert all((plain[name] == run[name]).all() for name in names)


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"speed": 40.0}, "below the critical speed, 49.54 rad/s = 473.1 rpm"),
        (
            {"rotor.unbalance": 0.05},
            "capacity exceeded: 50 g m to balance, the weights hold at most 30 g m",
        ),
        ({"balls.rolling_resistance": 0.01}, "balls stuck"),
        (
            {
                "operation.gravity": 9.81,
                "speed": 60.0,
                "rotor.stiffness": [8e3, 10e3],
                "rotor.unbalance": 5e-4,
                "balls.count": 2,
                "balls.angles": None,
                "balls.track_radius": 0.05,
                "run.revolutions": 300,
            },
            "gravity swings the weights",
        ),
        (
            {
                "operation.run_up": {"from": 60.0, "to": 300.0, "seconds": 20.0},
                "balls.drag": 0.02,
                "run.revolutions": 40,
            },
            "the speed still rises",
        ),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_a_rotor_that_is_not_balanced_has_its_reason(changes, reason):
    found = cosimulate(drum().replace(changes)).summary()
    assert found.balanced is False
    assert reason in found.reason
    assert str(found).startswith(f"Not balanced: {found.reason}. Vibration ")


def test_a_run_that_is_too_short_has_the_time_constant_and_revolutions_that_do():
    found = summary(balls__drag=0.05)
    constant = -1.0 / growth_rates(drum(balls__drag=0.05).assembly(), SPEED)[0]
    assert f"not settled yet, time constant {constant:.2g} s" in found.reason
    advised = int(found.reason.rpartition("= ")[2])
    assert summary(balls__drag=0.05, run__revolutions=advised).balanced


def test_an_unstable_speed_is_named_as_such():
    scene = load_scene("two_balls").replace({"speed": 6.0})  # between both critical speeds
    found = cosimulate(scene).summary()
    assert growth_rates(scene.assembly(), 6.0)[0] > 0.0
    assert "unstable at this speed, 6 rad/s = 57.3 rpm" in found.reason


def test_a_run_without_its_record_is_not_judged():
    bare = cosimulate(drum(run__revolutions=2), record=["rotor.x"]).summary()
    assert str(bare) == "Not judged: rotor.y not recorded."


def test_run_prints_the_summary_and_bookkeeping_only_when_asked(invoke, tmp_path):
    outcome = invoke("run", "two_balls", "--report", tmp_path)
    assert outcome.exit_code == 0, outcome.output
    assert "Balanced after 22 s: vibration 0.046 mm" in outcome.output
    assert "Left out" not in outcome.output
    assert "Balanced after 22 s" in (tmp_path / "report.html").read_text(encoding="utf-8")
    verbose = invoke("run", "two_balls", "--verbose", "--json", tmp_path / "run.json")
    assert "Left out: " in verbose.output
    error = json.loads((tmp_path / "run.json").read_text(encoding="utf-8"))["estimated_error"]
    assert 0.0 < error < 1e-3
    assert f"estimated error {error:.1g}" in verbose.output


def test_assert_settled_takes_the_time_of_the_summary_and_says_why_not():
    run = cosimulate(drum())
    run.assert_settled(within="2.5 s")
    with pytest.raises(AssertionError, match=r"not settled within 1 s: Balanced after 2\.\d+ s"):
        run.assert_settled(within=1.0)
    with pytest.raises(AssertionError, match="not settled within 9 s: Not balanced: capacity"):
        cosimulate(drum(rotor__unbalance=0.05)).assert_settled(within=9.0)


def test_a_scene_is_told_in_a_line():
    assert repr(drum()) == "<Scene 'scene': planar rotor, balls 'balls'>"
