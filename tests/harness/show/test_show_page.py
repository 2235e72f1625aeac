"""The page in a browser: it runs the units themselves, and does what its controls say."""

import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import autobalancer as ab
from autobalancer.fmus.composite.batch import BatchRuns
from autobalancer.harness import bundled_scenes, load_scene, scenes
from autobalancer.harness.master.one_file import composition

pytestmark = pytest.mark.slow

MOST_BYTES = 680_000


@pytest.mark.parametrize("name", bundled_scenes())
def test_every_bundled_scene_is_a_page_that_runs(opened, name):
    shown = opened(name, running=True)
    assert shown.path.stat().st_size <= MOST_BYTES
    shown.wait("return machine.time > 0 && page.frames > 8")
    assert shown("return page.view.running") is True  # a warning may stand there, as of a float
    assert shown("return performance.getEntriesByType('resource').length") == 0


RECORDED = """
    const [end, points, names] = arguments;
    machine.units.begin({}, 0);
    const read = machine.units.reader(names), rows = [Array.from(read())];
    for (let k = 1; k <= points; k++) {
      machine.units.advance(end * (k / points));
      rows.push(Array.from(read()));
    }
    return rows;"""


@pytest.mark.parametrize(
    "name", ["two_balls", "liquid_disc", "three_mass_shaft", "run_up", "washing_machine"]
)
def test_numbers_are_those_of_the_composite_to_the_last_bit(opened, name):
    made = composition(load_scene(name))
    layout = made.described("Composite").layout
    asked = [v.name for v in layout.reals if v.causality == "output"]
    points, end = 200, made.stop / 4.0
    mass = next(v for v in layout.variables if v.name.endswith("mass"))
    runs = BatchRuns(made, [mass.name], asked, points)
    ((expected,), (reason,)) = runs([[mass.start]], [end])
    rows = opened(name)(RECORDED, end, points, asked)
    assert reason == ""
    assert np.array_equal(rows, expected)


def test_a_page_follows_speed_and_unbalance_until_a_slider_moves(opened):
    """Spin and unbalance of the scene; what a slider changes goes on from the speed of now."""
    shown, top = opened("washing_machine"), 1000.0 * math.pi / 30.0
    assert shown("return machine.data.profile") == [
        [0, 0],
        [3, pytest.approx(top)],
        [16, pytest.approx(top)],
        [19, 0],
    ]
    for time, speed, amount in ((1.5, top / 2, 0.09), (7.0, top, 0.06), (9.5, top, 0.1)):
        shown(f"machine.advance({time}, Infinity)")
        assert shown("return machine.now.speed") == pytest.approx(speed)
        changed = shown("return machine.changed ?? [machine.units.value('rotor.unbalance')]")
        assert math.hypot(*changed) == pytest.approx(amount)
    assert shown("return machine.heavy") == pytest.approx(math.radians(100))
    assert shown("return machine.free") is False
    shown.slide("value_0", 0.5)  # 1.5 times the scene's own
    assert shown.value("rotor.unbalance") == pytest.approx(0.135, rel=1e-2)
    assert shown("return machine.changed") is None
    assert shown("return machine.heavy") == 0.0
    shown("machine.advance(14, Infinity)")
    assert shown("return machine.now.speed") == pytest.approx(top)


def test_sliders_set_what_they_say_and_the_motion_goes_on(opened):
    shown = opened("two_balls")
    shown("machine.advance(5, Infinity)")
    before = shown("return [machine.now.pairs[0].x, ...machine.now.angles]")
    labels = {"value_0": "rotor.unbalance", "value_3": "weights.drag", "value_4": "weights.mass"}
    for slider, variable in labels.items():
        start = shown.value(variable)
        shown.slide(slider, 0.9)
        number, unit = shown.said(slider).split(maxsplit=2)[:2]
        said = float(number) * (1e-3 if unit == "g" else 1.0)  # an unbalance in g m
        assert said == pytest.approx(shown.value(variable), rel=5e-3)
        assert shown.value(variable) > 2.0 * start
    shown.slide("value_1", 0.75)  # half way in the logarithm from 1 to 4
    assert shown.said("value_1") == "2 × the scene's"
    stiffness = [shown.value(f"rotor.stiffness_{axis}") for axis in "xy"]
    assert stiffness == pytest.approx([2.0, 98.0])
    assert shown("return machine.time") == pytest.approx(5.0, abs=0.05)
    assert shown("return [machine.now.pairs[0].x, ...machine.now.angles]") == before


def test_under_a_motor_its_torque_is_on_the_slider_and_the_speed_goes_on(opened):
    shown = opened("sommerfeld")
    shown("machine.advance(0.2, Infinity)")
    now = "return [machine.now.speed, machine.now.pairs[0].x, ...machine.now.angles]"
    before = shown(now)
    shown.slide("value_0", 0.25)
    assert shown.value("motor.point[1].torque") == pytest.approx(10.0, rel=1e-3)
    assert shown(now) == before
    assert shown("return document.querySelector('#speed')") is None
    shown("machine.runUp()")
    assert shown("return machine.now.speed") == 0.0
    shown("machine.advance(0.2, Infinity)")
    assert 0.0 < shown("return machine.now.speed") < 20.0 * 0.2 / 0.5


def test_weights_that_join_stand_in_the_widest_gap(opened):
    shown = opened("two_balls")
    shown("machine.advance(5, Infinity)")
    first, second = shown("return machine.now.angles")
    shown.slide("weights_0", 2 / 7)
    assert shown.said("weights_0") == "3"
    angles = shown("return machine.now.angles")
    assert angles[:2] == [first, second]
    to_others = [math.remainder(angles[2] - angle, math.tau) for angle in (first, second)]
    assert min(map(abs, to_others)) >= math.pi / 2
    assert sum(to_others) == pytest.approx(0.0, abs=1e-9)
    shown("machine.advance(6, Infinity)")
    shown.slide("weights_0", 0.0)
    assert len(shown("return machine.now.angles")) == 1
    assert shown.refusal() == ""


def test_the_speed_goes_to_where_its_slider_stands(opened):
    shown = opened("two_balls")
    shown.slide("speed", 0.5)
    wanted = shown("return machine.settings.speed")
    assert float(shown.said("speed").split()[0]) == pytest.approx(wanted, rel=5e-3)
    shown("machine.advance(1, Infinity)")
    assert 3.0 < shown.value("rotor.speed") < wanted
    assert shown.value("acceleration") == pytest.approx(shown("return machine.data.rate"))
    shown("machine.advance(60, Infinity)")
    assert shown.value("rotor.speed") == pytest.approx(wanted, rel=1e-9)
    assert shown.value("acceleration") == 0.0


def test_slow_motion_shows_what_is_between_samples(opened):
    shown = opened("two_balls")
    ways = []
    for parts in (1, 7):
        shown("machine.change({ speed: machine.data.speed }); machine.restart()")
        shown.slide("speed", 0.5)
        part = "machine.advance((k + 1) * 41.3 * machine.step / parts, Infinity)"
        shown(f"const parts = {parts} * 40; for (let k = 0; k < parts; k++) {part}")
        state = "const { x, y } = machine.now.pairs[0]; return [x, y, ...machine.now.angles]"
        ways.append(shown(state))
        assert shown("return machine.filled") == 41
    assert ways[1] == pytest.approx(ways[0], rel=1e-6)
    times = shown("return Array.from(machine.last(41, machine.history.time)[0])")
    assert np.diff(times) == pytest.approx(shown("return machine.step"), rel=1e-9)


def test_a_run_up_begins_at_rest_and_takes_another_speed_on_its_way(opened):
    shown = opened("two_balls")
    shown("machine.runUp()")
    assert shown.value("rotor.speed") == 0.0
    shown("machine.advance(10, Infinity)")
    reached = shown.value("rotor.speed")
    assert reached == pytest.approx(10.0 * shown("return machine.data.rate"), rel=1e-2)
    shown.slide("speed", 0.1)
    shown("machine.advance(120, Infinity)")
    assert shown.value("rotor.speed") == pytest.approx(shown("return machine.settings.speed"))
    assert shown.refusal() == ""


def test_a_value_changed_on_the_way_up_does_not_end_the_run_up(opened):
    shown = opened("run_up")  # to 150 rad/s in 2 s
    shown("machine.advance(0.5, Infinity)")
    assert shown.value("rotor.speed") == pytest.approx(37.5, rel=0.05)
    shown.slide("value_3", 0.6)
    assert shown.value("rotor.speed") == pytest.approx(37.5, rel=0.05)
    shown("machine.advance(3, Infinity)")
    assert shown.value("rotor.speed") == pytest.approx(150.0)
    assert shown.refusal() == ""


def test_tracks_that_differ_have_sliders_of_their_own(opened):
    scene = load_scene("three_mass_shaft").replace({"right.count": 3, "right.angles": None})
    shown = opened(scene)
    names = shown("return Object.values(page.sliders).map((s) => s.element.textContent)")
    own = [name for name in names if name.split(":")[-1].startswith((" left", " right"))]
    assert [name.split(":")[0] for name in own] == [
        *2 * ("Drag of the weights", "Mass of a weight"), "Weights", "Weights",
    ]  # fmt: skip
    assert [shown.said(f"weights_{k}") for k in (0, 1)] == ["2", "3"]
    shown("machine.advance(1, Infinity)")
    before = shown("return machine.now.angles")
    shown.slide("weights_1", 0.0)
    labels = "return machine.weights.map(({ label }) => label)"
    assert shown(labels) == ["left", "left", "right"]
    assert shown("return machine.now.angles") == before[:3]
    shown.slide("weights_0", 3 / 7)
    assert [shown.said(f"weights_{k}") for k in (0, 1)] == ["4", "1"]
    shown.slide("value_6", 1.0)
    assert shown.said("value_6") == "40 g"
    masses = [shown.value(f"{name}.mass") for name in ("left", "right")]
    assert masses == pytest.approx([0.01, 0.04])


def test_a_kick_changes_the_momentum_by_its_impulse(opened):
    shown = opened("two_balls")
    step = "machine.advance(machine.step, Infinity)"
    run = "machine.restart(); {} " + step + "; return machine.units.value('rotor.vx')"
    pushed, left = shown(run.format("machine.kick();")), shown(run.format(""))
    impulse, step = shown("return [machine.data.kick, machine.step]")
    scene = load_scene("two_balls")
    mass = scene.rotor.mass + sum(b.count * b.mass for b in scene.balancer)
    # damping and weights take a little of it within the step
    assert (pushed - left) * mass == pytest.approx(impulse, rel=0.1)
    assert step < 0.1


def test_what_the_units_refuse_is_said_and_the_former_values_stay(opened):
    shown = opened("two_balls")
    shown("page.change({ factors: [-1, 1, 1, 1, 1] })")
    assert "rotor.unbalance = -0.025 kg.m" in shown.refusal()
    assert shown.value("rotor.unbalance") == 0.025
    shown("machine.advance(1, Infinity)")
    shown("page.change({ factors: [0.5, 1, 1, 1, 1] })")
    assert shown.refusal() == ""


def test_a_step_that_fails_pauses_the_page_and_says_why(opened):
    shown = opened("two_balls")
    shown("machine.data.kick = 1e306; machine.kick(); page.view.running = true")
    assert "failed" in shown.wait("return document.getElementById('refusal').textContent")
    assert shown("return page.view.running") is False
    assert shown("return document.getElementById('start').innerText") == "Start"


def test_what_the_units_warn_of_is_said_and_the_motion_goes_on(opened):
    shown = opened("liquid_touch", running=True)
    said = shown.wait("return document.getElementById('refusal').textContent")
    assert "the float touches the chamber" in said
    time = shown("return machine.time")
    shown.wait(f"return machine.time > {time}")


def test_a_motion_that_grows_without_bound_is_ended_in_words(opened):
    shown = opened("liquid_closed")  # unstable above 109 rad/s
    shown.slide("speed", 1.0)
    shown("machine.advance(25, Infinity); page.shownTime = machine.time; page.view.running = true")
    said = "return document.getElementById('refusal').textContent"
    shown.wait(f"return ({said[7:]}).startsWith('Paused: the displacement')")
    assert shown("return page.view.running") is False


def test_keys_do_what_the_buttons_do(opened):
    shown = opened("two_balls", running=True)
    shown.press(" ")
    assert shown("return page.view.running") is False
    speed = shown("return machine.settings.speed")
    shown.press("ArrowRight")
    assert shown("return machine.settings.speed") > speed
    shown.press("s")
    assert shown("return page.view.slow") is True
    assert shown("return document.getElementById('slow').getAttribute('aria-pressed')") == "true"
    shown.press("r")
    shown.wait("return page.view.running && machine.time < 5")


def test_the_page_fits_a_phone(opened, phone):
    phone(390, 844)
    shown = opened("three_mass_shaft", running=True)
    shown.wait("return page.frames > 4")
    assert shown("return document.documentElement.scrollWidth") <= 390
    sizes = shown(
        "return [...document.querySelectorAll('button, input')].map((e) => e.offsetHeight)"
    )
    assert min(sizes) >= 32


def test_a_finger_that_scrolls_the_page_leaves_the_sliders_as_they_were(opened, browser, phone):
    """It touches one on its way; along a slider it moves that."""
    phone(360, 740)
    browser.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": True})

    def touch(kind, *points):
        told = {"type": f"touch{kind}", "touchPoints": [{"x": x, "y": y} for x, y in points]}
        browser.execute_cdp_cmd("Input.dispatchTouchEvent", told)

    def move(name, right, down):
        left, top, width, height = shown(
            "const e = document.getElementById(arguments[0]); e.scrollIntoView({block: 'center'});"
            "const r = e.getBoundingClientRect(); return [r.left, r.top, r.width, r.height]",
            name,
        )
        x, y = left + 0.8 * width, top + height / 2
        touch("Start", (x, y))
        for k in range(1, 16):
            touch("Move", (x + right * k, y + down * k))
        touch("End")

    try:
        shown = opened("two_balls")
        stiffness, factors = shown.value("rotor.stiffness_x"), "return machine.settings.factors"
        before, at = shown(factors), shown("return scrollY")
        move("value_1", 0, -15)
        shown.wait(f"return scrollY > {at} && machine.settings.factors[1] === 1")
        assert shown(factors) == before
        assert shown.value("rotor.stiffness_x") == stiffness
        move("value_1", -2, 0)
        assert 1.0 < shown(factors)[1] < 4.0
    finally:
        browser.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": False})


def test_left_and_right_change_the_speed_also_behind_a_button(opened):
    """A button that was clicked keeps the focus; a slider keeps its own arrows."""
    shown = opened("two_balls")
    before = shown("return machine.settings.speed")
    press = (
        "document.getElementById(arguments[0]).focus();"
        "document.activeElement.dispatchEvent(new KeyboardEvent('keydown',"
        "{ key: 'ArrowRight', bubbles: true, cancelable: true }))"
    )
    shown(press, "start")
    faster = shown("return machine.settings.speed")
    assert faster > before
    shown(press, "value_0")
    assert shown("return machine.settings.speed") == faster


@pytest.mark.parametrize("name", ["oval_fan", "two_balls"])
def test_the_pace_of_a_scene_is_one_of_its_slider(opened, name):
    shown = opened(name)
    assert shown("return page.sliders.pace.read()") == pytest.approx(
        shown("return page.view.pace"), rel=0.01
    )


def test_comments_of_the_sources_are_not_sent_with_the_page(opened):
    text = opened("two_balls").path.read_text(encoding="utf-8")
    assert not [line for line in text.splitlines() if line.lstrip().startswith(("/*", "*/"))]


def test_what_a_scene_is_called_is_text_and_no_code(opened):
    document = load_scene("two_balls").document
    title = "</script><img src=x onerror=alert(1)> {{DATA}} & <b>"
    document["title"], document["source"] = title, title
    scene = type(load_scene("two_balls")).from_document(document, label="named")
    shown = opened(scene)
    assert shown("return document.title") == title
    assert shown("return document.querySelector('h1').textContent") == title
    assert shown("return document.querySelectorAll('img, b').length") == 0


def words(shown, name):
    return shown("return document.getElementById(arguments[0]).textContent", name)


def test_the_page_says_whether_the_rotor_is_balanced_and_when_the_weights_are_used_up(opened):
    """Two weights of 0.05 kg at 0.5 m hold 0.05 kg m, twice the unbalance."""
    shown = opened("two_balls")
    shown("machine.advance(2, Infinity); page.facts()")
    assert "Not balanced now" in words(shown, "balance")
    shown("machine.advance(120, Infinity); machine.left = 0; page.facts()")
    assert words(shown, "balance").startswith("Balanced: ")
    assert "of 25 g m" in words(shown, "balance")
    assert "the weights use 50 %" in words(shown, "balance")
    shown.slide("value_0", 1.0)  # three times the unbalance
    shown("page.facts(); page.strip.show(machine.now.speed, machine.asScene())")
    assert words(shown, "balance") == "The weights are used up: they can hold 50 g m of 75 g m."
    assert shown("return document.getElementById('strip').classList.contains('stale')")
    assert "for the scene's own values" in words(shown, "strip_words")


def test_unbalances_stand_in_the_unit_of_their_slider(opened):
    shown = opened("sommerfeld")  # 4 g m at most, of 10 g m
    shown("page.facts()")
    assert words(shown, "balance") == "The weights are used up: they can hold 4 g m of 10 g m."


def test_space_opens_a_summary_and_a_held_key_acts_once(opened):
    shown = opened("two_balls")
    press = (
        "return document.querySelector(arguments[0]).dispatchEvent(new KeyboardEvent('keydown',"
        "{ key: arguments[1], repeat: arguments[2], bubbles: true, cancelable: true }))"
    )
    assert shown(press, "summary", " ", False) is True  # left to the browser
    assert shown(press, "body", "s", False) is False
    assert shown(press, "body", "s", True) is False
    assert shown("return page.view.slow") is True


@pytest.mark.parametrize(
    ("name", "speed"), [("two_balls", 0.5), ("oval_fan", 0.5), ("two_balls", 1.0)]
)
def test_words_in_the_pictures_fit_a_narrow_phone(opened, phone, name, speed):
    """What is written within each canvas, by its own measure, 320 pixels wide."""
    phone(320, 640)
    shown = opened(name)
    shown.slide("speed", speed)
    shown(
        "machine.advance(60, 1e9); window.beyond = [];"
        "const of = CanvasRenderingContext2D.prototype;"
        "const fill = of.fillText; of.fillText = function (text, x, y, most = Infinity) {"
        "const wide = Math.min(most, this.measureText(text).width);"
        "const end = x + wide * { left: 1, center: 0.5, right: 0 }[this.textAlign];"
        "if (end > this.canvas.clientWidth || end - wide < 2) window.beyond.push(text);"
        "fill.call(this, text, x, y, most); };"
    )
    frames = shown("return page.frames")
    shown.wait(f"return page.frames > {frames} + 8")
    assert shown("return window.beyond") == []


WRITTEN = (
    "window.drawn = []; const of = CanvasRenderingContext2D.prototype;"
    "for (const name of ['fillText', 'strokeText', 'stroke']) {"
    " const draw = of[name]; of[name] = function (...a) {"
    " drawn.push([name, a[0], this.strokeStyle, this.canvas.id]); draw.apply(this, a); }; }"
    "const frames = page.frames; window.more = () => page.frames > frames + 8;"
)


@pytest.mark.parametrize(
    ("names", "keys"), [(("left", "right"), "lr"), (("ring_a", "ring_b"), ("a.", "b."))]
)
def test_weights_of_two_tracks_have_names_of_their_own(opened, tmp_path, names, keys):
    text = (Path(scenes.__file__).parent / "three_mass_shaft.toml").read_text(encoding="utf-8")
    for old, new in zip(("left", "right"), names, strict=True):
        text = text.replace(f'name = "{old}"', f'name = "{new}"')
    (tmp_path / "named.toml").write_text(text, encoding="utf-8")
    shown = opened(load_scene(tmp_path / "named.toml"))
    shown("machine.advance(1, 1e9);" + WRITTEN)
    shown.wait("return more()")
    written = {str(words) for kind, words, *_ in shown("return drawn") if kind == "fillText"}
    assert {f"{key}{n}" for key in keys for n in (1, 2)} <= written


def test_words_on_the_prescribed_speed_stand_over_the_curves(opened):
    shown = opened("run_up")
    shown("machine.advance(1, 1e9);" + WRITTEN)
    shown.wait("return more()")
    calls = shown("return drawn")
    at = next(k for k, c in enumerate(calls) if str(c[1]).startswith("speed, up to"))
    assert calls[at][0] == "strokeText"
    assert calls[at + 1][:2] == ["fillText", calls[at][1]]
    canvas = calls[at][3]
    after = next(k for k, c in enumerate(calls[at + 2 :]) if c[0] == "fillText" or c[3] != canvas)
    assert "stroke" not in [c[0] for c in calls[at + 2 : at + 2 + after]]


PLACED = (
    "window.placed = {}; const of = CanvasRenderingContext2D.prototype;"
    "const fill = of.fillText; of.fillText = function (text, x, y, ...most) {"
    "(placed[this.canvas.id] ??= []).push([String(text), this.textAlign, x, y]);"
    "fill.call(this, text, x, y, ...most); };"
    "const frames = page.frames; window.more = () => page.frames > frames + 12;"
)


@pytest.mark.parametrize(
    ("name", "end"), [("drum", 5.0), ("washing_machine", 8.0), ("washing_machine_stops", 8.0)]
)
def test_axes_of_a_narrow_page_have_numbers_enough(opened, phone, name, end):
    """Across two, beyond 0; up and down three, without which 0 says nothing of the scale."""
    phone(360, 740)
    shown = opened(name)
    shown(f"machine.advance({end}, 1e9);{PLACED}")
    shown.wait("return more()")
    for canvas in ("vibration", "spectrum"):
        words = shown("return placed[arguments[0]]", canvas)
        across = {text for text, align, *_ in words if align == "center"}
        upwards = {text for text, align, x, _ in words if align == "right" and x < 70}
        assert len(across) >= 2
        assert len(upwards) >= 3


@pytest.mark.parametrize("name", ["three_mass_shaft", "drum"])
def test_numbers_of_weights_do_not_cover_each_other(opened, name):
    shown = opened(name)
    shown(f"machine.advance(5, 1e9);{PLACED}")
    shown.wait("return more()")
    names = ("r1", "r2", "l1", "l2") if name == "three_mass_shaft" else [
        f"{ring}{n}" for ring in "fb" for n in range(1, 7)
    ]  # fmt: skip
    last = {text: y for text, _, _, y in shown("return placed.angles") if text in names}
    heights = sorted(last.values())
    assert len(heights) == len(names)
    assert all(below - above >= 10.9 for above, below in pairwise(heights))
    assert heights[0] > 0
    assert heights[-1] <= shown("return document.getElementById('angles').clientHeight")


def test_the_words_on_both_sides_stand_over_the_curves(opened):
    shown = opened("grinder")
    shown("machine.advance(1, 1e9);" + WRITTEN)
    shown.wait("return more()")
    calls = [c[:2] for c in shown("return drawn") if c[3] == "angles"]
    title = calls.index(["fillText", "Angles from the heavy side, degrees"])
    at = calls.index(["strokeText", "180: light side"])
    assert [kind for kind, _ in calls[title:at]].count("stroke") >= 5  # a curve for each ball
    assert [tuple(call) for call in calls[at : at + 4]] == [
        ("strokeText", "180: light side"), ("fillText", "180: light side"),
        ("strokeText", "0: heavy side"), ("fillText", "0: heavy side"),
    ]  # fmt: skip
    assert [kind for kind, _ in calls[at + 4 : at + 9]] == ["fillText"] * 5  # the balls' numbers


def test_under_a_motor_no_speed_is_drawn_as_if_it_were_prescribed(opened):
    shown = opened("sommerfeld")
    shown(f"machine.advance(1, 1e9);{PLACED}")
    shown.wait("return more()")
    assert not [text for text, *_ in shown("return placed.vibration") if "speed" in text]


def test_what_is_said_of_the_balance_stays_while_the_motion_is_held(opened):
    """Weights swing through the right place: a page held there must not say it is balanced."""
    shown = opened("two_balls")
    shown("page.facts(); machine.advance(20, Infinity); page.facts()")
    before = words(shown, "balance")
    assert shown("return machine.left") > 0.03  # there were 35 g m at the beginning
    shown("for (let k = 0; k < 200; k++) page.facts()")
    assert words(shown, "balance") == before
    shown.slide("value_0", 0.2)  # less unbalance: of that no more can be left than there is
    shown("page.facts()")
    assert words(shown, "balance") != before


def test_a_link_brings_the_values_of_the_sliders_to_another_page(opened):
    shown = opened("two_balls")
    shown.slide("value_3", 0.9)
    shown.slide("weights_0", 1.0)
    values = shown("return [machine.settings.factors, machine.settings.variant]")
    address = shown("page.link(); return location.hash")
    label = "return document.getElementById('link').textContent"
    shown.wait(f"{label} !== 'Copy link'")
    assert shown(label) in ("Copied", "In the address")
    other = opened("two_balls")
    assert other("return [machine.settings.factors, machine.settings.variant]") != values
    other("location.hash = arguments[0]; location.reload()", address)
    other.wait("return Boolean(window.autobalancer)")
    assert other("return [machine.settings.factors, machine.settings.variant]") == values


KEPT = (
    "window.kept = []; HTMLAnchorElement.prototype.click = function () {"
    " kept.push([this.download, decodeURIComponent(this.href)]); };"
)


@pytest.mark.parametrize("name", ["two_balls", "three_mass_shaft", "drum", "run_up", "sommerfeld"])
def test_a_saved_scene_file_runs_with_the_values_of_the_sliders(opened, invoke, tmp_path, name):
    shown = opened(name)
    ids = shown("return [...document.querySelectorAll('#controls input')].map(({ id }) => id)")
    for slider in ids:
        shown.slide(slider, 0.6)
    shown(f"{KEPT} document.getElementById('scene').click()")
    ((file, text),) = shown("return window.kept")
    path = tmp_path / file
    path.write_text(text.partition(",")[2], encoding="utf-8")
    settings = shown("return machine.sliderValues(machine.settings)")
    layout = composition(load_scene(path)).described("Composite").layout
    starts = {variable.name: variable.start for variable in layout.variables}
    assert settings
    assert {key: starts[key] for key in settings} == pytest.approx(settings)
    assert load_scene(path).profile().end == pytest.approx(shown("return machine.settings.speed"))
    weights = shown("return machine.data.tokens[machine.settings.variant].weights")
    assert {b.count for b in load_scene(path).balancer} == set(weights)
    outcome = invoke("run", path, "--set", "run.revolutions=3")
    assert outcome.exit_code == 0, outcome.output


def test_signals_are_saved_as_the_page_remembers_them(opened):
    shown = opened("two_balls")
    shown("machine.advance(3, Infinity); machine.advance(machine.sampled + machine.step, Infinity)")
    shown(
        f"{KEPT}document.getElementById('csv').click(); document.getElementById('picture').click();"
    )
    (csv, text), (picture, image) = shown("return window.kept")
    lines = text.partition(",")[2].splitlines()
    assert csv == "signals.csv"
    assert lines[0] == "time,rotor.x,rotor.y,weights.weight[1].angle,weights.weight[2].angle"
    last = [float(number) for number in lines[-1].split(",")]
    assert last[1:3] == shown("const { x, y } = machine.now.pairs[0]; return [x, y]")
    assert len(lines) == 1 + shown("return machine.filled")
    assert (picture, image[:22]) == ("machine.png", "data:image/png;base64,")


def test_no_size_of_a_displacement_is_written_before_there_is_one(opened):
    shown = opened("two_balls")
    shown(
        "window.written = new Set(); const of = CanvasRenderingContext2D.prototype;"
        "const fill = of.fillText; of.fillText = function (text, ...place) {"
        "window.written.add(text); fill.call(this, text, ...place); };"
    )
    titles = "[...window.written].filter((text) => /^(Displacement|Spectrum)(?! ×)/.test(text))"
    shown.wait(f"return {titles}.length > 1")
    assert set(shown(f"return {titles}")) == {"Displacement", "Spectrum of x"}
    shown("machine.advance(1.0, 1e9); window.written.clear()")
    shown.wait(f"return {titles}.length > 1")
    moved = sorted(shown(f"return {titles}"))
    assert [text.rsplit(" ", 2)[0] for text in moved] == [
        "Displacement, within ±", "Spectrum of x, up to",
    ]  # fmt: skip


def test_a_stop_is_shown_with_its_gap_and_contact(opened):
    stop = {"gap": "2 mm", "stiffness": "200 N/mm", "damping": 300.0}
    scene = ab.Scene(
        rotor=ab.Planar(mass=10.0, stiffness=1e4, damping=20.0, unbalance=0.05, stops=[stop]),
        operation={"speed": 33.0},
    )
    shown = opened(scene)
    assert shown("return machine.data.stops")[0]["label"] == "ring at support 1"
    shown("machine.advance(0.0317, 1e9)")
    (now,) = shown("return machine.now.stops")
    x, y = shown("const { x, y } = machine.now.pairs[0]; return [x, y]")
    assert (now["x"], now["y"]) == (x, y)
    assert now["touches"] == 1
    assert (now["force"] > 0.0) == (math.hypot(x, y) > 0.002)
    shown("page.drawing.draw(page.colours); page.facts()")
    words = shown("return document.getElementById('facts').textContent")
    assert "Ring at support 1" in words
    assert "of 2 mm" in words
    assert "touches: 1" in words


def test_a_stop_across_a_foot_sees_the_body(opened):
    shown = opened("washing_machine_stops")
    shown("machine.advance(0.5, 1e9)")
    (now,) = shown("return machine.now.stops")
    x, y = shown("return Array.from(machine.units.reader(['rotor.station[2].x', "
                 "'rotor.station[2].y'])())")  # fmt: skip
    assert (now["x"], now["y"]) == (x, y)
