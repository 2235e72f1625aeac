"""Proofs of stability: enclosures hold, agree with other derivations, and claim nothing false."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

flint = pytest.importorskip("flint", reason="the extra `proof` is not installed")

from autobalancer.harness import load_scene  # noqa: E402
from autobalancer.harness.stability.ball_tables import Change  # noqa: E402
from autobalancer.harness.stability.exact import system  # noqa: E402
from autobalancer.models.boundaries import balancing_boundaries  # noqa: E402
from autobalancer.models.proof.arrays import Unproved  # noqa: E402
from autobalancer.models.proof.certificate import Certificate  # noqa: E402
from autobalancer.models.proof.series import Series  # noqa: E402
from autobalancer.models.stability import growth_rates  # noqa: E402

ISOTROPIC = ("two_plane_rodrigues", "three_mass_shaft", "grinder", "fan", "centrifuge")
PERIODIC = ("filimonikhina", "two_balls", "drum", "run_up", "balls_and_liquid")
UNLOADED = ("liquid_disc", "liquid_heavy", "liquid_no_internal", "balancing_machine")


@pytest.fixture(autouse=True)
def _bits():
    with flint.ctx.workprec(128):
        yield


def fractions(matrix) -> np.ndarray:
    return np.array([[Fraction(x) for x in row] for row in matrix], object)


def test_the_bound_of_a_product_holds_and_is_near_to_rounding():
    random = np.random.default_rng(3)
    a, b = random.normal(size=(2, 12, 12)) * 10.0 ** random.integers(-8, 8, (2, 12, 12))
    series = [Series(x[None, None].astype(complex), 1e-9 * np.abs(x[None, None])) for x in (a, b)]
    rounded = Series.exact(series[0].mid) @ Series.exact(series[1].mid)
    exact = fractions(a) @ fractions(b)
    error = np.abs((fractions(rounded.mid[0, 0].real) - exact).astype(float))
    assert (error <= rounded.rad[0, 0]).all()
    assert (rounded.rad[0, 0] <= 1e-14 * (np.abs(a) @ np.abs(b))).all()
    worst = fractions(a * (1.0 + 9e-10)) @ fractions(b * (1.0 + 9e-10))
    within = np.abs((worst - exact).astype(float))
    assert (within <= (series[0] @ series[1]).rad[0, 0]).all()


@pytest.mark.parametrize("name", [*ISOTROPIC, *PERIODIC, *UNLOADED])
def test_growth_rates_are_those_of_other_coordinates(name):
    """`linear.linearised` has other coordinates of the weights, and integrates the equations."""
    scene = load_scene(name)
    speeds = scene.profile().end * np.array([0.4, 1.0, 1.9])
    found = [Certificate.of(system(scene), w, 0).growth for w in speeds]
    np.testing.assert_allclose(found, growth_rates(scene.assembly(), speeds), rtol=1e-8)


@pytest.mark.parametrize("name", ["filimonikhina", "three_mass_shaft", "liquid_disc"])
def test_no_interval_with_a_boundary_inside_is_decided(name):
    scene = load_scene(name)
    equations = system(scene)
    low, high = {"liquid_disc": (50.0, 800.0)}.get(name, (0.5, 12.0))
    boundaries = [c.speed for c in balancing_boundaries(scene.assembly(), low, high)]
    assert boundaries
    for speed in np.geomspace(low, high, 7):
        certificate = Certificate.of(equations, float(speed))
        for boundary in boundaries:
            for reach in (1e-8, 1e-3, 0.1, 0.5):
                ends = boundary * (1.0 - reach), boundary * (1.0 + reach)
                assert certificate.state(*ends) == "undecided"
    states = {Certificate.of(equations, w).state(w, w) for w in np.geomspace(low, high, 9)}
    assert states == {"stable", "unstable"}


@pytest.mark.parametrize("name", ["filimonikhina", "three_mass_shaft", "liquid_disc"])
def test_a_matrix_changed_by_1e_9_moves_a_boundary_out_of_its_enclosure(name):
    """Both sides of a boundary, 2e-10 of it apart, are decided."""
    scene = load_scene(name)
    equations = system(scene)
    low, high = {"liquid_disc": (50.0, 800.0)}.get(name, (4.0, 6.0))
    low, high = {"three_mass_shaft": (3.0, 4.0)}.get(name, (low, high))
    (crossing,) = balancing_boundaries(scene.assembly(), low, high, tolerance=1e-12)

    def sides(system_) -> list[str]:
        around = Certificate.of(system_, crossing.speed)
        places = crossing.speed * (1.0 + np.array([-1e-10, 1e-10]))
        return [around.state(float(w), float(w)) for w in places]

    below = "unstable" if crossing.above == "stable" else "stable"
    assert sides(equations) == [below, crossing.above]
    mid = equations.mid.copy()
    mid[:3] *= (1.0 + 1e-9) ** np.array([2, 1, 0])[:, None, None]  # all boundaries move by 1e-9
    assert sides(replace(equations, mid=mid)) == [below] * 2


@pytest.mark.parametrize("name", [*ISOTROPIC, "liquid_disc", "liquid_heavy"])
def test_eigenvalues_enclosed_by_flint_lie_in_the_bounds_of_the_modes(name):
    """Gershgorin's discs of the modes; of one moved by 1e-9, some lie outside."""
    scene = load_scene(name)
    equations, noticed = system(scene), []
    for speed in scene.profile().end * np.array([0.4, 1.0, 1.9]):
        certificate = Certificate.of(equations, float(speed))
        least, most, beside = certificate._bounds(speed, speed, ())
        reach = beside.sum(axis=1)
        powers = flint.arb(speed) ** np.arange(3)[:, None, None]
        exact = flint.acb_mat((equations.mid[:3] * powers).sum(axis=0).tolist())
        assert not equations.mid[3:].any()
        values = exact.eig(multiple=True)
        rates = [value.real for value in values]
        turn = 1e-9 * max(abs(value) for value in values)
        inside, moved = (
            [bool(((least - reach <= x + d) & (x + d <= most + reach)).any()) for x in rates]
            for d in (0, turn)
        )
        assert all(inside)
        noticed.append(not all(moved))
        growing = sum(rate > 0 for rate in rates)
        assert certificate.state(speed, speed) == ("unstable" if growing else "stable")
        assert growing == (least > 0.0).sum()
    assert any(noticed)


def test_weights_that_nothing_damps_are_never_called_stable():
    scene = load_scene("three_mass_shaft").replace({"left.drag": 0.0, "right.drag": 0.0})
    assert Certificate.of(system(scene), 4.0).state(4.0, 4.0) != "stable"
    many = {"balls.count": 3, "balls.angles": [0.3, 1.9, 4.2], "balls.drag": 0.0}
    certificate = Certificate.of(system(load_scene("centrifuge").replace(many)), 104.0)
    assert certificate.state(104.0, 104.0) != "stable"


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"rotor.unbalance": 0.0101}, "can make at most"),
        (
            {"weights.count": 1, "weights.angles": [0.0], "weights.mass": 0.01},
            "single weight|no less",
        ),
    ],
)
def test_without_a_balanced_position_nothing_is_proved(changes, words):
    base = load_scene("filimonikhina").replace({"rotor.unbalance": 0.01 if len(changes) > 1 else 0})
    with pytest.raises(Unproved, match=words):
        system(base.replace(changes))


def test_two_weights_without_unbalance_stand_on_a_line_and_are_judged_there():
    scene = load_scene("filimonikhina").replace({"rotor.unbalance": 0.0})
    for speed in (0.8, 3.0, 7.0):
        certificate = Certificate.of(system(scene), speed)
        (growth,) = growth_rates(scene.assembly(), speed)
        assert certificate.growth == pytest.approx(growth, rel=1e-6)
        assert certificate.state(speed, speed) == ("unstable" if growth > 0.0 else "stable")


def test_modes_with_many_harmonics_are_told_from_their_shifted_copies():
    changes = {
        "rotor.mass": 1.0, "rotor.stiffness": [1.36, 11.2], "rotor.damping": [2.95, 0.81],
        "rotor.unbalance": 0.0046, "weights.mass": 0.0183, "weights.count": 4,
        "weights.track_radius": 0.2, "weights.drag": 0.077,
        "weights.angles": [1.38, 1.78, 3.35, 4.3],
    }  # fmt: skip
    equations = system(load_scene("filimonikhina").replace(changes))
    assert {Certificate.of(equations, w).state(w, w) for w in (0.6, 0.9, 1.1)} == {"unstable"}


@pytest.mark.parametrize(
    ("name", "path"),
    [
        ("filimonikhina", "rotor.stiffness"),
        ("drum", "front.mass"),
        ("drum", "rotor.com"),
        ("three_mass_shaft", "rotor.stations[2]"),
        ("three_mass_shaft", "rotor.support_stiffness[1][2]"),
        ("centrifuge", "rotor.damping_ratio"),
        ("balls_and_liquid", "liquid.height"),
    ],
)
def test_the_matrices_of_an_interval_contain_those_of_its_machines(name, path, monkeypatch):
    monkeypatch.setattr("autobalancer.models.proof.equations.matrix_balance", _unscaled)
    scene = load_scene(name)
    box = system(scene, [Change(path, -0.01, 0.02, "relative")])
    assert (np.abs(box.slopes[0]) > 1e-5 * np.abs(box.mid)).any()
    for part in (-0.01, 0.0, 0.007, 0.02):
        one = system(scene, [Change(path, part, part, "relative")])
        middle = box.mid + (part - 0.005) / 0.015 * box.slopes[0]
        rounding = 1e-15 * (np.abs(box.mid) + np.abs(box.slopes[0]))
        assert (np.abs(one.mid - middle) <= box.rad + one.rad + rounding).all()
    half = system(scene, [Change(path, -0.0025, 0.0125, "relative")])
    assert half.rad.max() < 0.3 * box.rad.max() + 2.0 * one.rad.max()  # of second order


def _unscaled(matrix, **_):
    return matrix, (np.ones(len(matrix)), None)
