"""What a resonance takes from a motor of limited power."""

import numpy as np
import pytest

from autobalancer.models.assembly import Assembly, Mounted
from autobalancer.models.rotor import LinearRotor
from autobalancer.models.sommerfeld import Resonance
from autobalancer.models.weights import Weights


def resonance(weights=True):
    rotor = LinearRotor.planar(1.0, 1e4, 10.0, 3.0, 0.01, 0.7)
    balls = Mounted("balls", Weights(2, 0.02, 0.1), angles=(0.0, 1.0), speeds=(0.0, 0.0))
    return Resonance.of(Assembly(rotor, (balls,) if weights else ()), 200.0)


def test_without_weights_the_torque_is_that_of_the_linear_response():
    found = resonance(weights=False)
    w = np.linspace(1.0, 190.0, 50)
    z = 0.01 * w**2 / (1e4 - w**2 + 10j * w)
    assert found.resistance(w) == pytest.approx(10.0 * w * np.abs(z) ** 2, rel=1e-12)


def test_weights_rest_where_the_rotor_is_bent_to():
    """The whirl of the closed form meets the equation of motion with weights at its own angle."""
    found = resonance()
    for w in (60.0, 95.0, 130.0):
        size, s = float(found.amplitude(w)), 2 * 0.02 * 0.1
        dynamic = 1e4 - 1.04 * w * w + 10j * w
        # D z - s w^2 z/|z| = U w^2 up to the turn of z
        assert abs(dynamic * size - s * w * w) == pytest.approx(0.01 * w * w, rel=1e-12)


@pytest.mark.parametrize("weights", [False, True])
def test_below_the_limit_a_motor_meets_the_rising_flank_and_above_it_none(weights):
    found = resonance(weights)
    limit, peak = found.limit()
    assert found.caught_at(0.9 * limit) < found.caught_at(0.99 * limit) < peak
    speeds = np.linspace(1.0, 1.3 * peak, 5000)
    assert (1.001 * limit * (1.0 - speeds / 200.0) > found.resistance(speeds)).all()


def test_a_motor_whose_top_is_below_the_resonance_has_no_limit():
    rotor = LinearRotor.planar(1.0, 1e4, 10.0, 0.0, 0.01)
    with pytest.raises(ValueError, match="no resonance below"):
        Resonance.of(Assembly(rotor), 80.0).limit()


def test_an_anisotropic_rotor_has_no_closed_form():
    with pytest.raises(ValueError, match="planar rotor with equal stiffness"):
        Resonance.of(Assembly(LinearRotor.planar(1.0, (1e4, 2e4), 10.0, 0.0, 0.01)), 80.0)
