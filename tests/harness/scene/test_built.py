"""Scenes of machines as they are built: discs that tilt, bearings with cross terms."""

from __future__ import annotations

import fmpy
import numpy as np
import pytest
from fmpy import platform_tuple

import autobalancer as ab
from autobalancer.fmus.catalogue import sized_unit
from autobalancer.harness import cosimulate
from autobalancer.harness.master.names import stations
from autobalancer.harness.master.plan import plan
from autobalancer.harness.scene.plausible import implausible, understood
from autobalancer.models.monolith import reference
from autobalancer.models.papers.influence import influence
from tests.studies.built import FAMILIES, compare, first_words, growth_word

OVERHUNG = {
    "kind": "flexible",
    "stations": [0.0, 0.4, 0.6],
    "masses": [1.5, 1.5, 12.0],
    "supports": [1, 2],
    "support_stiffness": [[2e6, 2e6], [2e6, 1.5e6]],
    "support_damping": [[2e3, 2e3]] * 2,
    "bending_stiffness": 4030.0,
    "transverse_inertias": [0.0, 0.0, 0.12],
    "polar_inertias": [0.0, 0.0, 0.24],
    "unbalances": [{"position": 0.6, "amount": 1.2e-3}],
}
BALLS = {
    "name": "balls", "kind": "balls", "count": 2, "mass": 0.02, "track_radius": 0.08, "drag": 0.5,
    "angles": [1.0, 2.8],
}  # fmt: skip
PLANAR = {"kind": "planar", "mass": 10.0, "unbalance": 1e-3}
BEARING = {"stiffness": [[1e5, 3e3], [-2e3, 1.2e5]], "damping": [[60.0, 5.0], [5.0, 80.0]]}


def machine(rotor, **more):
    balancer = [BALLS | {"at": 3}] if rotor["kind"] == "flexible" else [BALLS]
    return ab.Scene(rotor=rotor, balancer=balancer, speed=377.0, run={"revolutions": 12}, **more)


@pytest.mark.parametrize(
    "rotor", [OVERHUNG, PLANAR | {"bearings": [BEARING]}], ids=["overhung", "bearing"]
)
def test_separate_units_and_one_file_have_the_same_motion(rotor):
    scene = machine(rotor)
    one, several = (cosimulate(scene, separate=choice) for choice in (False, True))
    name = f"rotor.{'station[3].' if rotor is OVERHUNG else ''}x"
    size = np.abs(one[name]).max()
    end = [run[name][-1] for run in (one, several)]
    stated = max(run.estimated_error for run in (one, several))
    assert end[0] == pytest.approx(end[1], abs=max(3.0 * stated, 1e-6) * size)
    assert plan(scene).units[0].sizes["kind"] == "matrices"


@pytest.mark.parametrize("name", ["two_balls", "drum", "three_mass_shaft"])
def test_a_bearing_without_cross_terms_is_a_spring_and_a_damper(name):
    scene = ab.load(name).replace({"run.revolutions": 3})
    rotor = scene.rotor
    key = rotor.damping_key
    pairs = np.reshape([getattr(rotor, rotor.stiffness_key), getattr(rotor, key)], (2, -1, 2))
    bearings = [
        {"support": s, "stiffness": np.diag(k).tolist(), "damping": np.diag(c).tolist()}
        for s, (k, c) in enumerate(zip(*pairs, strict=True), start=1)
    ]
    document = scene.document
    for given in (key, rotor.stiffness_key, "damping_ratio"):
        document["rotor"].pop(given, None)
    document["rotor"]["bearings"] = bearings
    document.pop("check", None)
    found, expected = (cosimulate(each) for each in (ab.Scene.from_document(document), scene))
    for signal, values in expected.signals.items():
        assert found[signal] == pytest.approx(values, abs=1e-9 * np.abs(values).max()), signal


def test_whirl_beyond_the_threshold_of_the_bearing_grows_in_a_run():
    """q* = c sqrt(k/M) = 6000 N/m; above it the orbit grows at the rate of the equations."""

    def last(cross):
        k = [[1e5, cross], [-cross, 1e5]]
        rotor = {"kind": "planar", "mass": 10.0, "unbalance": 1e-6}
        rotor |= {"bearings": [{"stiffness": k, "damping": [[60.0, 0.0], [0.0, 60.0]]}]}
        scene = ab.Scene(rotor=rotor, speed=40.0, run={"revolutions": 30, "initial": {"x": 1e-4}})
        run = cosimulate(scene)
        return np.hypot(run["rotor.x"], run["rotor.y"])[-1]

    end = 30 * 2 * np.pi / 40.0
    assert last(5000.0) < 1e-4 < last(7000.0)
    forward = 0.5e-4  # the other half of the start whirls backward, and dies
    assert np.log(last(9000.0) / forward) / end == pytest.approx(1.5, rel=0.01)


def test_its_unit_is_described_and_built_for_both_versions_of_fmi(tmp_path):
    scene = machine(OVERHUNG)
    unit = plan(scene).units[0]
    layout = sized_unit(unit.model, **unit.sizes).layout
    assert set(unit.start) <= set(layout.index)
    assert unit.start["mass[3,4]"] == unit.start["mass[4,3]"] != 0.0
    for form in ({"fmi": 2}, {"fmi": 3, "one_file": True}, {"fmi": 3, "ssp": True}):
        built = scene.build(tmp_path / str(len(form)), platforms=[platform_tuple], **form)
        fmus = [path for path in built.files if path.suffix == ".fmu"]
        for path in fmus:
            fmpy.read_model_description(str(path), validate=True)
        assert fmus or form.get("ssp")


@pytest.mark.parametrize(
    ("rotor", "words"),
    [
        (PLANAR, "rotor.stiffness: missing; give a value in N/m"),
        (PLANAR | {"stiffness": 1e5, "bearings": [BEARING]}, "either bearings or stiffness"),
        (OVERHUNG | {"polar_inertias": [0.0, 0.0, 0.25]}, r"polar_inertias\[3\]"),
        (OVERHUNG | {"polar_inertias": [0.0, 0.24]}, "polar_inertias"),
        (OVERHUNG | {"skews": [{"station": 1, "tilt": 1e-3}]}, r"skews\[1\].station"),
    ],
)
def test_what_no_machine_has_is_refused(rotor, words):
    with pytest.raises(ab.SceneError, match=words):
        machine(rotor)


def test_a_point_as_wide_as_its_balancer_is_warned_of():
    point = {k: v for k, v in OVERHUNG.items() if not k.endswith("inertias")}
    wide = [BALLS | {"at": 3, "track_radius": 0.19}]
    scene = ab.Scene(rotor=point, balancer=wide, speed=377.0)
    assert any(
        "transverse_inertias, here about 0.108 kg m^2" in line for line in implausible(scene)
    )
    sized = ab.Scene(rotor=OVERHUNG, balancer=wide, speed=377.0)
    assert not any("inertias" in line for line in implausible(sized))


def test_rigid_motions_of_a_free_machine_are_no_natural_frequencies_that_a_disc_moves():
    """Their rates are 0: a ratio of what rounding leaves of them says nothing."""
    sized = OVERHUNG | {"on": "housing"}
    point = {k: v for k, v in sized.items() if not k.endswith("inertias")}
    body = {"name": "housing", "mass": 5.0, "transverse_inertia": 0.2, "center": 0.2}
    wide = [BALLS | {"at": 3, "track_radius": 0.2}]  # a thin disc as wide has 0.12 kg m^2
    scenes = [ab.Scene(rotor=r, balancer=wide, speed=377.0, body=[body]) for r in (point, sized)]
    points, discs = (np.sort(np.abs(one.rotor.build().free_rates(377.0))) for one in scenes)
    elastic = (points > 1.0) & (points < 1.5 * 377.0)
    change = np.abs(discs[: len(points)][elastic] / points[elastic] - 1.0).max()
    assert _warned_change(scenes[0]) == f"{100.0 * change:.0f} %"


def test_rates_at_which_rubber_and_oil_creep_back_are_no_natural_frequencies():
    """Of the turbine in rad/s: undamped 206 to 300; its oil creeps at 9500 and more."""
    assert "natural frequencies 19.1, 22.1, 311, 359 Hz;" in understood(ab.load("rubber_drive"))
    assert "natural frequencies 32.8, 35.7, 44.3, 47.8 Hz;" in understood(ab.load("small_turbine"))
    heavy = ab.Scene(rotor=PLANAR | {"stiffness": 1e5, "damping": 1e4}, speed=100.0)
    assert "no natural frequency: overdamped" in understood(heavy)


def test_a_change_beyond_the_cap_is_told_as_more_than_it(monkeypatch):
    monkeypatch.setattr("autobalancer.harness.scene.plausible.MOST_SHOWN", 0.3)
    point = {k: v for k, v in OVERHUNG.items() if not k.endswith("inertias")}
    wide, narrow = ([BALLS | {"at": 3, "track_radius": r}] for r in (0.19, 0.1))
    scenes = (ab.Scene(rotor=point, balancer=one, speed=377.0) for one in (wide, narrow))
    assert [_warned_change(scene) for scene in scenes] == ["more than 30 %", "11 %"]


def _warned_change(scene):
    (line,) = (line for line in implausible(scene) if "transverse_inertias, here" in line)
    return line.partition("natural frequency by ")[2].partition(":")[0]


def test_stability_is_proved_of_discs_that_tilt_and_of_bearings():
    for rotor, span in ((OVERHUNG, (370.0, 380.0)), (PLANAR | {"bearings": [BEARING]}, (120, 160))):
        scene = machine(rotor)
        found = scene.speeds(*span, "floquet")
        proof = scene.speeds(*span, "proved", narrowest=0.5).proof
        decided = [band for band in proof.bands if band.state != "undecided"]
        assert decided
        limits = [crossing.speed for crossing in found.methods["floquet"]]
        for band in decided:
            assert not any(band.low < limit < band.high for limit in limits)


TUB = {"name": "tub", "mass": 30.0, "feet": [{"stiffness": 6e4, "damping": 200.0}]}
DISC = {"kind": "planar", "mass": 10.0, "stiffness": 4e4, "damping": 40.0, "unbalance": 3e-3}


def on_a_tub(rotor=DISC, body=TUB, **more):
    more = {"speed": 150.0, "run": {"revolutions": 20}, **more}
    speed = more.pop("speed")
    return ab.Scene.from_document(
        {"rotor": rotor | {"on": "tub"}, "body": [body], "operation": {"speed": speed}, **more}
    )


@pytest.mark.parametrize("kind", ["tub", "overhung", "bearing"])
def test_a_run_ends_as_the_integration_in_one_piece(kind):
    scene = {
        "tub": lambda: on_a_tub(balancer=[BALLS], rotor=DISC | {"internal_damping": 5.0}),
        "overhung": lambda: machine(OVERHUNG),
        "bearing": lambda: machine(PLANAR | {"bearings": [BEARING]}),
    }[kind]()
    run = cosimulate(scene)
    expected, _ = reference(scene.assembly(), scene.profile(), run.time[-1:])
    for at, prefix in enumerate(stations(len(scene.rotor.points))):
        size = np.abs(run[f"rotor.{prefix}x"]).max()
        assert run[f"rotor.{prefix}x"][-1] == pytest.approx(expected.x[0, at], abs=1e-4 * size)


def test_a_settled_run_and_the_equations_have_the_same_forces_at_the_feet():
    limits = [1.4e-3, 2.8e-3, 4.5e-3]
    scene = on_a_tub(run={"revolutions": 400}, rotor=DISC | {"zone_limits": limits})
    expected, found = scene.rotor().forces(), cosimulate(scene).forces()
    by_run, by_equations = ({row[0]: row for row in sheet.rows} for sheet in (found, expected))
    assert set(by_run) == {"support[1]", "tub.foot[1]"}
    for place, row in by_run.items():
        assert row[1:3] == pytest.approx(by_equations[place][1:3], rel=1e-6)
    foot = by_run["tub.foot[1]"]
    assert foot[2] == pytest.approx(foot[1] / (3e-3 * 150.0**2), rel=1e-12)
    assert foot[4] == "B"
    assert by_run["support[1]"][4] == ""


def test_a_free_tool_does_not_drift_and_says_what_hands_feel():
    tool = {
        "kind": "two_support", "mass": 0.5, "inertia": 1e-3, "polar_inertia": 4e-4, "span": 0.1,
        "stiffness": [[1e7, 1e7]] * 2, "planes": [0.14],
        "unbalances": [{"position": 0.14, "amount": 2e-5}],
    }  # fmt: skip
    rest = {"name": "tub", "mass": 2.0, "transverse_inertia": 7e-3, "center": 0.05}
    rest["handles"] = [{"name": "side", "position": 0.1}]
    scene = on_a_tub(tool, rest, speed=1000.0, run={"revolutions": 100})
    run = cosimulate(scene)
    moved = np.hypot(run["rotor.station[3].x"], run["rotor.station[3].y"])
    assert moved.max() == pytest.approx(moved.min(), rel=1e-6)
    side = next(row for row in run.forces().rows if row[0] == "tub.side")
    assert side[5] == pytest.approx(19.842, rel=0.02)  # of a rigid tool
    with pytest.raises(ab.SceneError, match="nothing carries 'tub'"):
        scene.replace({"operation.gravity": 9.81})


def test_an_absorber_hangs_on_the_rotor():
    """Tuned to the speed and undamped, it leaves the rotor at rest."""
    absorber = {"name": "absorber", "mass": 1.0, "on": "rotor"}
    absorber["feet"] = [{"stiffness": 1.0 * 150.0**2}]
    scene = ab.Scene(rotor=DISC | {"bodies": [absorber]}, speed=150.0)
    motion = influence(scene.assembly().rotor, 150.0, np.eye(2)) @ scene.assembly().rotor.unbalance
    assert abs(motion[0, 0]) < 1e-9 * abs(motion[0, 1])


@pytest.mark.parametrize(
    ("rotor", "body", "words"),
    [
        (DISC, TUB | {"name": "ground"}, r"rotor\.bodies\[1\]\.name"),
        (DISC | {"on": "floor"}, TUB, "must be one of 'ground', 'tub'"),
        (DISC, TUB | {"feet": []}, "only the body that carries the rotor can be free"),
    ],
)
def test_bodies_that_cannot_be_are_refused(rotor, body, words):
    with pytest.raises(ab.SceneError, match=words):
        ab.Scene(rotor={"on": "ground"} | rotor | {"bodies": [body]}, speed=100.0)


def test_stability_on_a_tub_is_proved_as_floquet_has_it():
    scene = on_a_tub(balancer=[BALLS])
    found = scene.speeds(50.0, 300.0, "floquet").methods["floquet"]
    limits = [crossing.speed for crossing in found]
    bands = scene.speeds(50.0, 300.0, "proved", narrowest=0.5).proof.bands
    assert len(limits) >= 2
    assert {band.state for band in bands} >= {"stable", "unstable"}
    for limit in limits:
        assert any(b.low <= limit <= b.high for b in bands if b.state == "undecided")


@pytest.mark.parametrize("family", ["tilting", "bearings", "bodies", "rubber", "tables"])
def test_a_random_machine_of_each_kind_errs_within_its_estimate(family):
    assert compare(family, 0).word == "within"


@pytest.mark.parametrize("family", FAMILIES)
def test_growth_about_balance_is_that_of_the_equations_in_one_piece(family):
    assert first_words(growth_word, family, 2) == {"alike": 2}
