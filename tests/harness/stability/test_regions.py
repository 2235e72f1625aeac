"""Slow growth: limits that are stated, and what is undecided or neutral instead."""

from __future__ import annotations

import json

import numpy as np
import pytest

import autobalancer as ab
from autobalancer.harness.stability.growth_search import GrowthSearch
from autobalancer.harness.stability.main_motion import MainMotion
from tests.studies.regions import compare, contradictions, states_alternate, stretches

pytestmark = pytest.mark.slow


def disc(mass, stiffness, damping, unbalance, balancers):
    """A planar rotor with pairs of weights."""
    names = ("kind", "mass", "track_radius", "drag")
    tables = [
        {"name": f"b{k}", "count": 2, **dict(zip(names, each, strict=True))}
        for k, each in enumerate(balancers)
    ]
    rotor = {"kind": "planar", "mass": mass, "stiffness": stiffness, "damping": damping}
    return ab.Scene.from_document(
        {
            "rotor": {**rotor, "unbalance": unbalance},
            "balancer": tables,
            "operation": {"speed": 100.0},
            "run": {"revolutions": 5},
        }
    )


HUGE_DRAG = disc(8.0, [20e3, 30e3], [8.0, 10.0], 0.01, [("balls", 0.05, 0.2, 3e4)])
HUGE_DRAG_TWICE = disc(
    0.8777776776482596,
    [92.01680005491465, 265.7426004242356],
    0.033511373312914726,
    0.0002411955965345501,
    2 * [("pendulums", 0.002627615300297447, 0.10181694461173972, 193.3507160542341)],
)
TINY_MASS = disc(
    1.8579128033006524,
    [6056.242584259056, 2394.030739509582],
    1.1911090978630638,
    3.474797774014851e-08,
    [("rollers", 1.419248198222775e-07, 0.36230510996796433, 4.886808784472104e-05)],
)
# integrations that share nothing with the project
LIMITS = {
    "huge drag": (HUGE_DRAG, (20.0, 200.0), [49.71, 55.57, 60.82]),
    "huge drag, two balancers": (HUGE_DRAG_TWICE, (5.0, 60.0), [10.178, 14.191, 17.298]),
    "tiny mass": (TINY_MASS, (17.13, 342.5), [35.9, 47.69, 57.09]),
}


@pytest.mark.parametrize(
    ("case", "methods"),
    [*((case, "floquet,cosim") for case in LIMITS), ("huge drag", "cosim")],
)
def test_slow_growth_has_its_limits_and_no_others(case, methods):
    scene, span, expected = LIMITS[case]
    found = scene.speeds(*span, methods)
    assert states_alternate(found)
    for method, crossings in found.methods.items():
        limits = [c for c in crossings if c.above in ("stable", "unstable")]
        assert [c.above for c in limits] == ["stable", "unstable", "stable"], method
        unknown = [u.high - u.low for u in found.undecided.get(method, ())]
        assert sum(unknown) < 1e-3 * span[1]
        np.testing.assert_allclose([c.speed for c in limits], expected, rtol=5e-4)


def test_an_undamped_machine_is_neutral_by_every_method():
    scene = disc(8.0, 20e3, 0.0, 0.01, [("balls", 0.05, 0.2, 0.0)])
    found = scene.speeds(100.0, 200.0, "floquet,cosim")
    assert found.lowest == {"floquet": "neutral", "cosim": "neutral"}
    assert not any(found.methods.values())
    (region,) = found.undecided["floquet"]
    assert (region.low, region.high) == (100.0, 200.0)
    assert region.growth_below < 1e-8


def growth_without_damping(speed, mass, stiffness, unbalance, weight, radius):
    """Largest growth rate [1/s] of a disc with two pendulums about balance, from its equations.

    In the rotor z = x + i y, and a pendulum at e^{i p}: A = z'' + 2 i w z' - w^2 z for the disc and
    R i e^{i p} d, whose part along the track each pendulum feels.
    """
    half = np.arccos(-unbalance / (2.0 * weight * radius))
    ways = 1j * np.exp(1j * np.array([half, -half]))
    rows = np.array([[1.0, 1j, *(radius * ways)]])  # of a place, by the four unknowns
    of = [np.vstack([rows.real, rows.imag])]
    of += [np.vstack([(f * rows).real, (f * rows).imag]) for f in (2j * speed, -(speed**2))]
    inertia, rate, place = np.zeros((3, 4, 4))
    for k, mass_of in enumerate((mass, weight, weight)):
        # the disc alone, then each pendulum with the disc
        moved = np.array([1.0, 1.0, *(k == i for i in (1, 2))])
        left = (of[0] * moved).T * mass_of
        for matrix, right in zip((inertia, rate, place), of, strict=True):
            matrix += left @ (right * moved)
    place[:2, :2] += stiffness * np.eye(2)
    for k in (1, 2):  # steady circles push outwards: m R w^2 along e^{i p}, which turns with d
        place[1 + k, 1 + k] += weight * radius**2 * speed**2
    zero, one = np.zeros((4, 4)), np.eye(4)
    matrix = np.block(
        [[zero, one], [-np.linalg.solve(inertia, place), -np.linalg.solve(inertia, rate)]]
    )
    return np.linalg.eigvals(matrix).real.max()


def test_a_neutral_region_holds_speeds_of_no_growth_alone():
    """Its first speed is one without growth; the limit before it is known less well."""
    scene = disc(8.0, 20e3, 0.0, 0.015, [("pendulums", 0.05, 0.2, 0.0)])
    found = scene.speeds(45.0, 200.0, "floquet,cosim")
    for method in ("floquet", "cosim"):
        (region,) = found.undecided[method]
        assert region.high == 200.0
        assert growth_without_damping(region.low, 8.0, 20e3, 0.015, 0.05, 0.2) < 1e-4, method
        assert growth_without_damping(0.995 * region.low, 8.0, 20e3, 0.015, 0.05, 0.2) > 0.1


def test_a_limit_stands_within_its_own_error():
    found = HUGE_DRAG.speeds(20.0, 200.0, "floquet,cosim")
    pairs = zip(found.methods["floquet"], found.methods["cosim"], strict=True)
    for exact, other in pairs:
        assert abs(exact.speed - other.speed) <= exact.error + other.error
        assert other.error < 1e-4 * other.speed


@pytest.mark.parametrize("mass", [3e-8, 1e-8])
@pytest.mark.parametrize("share", [0.2, 0.5, 0.9])
def test_growth_at_a_limit_is_within_its_error_under_drag_that_outweighs_the_weights(mass, share):
    """Below 1e-8 1/s steps of the units err by as much, alike for every distance of the starts."""
    held = 2.0 * mass * 0.36
    weights = ("rollers", mass, 0.36, 4.9e-5)
    scene = disc(1.86, [6056.0, 2394.0], 1.19, share * held, [weights])
    limits = [c.speed for c in scene.speeds(17.0, 342.0, "floquet").methods["floquet"]]
    assert len(limits) == 3
    with MainMotion(scene) as motion:
        found = [GrowthSearch(motion).find(speed).growth for speed in limits]
    assert all(abs(one.rate) <= one.error for one in found), found


def test_what_is_undecided_is_printed_and_written(invoke, tmp_path):
    path, data = tmp_path / "neutral.toml", tmp_path / "speeds.json"
    path.write_text(
        '[rotor]\nkind = "planar"\nmass = 1.0\nstiffness = 1000.0\ndamping = 0.0\n'
        'unbalance = 1e-5\n[[balancer]]\nkind = "liquid"\nchamber_radius = 0.1\n'
        "float_radius = 0.05\nheight = 0.05\ndensity = 1000.0\n[operation]\nspeed = 128.0\n"
    )
    done = invoke("speeds", path, "--range", 20, 300, "--json", data)
    assert done.exit_code == 0, done.output
    assert "floquet: neutral at the low end of the range, and up to its end" in done.output
    assert "cosim: neutral from 20 to 300 rad/s, growth below" in done.output
    found = json.loads(data.read_text())
    assert found["methods"]["cosim"] == []
    assert found["undecided"]["cosim"][0]["state"] == "neutral"


def test_the_criterion_is_shown_as_a_rule(invoke):
    done = invoke("speeds", "filimonikhina", "--range", 4.5, 5.5, "--method", "criterion,floquet")
    assert "criterion, a rule" in done.output
    assert "fast and approximate" in done.output


def test_a_map_of_an_undamped_machine_says_where_it_is_neutral():
    scene = disc(8.0, [20e3, 20e3], 0.0, 0.01, [("balls", 0.05, 0.2, 0.0)])
    found = scene.map("speed=20:200:10", "b0.mass=0.04:0.06:3")
    fast = found.x.values > 80.0
    assert found.undecided[:, fast].all()
    assert not found.undecided[:, 0].any()
    assert any("undecided or neutral: growth below" in line for line in found.lines())
    assert found.plot() is not None


def test_methods_of_random_scenes_do_not_contradict_each_other():
    for number in (0, 1, 2):
        assert compare(7, number, proved=False).contradictions == []


def test_a_contradiction_is_found():
    true = [(1.0, 2.0, "stable"), (2.1, 3.0, "unstable")]
    assert list(contradictions(true, [(1.0, 3.0, "unstable")])) == [(1.0, 2.0)]
    assert not list(contradictions(true, [(1.0, 2.05, "stable"), (2.05, 3.0, "undecided")]))
    found = ab.load("filimonikhina").speeds(0.5, 12.0, "floquet")
    assert [state for *_, state in stretches(found, "floquet")] == [
        "unstable",
        "stable",
        "unstable",
        "stable",
    ]
