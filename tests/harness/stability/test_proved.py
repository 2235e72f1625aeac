"""Bands that are proved: they agree with Floquet and closed forms, for all machines in a box."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

import mpmath
import numpy as np
import pytest

flint = pytest.importorskip("flint", reason="the extra `proof` is not installed")

from autobalancer.harness import Scene, UserError, load_scene, speeds  # noqa: E402
from autobalancer.harness.checks.filimonikhina import OUTSIDE, RANGE, TABLES, variant  # noqa: E402
from autobalancer.harness.checks.proved import bracket_rows  # noqa: E402
from autobalancer.harness.checks.row import Rows  # noqa: E402
from autobalancer.harness.commands.speeds import bands_table  # noqa: E402
from autobalancer.harness.stability.ball_tables import Tables  # noqa: E402
from autobalancer.harness.stability.exact import tolerances  # noqa: E402
from autobalancer.harness.stability.proved import Band, Proof, prove  # noqa: E402
from autobalancer.models.boundaries import balancing_boundaries  # noqa: E402
from autobalancer.models.stability import growth_rates  # noqa: E402
from tests.studies.truth.draw import draw  # noqa: E402


def proof_of(scene, low: float, high: float, **options) -> Proof:
    result = speeds(scene, (low, high), ["proved"], **options)
    assert not result.refused
    return result.proof


def refuted(bands: tuple[Band, ...], speed: float, growth: float) -> bool:
    """Whether a growth rate contradicts the band that holds the speed."""
    (state, *_) = (b.state for b in bands if b.low <= speed <= b.high)
    return state == ("stable" if growth > 0.0 else "unstable")


def holds(ball, value: Fraction) -> bool:
    """Whether a ball contains an exact number."""
    (m, e), (n, f) = (part.man_exp() for part in (ball.mid(), ball.rad()))
    middle, radius = (int(k) * Fraction(2) ** int(x) for k, x in ((m, e), (n, f)))
    return abs(value - middle) <= radius


def test_numbers_are_the_decimals_that_are_written_and_units_are_enclosed():
    changes = {"rotor.stiffness": 0.1, "weights.angles": ["30 deg", 1.0], "rotor.mass": "1 lb"}
    with flint.ctx.workprec(128):
        tables = Tables(load_scene("filimonikhina").replace(changes))
    stiffness, mass = tables.rotor["stiffness"], tables.rotor["mass"]
    assert stiffness[0] is stiffness[1]  # one number for both axes
    assert holds(stiffness[0], Fraction(1, 10))
    assert not holds(stiffness[0], Fraction(0.1))
    assert holds(mass, Fraction("0.45359237"))
    assert float(mass.rad()) < 1e-14
    assert tables.balancers["weights"]["angles"][0].overlaps(flint.arb.pi() / 6)


@pytest.mark.parametrize(
    "index",
    [
        pytest.param(k, marks=() if k in (0, 3, 19) else pytest.mark.slow)
        for k in range(len(TABLES))
    ],
)
def test_boundaries_of_the_papers_tables_are_proved_within_1e_6(index):
    """Every boundary of Floquet in a bracket of its own, one in or next to each of the paper's."""
    row = TABLES[index]
    scene, w_x = variant(load_scene("filimonikhina_tables"), row)
    low, high = RANGE[0] * w_x, RANGE[1] * w_x
    proof = proof_of(scene, low, high, narrowest=1e-6 * w_x)
    crossings = balancing_boundaries(scene.assembly(), low, high, narrowest=0.02 * w_x)
    for (band, found), crossing in zip(proof.boundaries, crossings, strict=True):
        assert band.high - band.low <= 1e-6 * w_x
        assert band.low <= crossing.speed <= band.high
        assert found.above == crossing.above
    for begin, end in row.intervals:
        outside = [max(begin * w_x - b.high, b.low - end * w_x) for b, _ in proof.boundaries]
        assert min(outside) <= OUTSIDE[row.table] * w_x


def test_dubovik_s_limits_have_30_digits():
    window = proof_of(load_scene("liquid_disc"), 50.0, 500.0).as_json()["window"]
    with mpmath.workdps(40):
        number = mpmath.mpf
        added = number(1000) * mpmath.pi * number("0.1") ** 2 * number("0.05")
        stiffness, mass = number("82081.5"), number(6)
        limits = {
            "less_bending_above": mpmath.sqrt(2 * stiffness / (2 * mass + added)),
            "stable_below": (1 + number(36) / 12) * mpmath.sqrt(stiffness / (mass + added)),
        }
        for name, limit in limits.items():
            digits, radius = window[name]["ball"].strip("[]").split(" +/- ")
            assert abs(number(digits) - limit) <= number(radius) < limit * number(10) ** -30
    assert window["state"] == "open"


def test_limits_within_tolerances_are_shown_as_two_speeds():
    """Of Dubovik's (10): w^* = (1 + chi/p) sqrt(c/m), with both dampings off by 10 %."""
    within = "rotor.damping=10%, rotor.internal_damping=10%"
    scene = load_scene("liquid_disc")
    *_, line = proof_of(scene, 100.0, 700.0, within=within).lines()
    usual = 416.49697562027679 / (1.0 + 36.0 / 12.0)
    low, high = (usual * (1.0 + 3.0 * ratio) for ratio in (0.9 / 1.1, 1.1 / 0.9))
    shown = line.removeprefix("stable below ").removesuffix(" rad/s").split(" to ")
    assert [float(end) for end in shown] == pytest.approx([low, high], rel=1e-8)
    assert float(shown[0]) < low < high < float(shown[1])  # rounded outwards


def test_limits_are_shown_in_engineers_units(invoke):
    line = ("speeds", "liquid_disc", "--range", "100", "700", "--method", "proved")
    outcome = invoke(*line, "--units", "engineering")
    assert "proved: stable below 3977.253147 to 3977.253148 rpm" in outcome.output


@pytest.mark.parametrize(
    ("name", "state"), [("liquid_closed", "empty"), ("liquid_no_internal", "unbounded")]
)
def test_an_empty_and_an_unbounded_window_are_proved(name, state):
    proof = proof_of(load_scene(name), 10.0, 500.0, within="rotor.stiffness=3%, liquid.height=2%")
    assert proof.window.state == state
    assert ({b.state for b in proof.bands} == {"stable"}) == (state == "unbounded")


@pytest.mark.parametrize(
    ("name", "low", "high", "within", "undecided"),
    [
        ("liquid_disc", 50.0, 500.0, "rotor.damping=10%, rotor.internal_damping=10%", 0.35),
        ("centrifuge", 11.0, 14.0, "rotor.stiffness=2%", 0.2),
        ("filimonikhina", 0.5, 12.0, "rotor.stiffness[1]=1%, rotor.stiffness[2]=1%", 0.02),
    ],
)
def test_no_machine_within_the_tolerances_contradicts_a_band(name, low, high, within, undecided):
    scene = load_scene(name)
    proof = proof_of(scene, low, high, within=within)
    assert proof.undecided < undecided
    assert {"stable", "unstable"} <= {b.state for b in proof.bands}
    assert all(a.high == b.low for a, b in pairwise(proof.bands))
    random = np.random.default_rng(5)
    for _ in range(12):
        machine = {}
        for item in within.split(","):
            path, amount = (part.strip() for part in item.split("="))
            table, key = path.split("[")[0].split(".")
            value = getattr(scene.rotor if table == "rotor" else scene.balancer[0], key)
            if isinstance(value, tuple):
                value = value[int(path[-2]) - 1 if "[" in path else 0]
            size = float(amount.rstrip("%").split()[0])
            part = size / 100.0 * value if "%" in amount else size
            machine[path] = value + random.choice([-1.0, random.uniform(-1, 1), 1.0]) * part
        places = random.uniform(low, high, 40)
        for speed, growth in zip(
            places, growth_rates(scene.replace(machine).assembly(), places), strict=True
        ):
            assert not refuted(proof.bands, speed, growth), (machine, speed)


@pytest.mark.parametrize(
    ("family", "number"),
    [
        *[("planar", k) for k in (0, 5)],
        *[("heavy", k) for k in (0, 1, 3, 4, 5)],
        *[("liquid", k) for k in (0, 2, 3)],
        *[pytest.param(name, k, marks=pytest.mark.slow)
          for name, k in (("flexible", 3), ("two_support", 4))],
    ],
)  # fmt: skip
def test_random_machines_do_not_contradict_their_bands(family, number):
    scene = Scene.from_document(draw(family, 1, number))
    speed = scene.profile().end
    proof = proof_of(scene, 0.5 * speed, 1.5 * speed, narrowest=1e-3 * speed)
    assert proof.undecided < 0.01
    places = np.random.default_rng(1).uniform(0.5 * speed, 1.5 * speed, 200)
    for place, growth in zip(places, growth_rates(scene.assembly(), places), strict=True):
        assert abs(growth) < 1e-9 * place or not refuted(proof.bands, place, growth)


def test_numbers_of_both_axes_are_parameters_of_their_own():
    changes = tolerances("rotor.stiffness=5%, front.drag=9%", load_scene("drum"))
    assert [change.number for change in changes] == [0, 1, 2, 3, 0]
    assert len(tolerances("rotor.stiffness=5%", load_scene("liquid_disc"))) == 1


def test_narrowest_is_the_width_of_undecided_bands():
    scene = load_scene("three_mass_shaft")
    for width in (1e-2, 1e-9):
        proof = prove(scene, 1.5, 5.0, narrowest=width)
        assert len(proof.boundaries) == 3
        assert max(band.high - band.low for band, _ in proof.boundaries) <= width


def test_the_command_writes_bands_without_gaps(invoke, tmp_path):
    file = tmp_path / "speeds.json"
    line = ("speeds", "fan", "--range", "300rpm", "3000rpm", "--method", "proved,floquet")
    outcome = invoke(*line, "--json", file)
    assert outcome.exit_code == 0, outcome.output
    written = json.loads(file.read_text())
    bands = written["methods"]["proved"]
    assert [bands[0]["from"], bands[-1]["to"]] == written["range"]
    assert all(a["to"] == b["from"] for a, b in pairwise(bands))
    assert [b["state"] for b in bands] == ["unstable", "undecided", "stable"]
    (crossing,) = written["methods"]["floquet"]
    assert bands[1]["from"] <= crossing["speed"] <= bands[1]["to"]
    assert written["proof"]["precision"] == 128
    assert written["proof"]["undecided_share"] < 1e-6
    assert "undecided" in outcome.output


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("optical_drive", "balls.weight_radius: contacts"),
        ("sommerfeld", "2 weights can make at most 4 g m"),
    ],
)
def test_what_is_not_proved_is_refused_by_name(name, words):
    result = speeds(load_scene(name), (10.0, 100.0), ["proved"])
    assert result.proof is None
    assert words in result.refused["proved"]


@pytest.mark.parametrize(
    ("within", "words"),
    [
        ("rotor.stiffness", "must be PATH=5%"),
        ("rotor.kind=5%", "an interval needs a number"),
        ("weights.count=5%", "an interval needs a number"),
        ("speed=5%", "an interval needs a number"),
        ("rotor.stiffness=-5%", "must be 0 or more"),
        ("rotor.stiffness=5 kg", "a stiffness"),
    ],
)
def test_wrong_tolerances_are_refused(within, words):
    with pytest.raises(UserError, match=words):
        speeds(load_scene("filimonikhina"), (1.0, 2.0), ["proved"], within=within)
    with pytest.raises(UserError, match="belongs to the method proved"):
        speeds(load_scene("filimonikhina"), (1.0, 2.0), ["floquet"], within="rotor.mass=1%")


@pytest.mark.parametrize(
    ("within", "words"),
    [
        ("rotor.mass=5", r"within rotor.mass=5: .* rotor.mass = -4.01 kg: must be greater than 0"),
        ("rotor.mass=100%", r"within rotor.mass=100%: .* rotor.mass = 0.0 kg"),
        ("rotor.stiffness=2 N/m", r"rotor.stiffness\[1\] = -1.0 N/m: must be greater than 0"),
        ("rotor.mass=1%, weights.drag=0.01", r"drag = -0.0075 N s/m: must be 0 or more"),
    ],
)
def test_bands_that_reach_values_the_scene_does_not_allow_are_refused(within, words):
    with pytest.raises(UserError, match=words):
        tolerances(within, load_scene("filimonikhina"))


def test_bands_that_reach_what_the_scene_does_not_allow_only_together_are_refused():
    """The polar inertia is at most twice the other one: each band alone keeps that."""
    rotor = {"kind": "two_support", "mass": 8.0, "inertia": 0.5, "polar_inertia": 0.95,
             "span": 0.4, "stiffness": [2e4, 2e4], "damping": [20.0, 20.0]}  # fmt: skip
    scene = Scene(rotor=rotor, operation={"speed": 100.0})
    for alone in ("rotor.inertia=4%", "rotor.polar_inertia=4%"):
        assert len(tolerances(alone, scene)) == 1
    within = "rotor.inertia=4%, rotor.polar_inertia=4%"
    with pytest.raises(UserError, match=r"bands together reach a value .*polar_inertia"):
        tolerances(within, scene)


def test_a_band_may_reach_the_end_of_what_the_scene_allows():
    found = tolerances("weights.drag=100%", load_scene("filimonikhina"))
    assert [(one.low, one.high) for one in found] == [(-1.0, 1.0)]


def test_a_check_s_row_holds_where_floquet_lies_in_the_proved_bracket_alone():
    scene, w_x = variant(load_scene("filimonikhina_tables"), TABLES[17])
    found = speeds(scene, (8.5 * w_x, 9.0 * w_x), ["floquet"])
    (crossing,) = found.methods["floquet"]
    moved = {"floquet": (replace(crossing, speed=crossing.speed * (1.0 + 1e-6)),)}
    for speeds_found, holds in ((found, True), (replace(found, methods=moved), False)):
        (row,) = bracket_rows(Rows("scene", "check"), scene, speeds_found, "", w_x)
        assert row.holds is holds


@pytest.mark.parametrize(
    ("name", "x", "y", "share"),
    [
        ("liquid_disc", "speed=50:800:6", "rotor.internal_damping=2:40:6", 0.1),
        ("filimonikhina", "speed=2:8:12", "rotor.damping=0.1:1:8:log", 0.25),
        ("filimonikhina", "weights.drag=0.02:0.1:3", "rotor.damping=0.1:1:3", 0.1),
    ],
)
def test_no_machine_of_a_map_contradicts_its_cell(name, x, y, share):
    scene = load_scene(name)
    found = scene.map(x, y, "proved")
    assert (found.parts == 0).mean() < share
    random = np.random.default_rng(2)
    states = set()
    for *cell, state in found.table().rows:
        states.add(state)
        place = {found.x.path: random.uniform(*cell[:2]), found.y.path: random.uniform(*cell[2:])}
        machine = scene.replace(place)
        (growth,) = growth_rates(machine.assembly(), machine.profile().end)
        assert state != ("stable" if growth > 0.0 else "unstable"), place
    assert states >= ({"stable", "unstable"} if "speed" in x else {"stable"})


def test_the_map_command_draws_cells_and_keeps_no_store(invoke, tmp_path):
    files = tmp_path / "map.png", tmp_path / "map.csv", tmp_path / "map.store"
    line = ("map", "liquid_disc", "--x", "speed=50:800:5", "--y", "rotor.mass=5:7:3")
    line += ("--method", "proved")
    outcome = invoke(*line, "-o", files[0], "--csv", files[1])
    assert outcome.exit_code == 0, outcome.output
    assert "15 cells" in outcome.output
    assert files[0].stat().st_size > 1000
    assert len(files[1].read_text().splitlines()) >= 16
    assert "keeps no store" in invoke(*line, "--store", files[2]).output


def test_ends_of_a_narrow_band_can_be_told_apart_in_rpm():
    bands = (Band(157.0796, 157.0797, "stable"), Band(157.0797, 300.0, "unstable"))
    narrow, wide = (row[-1] for row in bands_table(Proof(bands, 1e-4, 1), "").rows)
    low, high = (float(narrow.split()[k]) for k in (0, 3))
    assert low < high
    assert [low, high] == pytest.approx([1499.9997, 1500.0007], abs=6e-4)
    assert wide == "1500 rpm to 2865 rpm"


def test_a_tolerance_of_a_value_is_given_once():
    for twice in ("rotor.mass=1%, rotor.mass=2%", "rotor.stiffness=1%,rotor.stiffness=1%"):
        with pytest.raises(UserError, match="is given twice"):
            tolerances(twice, load_scene("two_balls"))


@pytest.mark.parametrize("twice", [
    "rotor.stiffness=1%, rotor.stiffness[1]=2%",
    "rotor.stiffness[x]=1%, rotor.stiffness=2%",
    "rotor.stiffness[x]=1%, rotor.stiffness[1]=2%",
])  # fmt: skip
def test_a_tolerance_of_a_list_is_that_of_each_of_its_values(twice):
    scene = load_scene("two_balls").replace({"rotor.stiffness": [1.0, 1.1]})
    with pytest.raises(UserError, match="is given twice"):
        tolerances(twice, scene)
    apart = tolerances("rotor.stiffness[x]=1%, rotor.stiffness[y]=2%", scene)
    assert [(one.path, one.high) for one in apart] == [
        ("rotor.stiffness[x]", 0.01), ("rotor.stiffness[y]", 0.02),
    ]  # fmt: skip
