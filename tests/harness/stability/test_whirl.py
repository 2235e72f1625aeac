"""The vibration that remains where weights cannot balance: published rig, closed forms, words."""

import json
import math

import numpy as np
import pytest

from autobalancer.harness import UserError, load_scene, speeds
from autobalancer.harness.stability import whirl
from autobalancer.harness.stability.whirl import whirls
from autobalancer.models.papers.influence import influence

ALIKE = {
    "rotor.stiffness": [[18000.0, 18000.0], [18000.0, 18000.0]],
    "rotor.damping": [[9.0, 9.0], [9.0, 9.0]],
}


@pytest.fixture(autouse=True)
def ends_of_the_range_alone(monkeypatch):
    monkeypatch.setattr(whirl, "SPEEDS", 2)


def test_the_measured_rig_keeps_the_vibration_of_its_runs_of_1200_revolutions():
    found = speeds(load_scene("bristol"), (136.9, 340.0), ["floquet", "cosim"])
    assert set(found.refused) == {"floquet", "cosim"}
    assert not found.methods
    assert "cannot be undone" in found.whirl.why
    first, last = found.whirl.at[0], found.whirl.at[-1]
    assert 1e3 * np.array(first.amplitude) == pytest.approx([0.2505, 0.1568], rel=5e-4)
    assert 1e3 * np.array(last.amplitude) == pytest.approx([0.01111, 0.01148], rel=1e-3)
    assert math.degrees(sum(first.angles) / 2) == pytest.approx(-15.17, abs=0.02)
    apart = math.degrees(2.0 * math.asin(2.38 / 42.8))
    assert math.degrees(first.angles[1] - first.angles[0]) == pytest.approx(apart, abs=0.01)
    assert np.degrees(last.angles) == pytest.approx([-172.1, 165.8], abs=0.1)
    assert first.stable
    assert last.stable
    written = json.loads(json.dumps(found.as_json()))["whirl"]
    assert written.keys() == {"finding", "why", "at"}
    assert written["at"][0] == {
        "speed": 136.9,
        "stable": True,
        "amplitude": list(first.amplitude),
        "angles": list(first.angles),
    }


def test_balls_that_go_round_in_the_rotor_have_not_settled(monkeypatch):
    monkeypatch.setattr(whirl, "MOST", 300)
    found = whirls(load_scene("bristol"), (155.0, 156.0), "")
    assert not found.at[0].stable
    assert max(found.at[0].amplitude) > 0.2e-3


def test_on_supports_alike_the_plane_rests_and_the_rest_turns_about_it():
    """Two weights make the moment that keeps their plane at rest; influence coefficients say it."""
    scene = load_scene("bristol").replace(ALIKE)
    found = whirls(scene, (300.0, 340.0), "").at[-1]
    assembly = scene.assembly()
    rotor = assembly.loaded_rotor
    stations = influence(rotor, 340.0, np.eye(2))[0] @ rotor.unbalance
    by_weights = influence(rotor, 340.0)[0]
    moment = -(rotor.planes @ stations) / (rotor.planes @ by_weights)
    each = assembly.weights[0].device.moment
    assert each * np.exp(1j * np.array(found.angles)).sum() == pytest.approx(
        complex(moment[0, 0]), rel=1e-3
    )
    expected = np.abs(stations + by_weights[:, 0] * moment[0, 0])
    np.testing.assert_allclose(found.amplitude, expected, rtol=2e-3)
    assert found.stable


def test_beyond_their_reach_all_weights_stand_together_where_nothing_drives_them():
    """Angle psi of the group: sin(psi - g + d) = -(S/U) sin d, d the phase of the stiffness."""
    alike = {"rotor.stiffness": 4.0, "rotor.damping": 0.5, "rotor.unbalance": 0.06}
    scene = load_scene("two_balls").replace(alike)
    assembly = scene.assembly()
    rotor, (balls,) = assembly.loaded_rotor, assembly.weights
    found = whirls(scene, (3.0, 12.0), "").at[-1]
    speed, reach = found.speed, len(balls.angles) * balls.device.moment
    mass, damping, stiffness = (m[0, 0] for m in rotor.real_coefficients(speed))
    dynamic = stiffness - mass * speed**2 + 1j * damping * speed
    delta = np.angle(dynamic)
    turned = math.asin(-reach / 0.06 * math.sin(delta))
    together = [
        abs(0.06 + reach * np.exp(1j * psi)) * speed**2 / abs(dynamic)
        for psi in (turned - delta, math.pi - turned - delta)
    ]
    assert found.stable
    assert found.amplitude[0] == pytest.approx(min(together), rel=1e-3)


def test_on_a_track_off_centre_no_rotor_rests():
    centred = load_scene("filimonikhina")
    found = speeds(centred.replace({"weights.track_offset_xi": 1e-4}), (2.0, 3.0), ["floquet"])
    assert "tracks are off centre: weights by 0.1 mm" in found.whirl.why
    assert found.methods["floquet"] == speeds(centred, (2.0, 3.0), ["floquet"]).methods["floquet"]


def test_balance_at_rest_leaves_nothing():
    assert speeds(load_scene("filimonikhina"), (2.0, 3.0), ["floquet"]).whirl is None


def test_why_the_runs_are_refused_is_said_in_place_of_the_vibration(monkeypatch):
    def refuse(*_, **__):
        raise UserError("drum: too many stations")

    monkeypatch.setattr(whirl, "cosimulate_many", refuse)
    found = speeds(load_scene("bristol"), (300.0, 340.0), ["floquet"]).whirl
    assert not found.at
    assert "is not known: drum: too many stations" in " ".join(found.lines())
