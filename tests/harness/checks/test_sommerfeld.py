"""The bundled scene of the Sommerfeld effect holds; one without a closed form is refused."""

import pytest

from autobalancer.harness import check, load_scene
from autobalancer.harness.checks.sommerfeld import variants_of
from autobalancer.harness.errors import SceneError

pytestmark = pytest.mark.slow


def test_a_rotor_is_caught_and_passes_within_a_per_cent_of_the_closed_form():
    rows = check("sommerfeld")
    assert [row.quantity for row in rows if not row.holds] == []
    assert len(rows) == 6


def test_free_weights_lower_the_torque_that_a_resonance_takes():
    alone, with_weights = (
        found.limit()[0] for _, _, found in variants_of(load_scene("sommerfeld"))
    )
    assert with_weights < 0.9 * alone


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"operation.speed": 90.0}, "needs operation.motor"),
        ({"rotor.stiffness": [1e4, 2e4]}, "planar rotor with equal stiffness"),
        ({"pendulums.track_offset_xi": 0.001}, "centred tracks"),
        ({"rotor.unbalance": 0.0}, "has no resonance .*: needs unbalance"),
    ],
)
def test_a_scene_without_a_closed_form_is_refused(changes, words):
    with pytest.raises(SceneError, match=words):
        variants_of(load_scene("sommerfeld").replace(changes))
