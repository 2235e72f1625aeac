"""Keys of cubic springs and stops, what is refused, and what answers about linear rotors say."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

import autobalancer as ab
from autobalancer.harness.accuracy.precision.reference import (
    refuse_without_reference,
    right_motion,
)
from autobalancer.harness.master.plan import plan

STOP = {"gap": "5 mm", "stiffness": "200 N/mm", "damping": 300.0}
TUB = {
    "name": "tub", "mass": 30.0, "transverse_inertia": 1.0,
    "feet": [{"position": 0.0, "stiffness": 2e4}, {"position": 0.4, "stiffness": 2e4}],
}  # fmt: skip


def planar(**keys):
    rotor = {"mass": 10.0, "stiffness": 1e4, "damping": 20.0, "unbalance": 1e-3} | keys
    return ab.Scene(rotor=ab.Planar(**rotor), operation={"speed": 60.0})


def two_support(**keys):
    rotor = {"mass": 12.0, "inertia": 0.5, "span": 0.4, "stiffness": [5e4, 5e4]} | keys
    return ab.Scene(rotor=ab.TwoSupport(**rotor), operation={"speed": 60.0})


def test_keys_feed_the_unit():
    start = plan(planar(stops=[STOP, STOP | {"kind": "y"}], cubic_stiffness=1e9)).units[0].start
    assert (start["stop[1].gap"], start["stop[2].stiffness"]) == (0.005, 2e5)
    assert [start[f"stop_row_{axis}[{k},1]"] for k in (1, 2) for axis in "xy"] == [1, 1, 0, 1]
    assert (start["cubic[1].stiffness_x"], start["cubic[1].axes"]) == (1e9, 0.0)


def test_a_machine_without_them_asks_for_the_unit_it_always_did():
    assert plan(planar()).units[0].sizes == {}


def test_supports_on_a_body_are_held_by_the_motion_between_both():
    scene = two_support(
        bodies=[TUB], on="tub", cubic_stiffness=[1e9, 0.0],
        stops=[STOP | {"support": 2}, STOP | {"support": "tub.foot[1]"}],
    )  # fmt: skip
    rotor = scene.restrained_assembly().rotor
    assert rotor.cubics[0].rows.tolist() == [[1.0, 0.0, -1.0, 0.0]] * 2
    assert rotor.stops[0].rows.tolist() == [[0.0, 1.0, 0.0, -1.0]] * 2
    assert rotor.stops[1].rows.tolist() == [[0.0, 0.0, 1.0, 0.0]] * 2
    assert [stop.support for stop in rotor.stops] == [2, 3]


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"stops": [STOP | {"gap": "-1 mm"}]}, r"stops\[1\].gap.*greater than 0"),
        ({"stops": [STOP | {"stiffness": 0.0}]}, r"stops\[1\].stiffness.*greater than 0"),
        ({"stops": [STOP | {"damping": -1.0}]}, r"stops\[1\].damping.*must be 0 or more"),
        ({"stops": [STOP | {"support": 2}]}, r"stops\[1\].support: must be 1: the rotor has no"),
        ({"stops": [STOP | {"kind": "z"}]}, r"stops\[1\].kind"),
        ({"cubic_stiffness": [1e9, 2e9]}, 'must be one number of a radial spring; with cubic = "a'),
        ({"cubic_stiffness": 1e9, "cubic": "square"}, "cubic"),
        (
            {"friction": [{"limit": 5.0, "free_stroke": "9 mm"}]},
            "free_stroke.*: requires stiffness",
        ),
        ({"friction": [{"limit": 5.0, "stiffness": 1e5, "free_stroke": -1.0}]}, "free_stroke"),
    ],
)
def test_mistakes_are_named(keys, said):
    with pytest.raises(ab.SceneError, match=said):
        planar(**keys)


MATRICES = {
    "mass_matrix": [[4.0, 1.0], [1.0, 3.0]], "stiffness_matrix": [[5e4, 0.0], [0.0, 4e4]],
    "damping_matrix": [[40.0, 0.0], [0.0, 30.0]], "supports": [1, 2],
    "unbalances": [{"position": 1.0, "amount": 3e-3, "angle": 0.4}],
}  # fmt: skip
HELD = {
    "stops": [STOP | {"support": 2, "gap": "2 mm"}], "cubic_stiffness": [1e9, 0.0],
    "friction": [{"support": 1, "limit": 4.0, "stiffness": 3e4, "free_stroke": "1 mm"}],
}  # fmt: skip


@pytest.mark.parametrize("separate", [False, True])
def test_a_rotor_by_its_matrices_moves_as_the_kind_that_has_them(separate):
    body = {"mass": 9.0, "inertia": 1.0, "com": 0.4, "span": 1.0}  # M of the matrices
    own = ab.TwoSupport(**body, stiffness=[5e4, 4e4], damping=[40.0, 30.0],
                        unbalances=MATRICES["unbalances"], planes=[1.0], **HELD)  # fmt: skip
    other = ab.Matrices(**MATRICES | {"mass_matrix": own.build().mass.tolist()}, **HELD)
    operation, coupling = {"speed": 90.0}, {"tolerance": 1e-8}
    x, y = (
        ab.Scene(rotor=rotor, operation=operation, coupling=coupling).run(separate=separate)
        for rotor in (own, other)
    )
    for name in ("rotor.station[1].x", "rotor.station[2].y"):
        there = np.interp(x.time, y.time, y[name])
        np.testing.assert_allclose(there, x[name], atol=2e-5 * np.abs(x[name]).max())


def test_a_rotor_by_its_matrices_has_them_at_any_point_by_name():
    stops = [STOP | {"support": "point[2]"}]
    rotor = ab.Matrices(**MATRICES | {"supports": [1]}, stops=stops).build()
    assert rotor.stops[0].rows.tolist() == [[0.0, 1.0]] * 2
    with pytest.raises(ab.SceneError, match=r'stops\[1\].support: must be 1 or "point\[1\]" or'):
        ab.Matrices(**MATRICES | {"supports": [1]}, stops=[STOP | {"support": 2}])
    with pytest.raises(ab.SceneError, match=r"cubic_stiffness.*: must be 2, one for each"):
        ab.Matrices(**MATRICES, cubic_stiffness=[1e9])
    with pytest.raises(ab.SceneError, match=r"cubic_stiffness.*: must not be below 0"):
        ab.Matrices(**MATRICES, cubic_stiffness=[-1e9, 0.0])


def test_python_units_refuse_them_by_name():
    with pytest.raises(ab.SceneError, match=r"rotor\.cubic_stiffness|rotor\.stops"):
        planar(stops=[STOP]).replace({"coupling.units": "python"}).run()


def test_no_reference_knows_stops():
    with pytest.raises(ab.SceneError, match=r"rotor\.stops"):
        refuse_without_reference(planar(stops=[STOP]))


def test_limits_of_stability_are_unchanged_and_say_so():
    scene = ab.load("filimonikhina")
    held = {"rotor.cubic_stiffness": 1e3, "rotor.stops": [{"gap": "5 mm", "stiffness": 100.0}]}
    plain, found = (s.speeds(0.5, 1.5, "floquet") for s in (scene, scene.replace(held)))
    assert [c.speed for c in found.methods["floquet"]] == [
        c.speed for c in plain.methods["floquet"]
    ]
    assert "those without them, unchanged" in found.supports
    assert found.as_json()["supports"] == found.supports
    assert plain.supports == ""
    assert "cubic springs and stops are left out" in scene.replace(held).capture().linear


def test_a_damper_within_its_free_stroke_leaves_the_limits_as_they_are():
    scene = ab.load("filimonikhina")
    damper = {"limit": 0.5, "stiffness": 100.0, "free_stroke": "1 mm"}
    held = scene.replace({"rotor.friction": [damper]})
    plain, found = (s.speeds(0.5, 1.5, "floquet,proved") for s in (scene, held))
    assert [c.speed for c in found.methods["floquet"]] == [
        c.speed for c in plain.methods["floquet"]
    ]
    assert found.proof.as_json() == plain.proof.as_json()
    assert "dampers rest within their free strokes" in found.supports
    with pytest.raises(ab.UserError, match=r"rotor\.friction"):
        held.replace({"rotor.friction[1].free_stroke": 0.0}).speeds(0.5, 1.5, "floquet")


def test_a_damper_stands_across_a_support_or_a_foot_by_its_row():
    feet = [*TUB["feet"], {"position": 0.1, "stiffness": 1e3}]
    places = (2, "tub.foot[3]", "tub.foot[1]")
    damper = {"limit": [5.0, 6.0], "stiffness": 1e5, "free_stroke": "2 mm"}
    scene = two_support(bodies=[TUB | {"feet": feet}], on="tub",
                        friction=[damper | {"support": place} for place in places])  # fmt: skip
    rotor = scene.restrained_assembly().rotor
    rows = [one.shares(4).tolist() for one in rotor.sliders[::2]]
    expected = [[0.0, 1.0, 0.0, -1.0], [0.0, 0.0, 0.75, 0.25], [0.0, 0.0, 1.0, 0.0]]
    assert np.allclose(rows, expected, rtol=1e-15)
    assert [one.support for one in rotor.sliders[::2]] == [2, 5, 3]
    start = plan(scene).units[0].start
    assert [start[f"slider_row_y[2,{j}]"] for j in (1, 2, 3, 4)] == pytest.approx(expected[1])
    with pytest.raises(ab.SceneError, match=r"friction\[1\].stiffness: .*cannot be rigid"):
        two_support(bodies=[TUB], on="tub", friction=[{"limit": 5.0}])
    with pytest.raises(ab.SceneError, match=r'friction\[1\].support: must be 1 or 2 or "tub'):
        two_support(bodies=[TUB], on="tub", friction=[damper | {"support": "tub.foot[3]"}])


def test_under_gravity_a_cubic_spring_counts_about_the_sag():
    scene = planar(cubic_stiffness=2e9).replace({"operation.gravity": 9.81})
    sag = brentq(lambda y: 1e4 * y + 2e9 * y**3 - 98.1, 0.0, 1.0)
    run = scene.replace({"rotor.unbalance": 0.0}).run()
    assert run["rotor.y"] == pytest.approx(np.full(run.time.size, -sag), rel=1e-7)
    # x'' 10 + (k + k3 sag^2) x, and along the sag three times as much
    across, along = (np.sqrt((1e4 + n * 2e9 * sag**2) / 10.0) for n in (1, 3))
    assert scene.rotor().critical.tolist() == pytest.approx([across, along], rel=1e-3)
    stopped = scene.replace({"rotor.stops": [{"gap": 0.9 * sag, "stiffness": 1e3}]})
    assert "the sag reaches rotor.stops[1]" in stopped.rotor().as_json()["supports"]


def test_a_verdict_says_which_stops_were_touched():
    scene = planar(unbalance=0.05, stops=[STOP | {"gap": "2 mm"}, STOP | {"gap": "1 m"}])
    said = str(scene.replace({"speed": 30.0, "run.revolutions": 20}).run().summary())
    assert "The ring at support 1 was touched" in said
    assert said.count("was touched") == 1
    quiet = str(planar(stops=[STOP | {"gap": "1 m"}]).run().summary())
    assert "No stop was touched." in quiet


def test_weak_touches_are_counted_alike_by_two_tolerances_and_said_in_tens():
    """A rotor that bounces off a stop ever more weakly as its vibration fades below the gap."""
    stop = {"gap": "1 mm", "stiffness": 1e7, "damping": 20.0}
    bouncing = planar(unbalance=0.0, damping=20.0, stops=[stop])
    run = bouncing.replace({"run.initial.x": 2e-3, "run.revolutions": 30}).run()
    count, before = run["rotor.stop[1].touches"][-1], run.counts_before["rotor.stop[1].touches"]
    assert count == before > 100  # by two tolerances
    assert f"was touched about {round(count, -1):.0f} times" in str(run.summary())
    assert run.summary().as_json()["stops"][0]["touches"] == count


@pytest.mark.parametrize("cubic", ["radial", "axes"])
def test_runs_on_cubic_springs_are_those_of_the_reference(cubic):
    springs = {"cubic_stiffness": [2e10, 1e10], "cubic": cubic, "damping": [20.0, 30.0]}
    unbalances = [{"position": 0.1, "amount": 2e-3, "angle": 0.0}]
    balls = {"at": 1, "kind": "balls", "count": 2, "mass": 0.02, "drag": 0.1,
             "track_radius": 0.08, "angles": [1.0, 3.0]}  # fmt: skip
    rotor = {"mass": 12.0, "inertia": 0.5, "span": 0.4, "stiffness": [5e4, 5e4]} | springs
    rotor |= {"planes": [0.15], "unbalances": unbalances}
    scene = ab.Scene(rotor=ab.TwoSupport(**rotor), balancer=[balls], operation={"speed": 60.0},
                     run={"revolutions": 2})  # fmt: skip
    run = scene.run()
    names = [f"rotor.station[{k}].{axis}" for k in (1, 2) for axis in "xy"]
    right, own = right_motion(scene, names, [run.time])
    assert own < 1e-7
    for name in names:
        size = np.abs(run[name]).max()
        assert run[name] == pytest.approx(right[name], abs=1e-4 * size)


def test_what_compares_with_a_linear_response_refuses_or_says_so():
    held = planar(stops=[STOP | {"gap": "1 um"}])
    with pytest.raises(ab.UserError, match=r"rotor\.stops: the response over the speed is that of"):
        held.rotor().response()
    with pytest.raises(ab.SceneError, match=r"rotor\.stops: a design compares"):
        ab.load("drum").replace({"rotor.stops": [STOP]}).design()
    two = ab.load("two_balls").replace({"rotor.stops": [{"gap": "15 mm", "stiffness": 20.0}]})
    assert str(two.run().summary()).startswith(
        "Not balanced: another steady motion than the balanced one: the weights rest in the rotor, "
        "which vibrates by 180 % of what it does without."
    )
    far = two.replace({"rotor.stops[1].gap": "1 m"})
    assert str(far.run().summary()).startswith("Balanced after")
