"""The page about a machine: verdict first, self-contained, and true of what was run."""

from __future__ import annotations

import math
import re
import subprocess
import sys
from xml.etree import ElementTree

import numpy as np
import pytest

import autobalancer as ab
from autobalancer.harness.errors import UserError
from autobalancer.harness.motions.kinds import Kind, Motion
from autobalancer.harness.motions.outcome import Motions, Point, Share
from autobalancer.harness.output.words import in_html
from autobalancer.harness.report import answers
from autobalancer.harness.report.drawing import machine_drawing
from autobalancer.harness.report.runs import SwitchedOn, switched_on
from autobalancer.harness.report.sections import assumptions
from autobalancer.models.harmonic_balance import largest_displacement, unbalance_response

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    written = ab.load("two_balls").report(folder / "page.html", limit="4.5 mm/s", run_up="60 s")
    return written, written.path.read_text(encoding="utf-8")


def test_a_script_without_a_guard_writes_a_page_with_its_random_starts(page, tmp_path):
    script = tmp_path / "plain.py"
    script.write_text(
        "import autobalancer as ab\n"
        "page = ab.load('two_balls').report('p.html', limit='4.5 mm/s', run_up='60 s')\n"
        "print(page.verdicts[0])\n"
    )
    done = subprocess.run([sys.executable, script], cwd=tmp_path, capture_output=True, text=True)
    assert done.stdout.strip() == page[0].verdicts[0]
    assert "random starts" in done.stdout
    assert not done.stderr


def test_page_asks_no_network_for_anything(page):
    _, text = page
    assert not re.search(r'(?:src|href)="(?!data:)', text)
    assert "<script" not in text


def test_verdicts_stand_before_every_section(page):
    written, text = page
    places = [text.index(part[:30]) for part in written.verdicts]
    assert max(places) < text.index("<h2>")


def test_page_repeats_the_command_and_holds_the_scene(page):
    _, text = page
    assert "How to do it again" in text
    assert "[rotor]" in text


def test_a_page_states_every_verdict_once_and_shows_commands_as_code(page):
    written, text = page
    before, *_ = text.split("How to do it again")
    for said in written.verdicts:
        assert before.count(in_html(said)) == 1
    assert "<code>autobalancer speeds --method proved</code>" in before
    assert "`" not in before


def test_what_stands_in_backticks_is_code_and_everything_is_escaped():
    assert in_html("see `a < b` & <c>") == "see <code>a &lt; b</code> &amp; &lt;c&gt;"
    assert in_html("a lone ` stays") == "a lone ` stays"


def test_run_up_of_the_page_is_the_median_of_random_starts(page):
    written, _ = page
    random, scene = np.random.default_rng(9), ab.load("two_balls")
    speed = scene.profile().end
    corners = [[0.0, 0.0], [60.0, speed], [60.0 + 60.0 * math.pi / speed, speed]]
    drive = {"operation.speed": None, "operation.profile": corners, "run.revolutions": None}
    peaks = []
    for _ in range(9):
        angles = random.uniform(0.0, math.tau, 2).tolist()
        start = {"weights.speeds": [0.0, 0.0], "weights.angles": angles, "run.record": None}
        run = scene.replace({**start, **drive}).run()
        peaks.append(1e3 * np.hypot(run["rotor.x"], run["rotor.y"]).max())
    said = re.search(r"a largest vibration of ([\d.]+) mm .*median of 40", written.verdicts[0])
    assert said is not None
    assert min(peaks) < float(said[1]) < max(peaks)


@pytest.mark.parametrize(
    ("peak", "balanced", "words"),
    [(0.9, 40, "Balancers are better here than none."), (2.0, 40, "worse in the run-up"),
     (0.9, 20, "only if they balance")],
)  # fmt: skip
def test_verdict_counts_random_starts_and_not_only_evenly_spread_weights(
    monkeypatch, peak, balanced, words
):
    """Weights that begin evenly spread vibrate as if there were none, and random ones more."""
    shares = tuple(
        Share(Motion(kind), count, 40, math.nan, 0.0)
        for kind, count in ((Kind.BALANCED, balanced), (Kind.IRREGULAR, 40 - balanced))
    )
    point = Point(3.0, "run-up", shares, 1.0, peak)
    ends = {"with": (0.1, 1.0), "without": (1.0, 1.0)}
    monkeypatch.setattr(answers, "ends_and_peaks", ends.get)
    monkeypatch.setattr(answers, "is_settled", bool)
    scene = ab.load("two_balls")
    found = Motions("", (point,), 40, (), scene)
    answer = answers.fitted(SwitchedOn(scene, "with", "without", motions=found))
    assert words in answer.text
    assert f"40 random starts, of which {balanced} balance" in answer.text
    assert answer.good is {0.9: balanced == 40, 2.0: None}[peak]


def test_run_that_is_drawn_vibrates_as_the_median_of_random_starts(page):
    written, text = page
    said = re.search(r"a largest vibration of ([\d.]+) mm", written.verdicts[0])
    row = re.search(r"<td[^>]*>switched on</td>(.*?)</tr>", text, re.S)
    assert said
    assert row
    peak = re.findall(r"([\d.]+) mm", row[1])[-1]
    assert float(peak) == pytest.approx(float(said[1]), rel=0.05)


@pytest.mark.parametrize("name", ab.bundled_scenes())
def test_drawing_shows_every_weight_and_support(name):
    scene = ab.load(name)
    root = ElementTree.fromstring(machine_drawing(scene))
    classes = [shape.get("class") for shape in root.iter()]
    assert classes.count("weight") == sum(getattr(b, "count", 0) for b in scene.balancer)
    words = [text.text for text in root.iter(f"{SVG}text")]
    assert {b.label for b in scene.balancer} <= set(words)


@pytest.mark.parametrize("kind", ["ring", "x", "y"])
@pytest.mark.parametrize("name", ["two_balls", "drum", "washing_machine_tub"])
def test_drawing_shows_stops_with_their_gaps(name, kind):
    stop = {"gap": "3 mm", "stiffness": 1e5, "kind": kind}
    scene = ab.load(name).replace({"rotor.stops": [stop]})
    root = ElementTree.fromstring(machine_drawing(scene))
    classes = [shape.get("class") for shape in root.iter()]
    called = "ring" if kind == "ring" else f"stop along {kind}"
    around = kind == "ring" and scene.rotor.kind == "planar"
    assert (classes.count("stop"), classes.count("bumper")) == ((1, 0) if around else (0, 2))
    assert f"{called} at support 1, gap 3 mm" in [t.text for t in root.iter(f"{SVG}text")]


@pytest.mark.parametrize(
    "given", [{"run_up": "0 s"}, {"limit": -1.0}, {"limit": 4.5}, {"run_up": "4 kg"}]
)
def test_wrong_values_are_refused_by_name(given, tmp_path):
    with pytest.raises(UserError, match=next(iter(given))):
        ab.load("two_balls").report(tmp_path / "page.html", **given)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("vary", "words"),
    [
        ("x", "must be PATH=NAME"),
        ("weights.dragg=normal(1,1%)", "did you mean"),
        ("weights.drag=normal(0,1)", "draws .* which is not allowed"),
    ],
)
def test_wrong_tolerances_are_refused_before_anything_runs(vary, words, tmp_path, monkeypatch):
    monkeypatch.setattr("autobalancer.harness.report.page.own_run", pytest.fail)
    with pytest.raises(UserError, match=words):
        ab.load("two_balls").report(tmp_path / "page.html", vary=[vary])


@pytest.mark.parametrize("name", ["liquid_closed", "sommerfeld"])
def test_liquid_and_motor_have_a_page(name, tmp_path):
    written = ab.load(name).report(tmp_path / "page.html")
    assert written.path.stat().st_size > 10_000


def with_ring(damping_ratio):
    """A ring of liquid that lowers the vibration, on supports with so much damping."""
    rotor = {"kind": "planar", "mass": 38.0, "stiffness": 8e3, "unbalance": 0.025}
    ring = {"name": "ring", "kind": "ring", "wall_radius": 0.25, "inner_wall_radius": 0.21,
            "fill": 0.5, "height": 0.06, "density": 1e3, "wave_damping": 0.4}  # fmt: skip
    rotor["damping_ratio"] = damping_ratio
    return ab.Scene(rotor=rotor, balancer=[ring], operation={"speed": 83.8})


def test_a_run_up_that_has_not_settled_is_run_longer_before_it_is_judged():
    scene = with_ring(0.005)
    started = switched_on(scene, 2.0)
    answer = answers.fitted(started)
    response = unbalance_response(scene.assembly().loaded_rotor, [83.8])
    steady = largest_displacement(response)[0, 0]  # the other station is the wave
    said = re.search(r"At speed it vibrates ([\d.]+) mm", answer.text)
    assert 1e-3 * float(said[1]) == pytest.approx(steady, rel=0.02)
    assert answer.good is not False
    assert "not settled" not in str(started.run.summary())


def test_a_run_up_that_never_settles_is_not_called_better_or_worse(monkeypatch):
    monkeypatch.setattr("autobalancer.harness.report.runs.LONGEST", 10)
    answer = answers.fitted(switched_on(with_ring(0.005), 2.0))
    assert answer.good is None
    assert answer.text.startswith("Whether balancers are better here is not known: ")


@pytest.mark.parametrize(
    ("low", "switched", "begins"),
    [
        (
            1.0,
            "Switched on at 1 rad/s",
            "the rotor at 1 rad/s = 9.549 rpm, weights turning with it",
        ),
        (0.0, "Switched on from rest: ", "rotor and weights at rest"),
    ],
)
def test_a_run_up_from_the_lowest_speed_of_a_table_is_not_called_one_from_rest(
    low, switched, begins
):
    rows = [[low, 1.0, 0, 0, 1.0, 0.1, 0, 0, 0.1], [6.0, 1.5, 0, 0, 1.5, 0.1, 0, 0, 0.1]]
    rotor = {"kind": "planar", "mass": 1.0, "unbalance": 0.01, "bearings": [{"table": rows}]}
    balls = {"name": "balls", "kind": "balls", "count": 2, "mass": 0.03, "track_radius": 1.0}
    scene = ab.Scene(rotor=rotor, balancer=[{**balls, "drag": 0.05}], operation={"speed": 3.0})
    started = switched_on(scene)
    own = scene.run()
    assert started.run.scene.profile().speed(0.0) == low
    assert any(one.text.startswith(switched) for one in answers.verdicts(scene, own, started))
    said = assumptions(scene, own, started)
    assert any(str(part).startswith(f"The run-up begins with {begins}") for part in said)
    assert f"run-up: {begins}, the speed rises." in scene.motions(starts="run-up", n=1).notes
