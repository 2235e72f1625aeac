"""What `race` says of races that are not round."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import autobalancer as ab
from autobalancer.harness.errors import UserError
from autobalancer.models.lobes import rests_over_turns

WHEEL = {
    "rotor": {"kind": "planar", "mass": 10.0, "stiffness": 1e4, "damping": 60.0, "unbalance": 0.02},
    "balancer": [{"kind": "pendulums", "count": 2, "mass": 0.15, "track_radius": 0.1, "drag": 0.6}],
    "operation": {"speed": 100.0},
}


def test_an_oval_leaves_what_an_integration_of_another_program_ends_with():
    along = ab.Scene(**WHEEL).race("2=0.2 mm")
    across = ab.Scene(**WHEEL).race("2=0.2 mm@45 deg")
    assert along.left[0][0] == pytest.approx(0.70193631e-3, abs=1e-10)
    assert across.left[0][0] == pytest.approx(0.10693227e-3, abs=1e-10)
    # the race against the unbalance is not known: the worst is the same
    assert across.left[0][1] >= 0.7e-3
    assert "of 2.22 mm without pendulums" in along.sentence()


def test_lobes_are_stated_one_by_one_and_together(invoke, tmp_path):
    target = tmp_path / "race.json"
    file = ab.Scene(**WHEEL).save(tmp_path / "wheel.toml")
    outcome = invoke("race", file, "--lobes", "1=0.2 mm@0.7, 3=0.1 mm", "--json", target)
    assert outcome.exit_code == 0, outcome.output
    found = json.loads(target.read_text())
    assert found["left"][0]["here"] == pytest.approx(0.19995759e-3, abs=1e-10)
    assert [len(found["left"]), len(found["angles"])] == [3, 2]


@pytest.mark.parametrize(
    ("changes", "lobes", "message"),
    [
        ({}, "oval", "must be ORDER=AMPLITUDE"),
        ({}, "2=20 kg", "a length is expected"),
        ({"rotor.stiffness": [1e4, 2e4]}, "2=20 um", "only on a planar rotor without bodies"),
        ({"rotor.stiffness": [1e4, 2e4]}, "2=20 um", "with them instead, as the key race"),
        ({"rotor.unbalance": 0.2}, "2=20 um", "do not balance the rotor on a round race"),
        ({"operation.speed": 5.0}, "2=20 um", "do not balance the rotor on a round race"),
        ({}, "2=1", r"race = .*bends inwards: the sum of \(lobes\^2 - 1\) amplitude is 3 m"),
        ({}, "9999999=1 um", r"race\[1\]\.lobes = 9999999: must be .* or less"),
        ({}, "", r"lobes '': must be ORDER=AMPLITUDE"),
        ({}, "2=20 um@30", 'more than two turns; is it in degrees.*"2=20 um@30 deg"'),
    ],
)
def test_what_has_no_answer_is_refused_with_a_reason(changes, lobes, message):
    with pytest.raises(UserError, match=message):
        ab.Scene(**WHEEL).replace(changes).race(lobes)


@pytest.mark.parametrize("speed", [0.0, -5.0, math.inf, math.nan])
def test_a_speed_at_which_nothing_turns_is_refused(speed):
    for ask in (ab.Scene(**WHEEL).capture, lambda w: ab.Scene(**WHEEL).race("2=0.2 mm", w)):
        with pytest.raises(UserError, match=r"speed = .* rad/s: must be above 0"):
            ask(speed)


@pytest.fixture(scope="module")
def turned_fan():
    """The fan, its stable rests over the angle of the races, and the angle between two of them."""
    fan = ab.load("oval_fan")
    rests = rests_over_turns(fan.assembly(), fan.profile().end)
    return fan, rests, math.tau / len(rests)


def test_weights_rest_at_every_angle_of_the_races_to_the_unbalance(turned_fan):
    _, rests, _ = turned_fan
    assert all(rests)


@pytest.mark.parametrize("which", [0, -1], ids=["best", "other"])
def test_runs_stay_at_the_rests_that_leave_most_over_the_angle_of_the_races(turned_fan, which):
    """Of the best rests and of all; weights start a little beside them, on a rotor at rest."""
    fan, rests, by = turned_fan
    k = max(range(len(rests)), key=lambda k: rests[k][which].size)
    held = rests[k][which]
    changes = {f"{b.label}.race[{j}].angle": one.angle + k * by
               for b in fan.balancer for j, one in enumerate(b.race, start=1)}  # fmt: skip
    left = list(np.add(held.angles, [0.01, -0.02, 0.0, 0.0, 0.01, -0.01]))
    changes |= {f"{b.label}.angles": left[3 * j : 3 * j + 3] for j, b in enumerate(fan.balancer)}
    run = fan.replace({**changes, "run.revolutions": 800}).run()
    ends = [np.hypot(run[f"rotor.station[{j}].x"], run[f"rotor.station[{j}].y"]) for j in (1, 2)]
    assert max(end[-40:].max() for end in ends) == pytest.approx(held.size, rel=1e-3)


def test_what_race_states_is_what_rests_over_the_angle_leave(turned_fan, monkeypatch):
    fan, rests, _ = turned_fan
    monkeypatch.setattr("autobalancer.harness.design.lobes.rests_over_turns", lambda *_: rests)
    found = fan.race()
    ((here, worst),) = found.left
    assert [1e6 * size for size in (here, worst, found.most)] == pytest.approx(
        [5.147, 9.910, 18.416], abs=1e-3
    )
    assert "Others leave up to 0.0184 mm" in found.sentence()
    assert found.as_json()["most"] == found.most


@pytest.mark.parametrize("command", ["capture", "race"])
def test_a_ring_of_liquid_is_sent_to_what_answers_of_it(invoke, command):
    extra = ["--lobes", "2=5 um"] if command == "race" else []
    outcome = invoke(command, "washing_machine_ring", *extra)
    said = " ".join(outcome.output.split())
    assert outcome.exit_code == 2
    assert ("the waves of a ring grow" in said) == (command == "capture")
    assert "as the key race" not in said


WHEEL_WITH_TWO_PLACES = {
    "rotor": {"kind": "planar", "mass": 1.6, "stiffness": 6.5e3, "damping": 9.0, "unbalance": 1e-4},
    "balancer": [{"kind": "pendulums", "count": 2, "mass": 2e-3, "track_radius": 0.05,
                  "drag": 0.05}],
    "operation": {"speed": 160.0},
}  # fmt: skip
LOBES = "4=0.1 mm@2.99, 3=0.03 mm@0.95"


def test_rests_that_leave_more_than_no_weights_are_stated_too():
    """Two weights can lie in one lobe, which is no place to balance: an integration stays there."""
    found = ab.Scene(**WHEEL_WITH_TWO_PLACES).race(LOBES)
    ends = [settled(found.lobes, start) for start in ([0.7, 0.8], [2.9, 3.0], [4.5, 4.6])]
    assert max(ends) > 1.3 * found.alone
    assert found.most >= max(ends) * (1.0 - 1e-6)
    assert found.left[-1][0] <= min(ends) * (1.0 + 1e-6)


def settled(lobes, angles):
    """Vibration [m] where an integration in the turning frame, written anew, ends."""
    rotor, (one,) = WHEEL_WITH_TWO_PLACES["rotor"], WHEEL_WITH_TWO_PLACES["balancer"]
    w, n, m = 160.0, 2, one["mass"]
    rows = [(each.order, each.amplitude, each.angle) for each in lobes]
    order, size, at = np.array(rows).T[:, :, None]

    def rates(_time, y):
        zeta, rate = complex(*y[:2]), complex(*y[2:4])
        theta, turning = y[4:6], y[6:]
        wave = order * (theta - at)
        rho = one["track_radius"] + (size * np.cos(wave)).sum(axis=0)
        slope, bend = (
            (-order * size * np.sin(wave)).sum(axis=0),
            (-(order**2) * size * np.cos(wave)).sum(axis=0),
        )
        e = np.exp(1j * theta)
        q, curve = (slope + 1j * rho) * e, (bend + 2j * slope - rho) * e
        own = curve * turning**2 + 2j * w * (rate + q * turning) - w * w * (zeta + rho * e)
        matrix = np.diag([rotor["mass"] + n * m] * 2 + list(m * abs(q) ** 2))
        matrix[0, 2:], matrix[1, 2:] = m * q.real, m * q.imag
        matrix[2:, 0], matrix[2:, 1] = m * q.real, m * q.imag
        push = rotor["unbalance"] * w * w - rotor["stiffness"] * zeta - m * own.sum()
        push -= rotor["damping"] * (rate + 1j * w * zeta) + rotor["mass"] * (
            2j * w * rate - w * w * zeta
        )
        right = -m * (q.conj() * own).real - one["drag"] * abs(q) ** 2 * turning
        found = np.linalg.solve(matrix, [push.real, push.imag, *right])
        return [*y[2:4], *found[:2], *turning, *found[2:]]

    start = [0.0] * 4 + list(angles) + [0.0, 0.0]
    end = solve_ivp(rates, (0.0, 6.0), start, "DOP853", rtol=1e-8, atol=1e-12).y[:, -1]
    assert np.abs(end[6:]).max() < 1e-4
    return float(np.hypot(*end[:2]))
