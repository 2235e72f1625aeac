"""What people mistake in scene files and commands gets a message or a warning that helps."""

from __future__ import annotations

import math

import pytest

from autobalancer.harness import UserError, load_scene

DRUM = """\
title = "Drum"
[rotor]
kind = "planar"
mass = 8.0
stiffness = 2e4
damping = 80.0
unbalance = 0.02
[[balancer]]
name = "balls"
kind = "balls"
count = 3
mass = 0.05
track_radius = 0.2
drag = 0.2
[operation]
speed = 150.0
[run]
revolutions = 2
"""
# what is replaced in the file, by what, and what `autobalancer run` says
IN_FILES = [
    # units
    ("speed = 150.0", "speed = 1430", "is the speed in rpm, or track_radius in mm?"),
    ("speed = 150.0", 'speed = "1430"', 'such as "1200 rpm"'),
    ("speed = 150.0", 'speed = "1430 rmp"', "unknown unit 'rmp'"),
    ("speed = 150.0", "speed_rpm = 1430", 'did you mean "speed"'),
    ("mass = 0.05", 'mass = "50 mm"', "a mass is expected"),
    ("unbalance = 0.02", "unbalance = 0.2", "more than a tenth of the track radius"),
    ("damping = 80.0", "damping_ratio = 5.0", "times the critical one"),
    ("damping = 80.0", "damping = 80.0\ndamping_ratio = 0.1", "not both"),
    (
        "mass = 8.0",
        "mass = 8.0\nmass = 9.0",
        "given a second time; keep one of the two: mass = 9.0",
    ),
    ("[operation]", "[rotor]\n[operation]", "given a second time; keep one of the two: [rotor]"),
    # values, keys and tables; more in `harness/scene/test_scene_mistakes.py`
    ("count = 3", "count = 100000", "10000"),
    ("drag = 0.2", "drag = 0.2\nrestitution = 0.5", "weight_radius"),
    ("stiffness = 2e4", "stifness = 2e4", 'did you mean "stiffness"'),
    ("track_radius = 0.2", "radius = 0.2", "track_radius"),
    ("[rotor]", "[roter]", 'did you mean "rotor"'),
    ("[[balancer]]", "[[balancers]]", 'did you mean "balancer"'),
    ("speed = 150.0", "run_up = {from = 0, to = 150}", "seconds"),
    ('kind = "planar"', 'kind = "flexible"', "stations"),
    ('name = "balls"', 'name = ""', "must begin with a letter"),
    ("mass = 8.0", "mass = 1e29", "times the critical speed"),  # a frequency that rounds to 0
]


# arguments, where {f} is a folder with drum.toml and CSV files, and what is said
COMMANDS = [
    ("rum {f}/drum.toml", "run"),
    ("run {f}/drum.toml --sett speed=3", "--set"),
    ("run {f}/drom.toml", "drom.toml"),
    ("run two_bals", "two_balls"),
    ("run {f}", "is a directory; a scene is a TOML file"),
    ("run", "Missing argument"),
    ("run TWO_BALLS", 'did you mean "two_balls"'),
    ("run {f}/drum.toml --set balancer[1].mass=1", "did you mean balls.mass"),
    ("run {f}/drum.toml --set balls.angles[1]=0", "give it whole, as balls.angles=[...]"),
    ("run {f}/drum.toml --set run.record=['x']", 'did you mean "rotor.x"'),
    ("run {f}/drum.toml --set run.record=['ball.spread']", "UNIT.VARIABLE, of the units rotor"),
    ("run {f}/drum.toml --set run.record=['balls.spred']", 'did you mean "balls.spread"'),
    # below it two tolerances give the same steps, and the error would seem to be 0
    ("run {f}/drum.toml --set coupling.tolerance=1e-30", "must be 1e-13 or more"),
    ("run {f}/drum.toml --polar {f}/p.png", "4 or more are needed: raise run.revolutions"),
    # what is read would be lost, and of two outputs one
    ("run {f}/drum.toml --json {f}/drum.toml", "the command reads this file"),
    ("fit {f}/drum.toml --measured {f}/ok.csv --free balls.drag --json {f}/ok.csv", "reads this"),
    ("run {f}/drum.toml --plot {f}/a.png --weights {f}/../{n}/a.png", "two outputs"),
    ("design {f}/drum.toml --save {f}/none/x.toml", "none"),
    ("run {f}/drum.toml --set mass=3", "did you mean rotor.mass or balls.mass"),
    ("run {f}/drum.toml --set rotor.mass 3", "KEY=VALUE"),
    ("run {f}/drum.toml --set rotor.mass=3kN", "a mass is expected"),
    ("run {f}/drum.toml --set rotor.mas=3", "mass"),
    ("run {f}/drum.toml --set bals.mass=0.05", "balls"),
    ("run {f}/drum.toml --set balls.angles[4]=0", "angles"),
    ("run {f}/drum.toml --set rotor.mass", "must be KEY=VALUE"),
    ("run {f}/drum.toml --plot {f}/out.jpg", ".png"),
    ("run {f}/drum.toml --plot {f}/out", ".png"),
    ("run {f}/drum.toml --plot {f}/none/out.png", "none"),
    ("run {f}/drum.toml -o {f}/none/out.csv", "none"),
    ("run {f}/drum.toml --movie {f}/a.avi", ".gif"),
    ("run {f}/drum.toml --at-most 3x", "30m"),
    ("run {f}/drum.toml --units metric", "engineering"),
    ("show {f}/drum.toml -o {f}/drum.png", "must end in .html"),
    ("build {f}/drum.toml --platform windows", "'x86_64-windows'"),
    ("build {f}/drum.toml --fmi 4", "3"),
    ("speeds {f}/drum.toml --range 500", "--range"),
    ("speeds {f}/drum.toml --range 500 100", "rising"),
    ("speeds {f}/drum.toml --range 0 300", "positive"),
    ("speeds {f}/drum.toml --range 10kg 300", "a speed is expected"),
    ("speeds {f}/drum.toml --range 50 300 --method flouqet", "floquet"),
    ("map {f}/drum.toml --x speed=0:300:20:log --y balls.drag=0.1:1:5", "must begin above 0"),
    ("map {f}/drum.toml --x speed=10:300 --y balls.drag=0.1:1:5", "PATH=LOW:HIGH:N"),
    ("map {f}/drum.toml --x speed=10:300:5 --y speed=10:300:5", "both axes are the same"),
    ("scatter {f}/drum.toml --vary balls.drag=gauss(0.2,0.1) -n 9", "normal"),
    ("scatter {f}/drum.toml -n 9", "--vary"),
    ("run {f}/drum.toml -o --quiet", "-o: requires a value: -o FILE.csv. Write the signals as"),
    ("motions {f}/drum.toml -n --sweep", "-n: requires a value: -n NUMBER. Random starts"),
    ("run {f}/drum.toml --movie-seconds 5", "give --movie FILE.gif too"),
    ("run {f}/drum.toml --set rotor.mass=3 --set rotor.mass=4", "--set rotor.mass: given 2 times"),
    ("build {f}/drum.toml --fmi two", "--fmi two: must be a whole number in digits, 2 to 3"),
    # numbers of things: what is allowed is said
    ("scatter {f}/drum.toml -n 1e11 --vary x=1", "-n 1e11: must be a whole number in digits, 1 to"),
    ("motions {f}/drum.toml -n 100000000000", "-n 100000000000: must be a whole number in digits"),
    ("motions {f}/drum.toml --seed -1", "--seed -1: must be a whole number in digits, 0 or more"),
    ("motions {f}/drum.toml --speeds 90 99 x", "--speeds 90 99 x: must be two positive speeds"),
    ("design {f}/drum.toml --most 1", "--most 1: must be a whole number in digits, 2 to 64"),
    ("design {f}/drum.toml --reserve x", "--reserve x: must be a number"),
    ("fit {f}/drum.toml --scatter 0", "--scatter 0: must be a number, 1e-06 or more"),
    ("precision {f}/drum.toml --seconds 0", "--seconds 0: must be a number, 1 or more"),
    ("drag --swings x", "--swings x: must be a number"),
    ("fit {f}/drum.toml --measured {f}/rpm.csv --free balls.drag", "speed [rpm]"),
    ("fit {f}/drum.toml --measured {f}/none.csv --free balls.drag", "none.csv"),
    ("balance {f}/phase.csv", "phase_lead_deg"),
    ("balance {f}/back.csv", "back.csv, line 3: speed = -1200 rpm: must be above 0"),
    ("balance {f}/graded.csv --mass 5 --grade 7", '--grade 7: must be "G" and a number of mm/s'),
    ("balance {f}/phase.csv --mass 42", "--mass: judges a grade: give it too"),
    (
        "fit {f}/drum.toml --measured {f}/still.csv --free balls.drag",
        "rad/s: must be greater than 0",
    ),
    (
        "fit {f}/drum.toml --measured {f}/light.csv --free balls.drag",
        "rotor.mass = -8.0 kg: must be",
    ),
    (
        "fit {f}/drum.toml --measured {f}/none_left.csv --free balls.drag",
        "line 3: amplitude: must be",
    ),
    ("fit {f}/drum.toml --measured {f}/ok.csv --free speed", "every row of the measurements has"),
    (
        "fit {f}/drum.toml --measured {f}/ok.csv --free rotor.mass=balls.drag",
        "must be of one quant",
    ),
    ("check {f}/drum.toml", "[[check]]"),
    ("new wash_machine", "wash_machine"),
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("mistakes")
    files = {
        "drum.toml": DRUM,
        "rpm.csv": "rpm,amplitude [mm]\n1200,0.5\n1500,0.4\n",
        "ok.csv": "speed [rpm],amplitude [mm]\n1200,0.5\n1500,0.4\n",
        "still.csv": "speed [rpm],amplitude [mm]\n1200,0.5\n0,0.4\n",
        "light.csv": "rotor.mass [kg],amplitude [mm]\n-8,0.5\n8,0.4\n",
        "none_left.csv": "speed [rpm],amplitude [mm]\n1200,0.5\n1500,0\n",
        "back.csv": "run,sensor,speed_rpm,amplitude_um,phase_lead_deg,mass_g,angle_deg\n"
        "a,X,1200,1,30,,\nb,X,-1200,2,40,5,0\n",
        "graded.csv": "run,sensor,speed_rpm,amplitude_um,phase_lead_deg,mass_g[a],angle_deg[a],"
        "radius_mm[a]\na,X,1200,1,30,,,100\nb,X,1200,2,40,5,0,100\n",
        "phase.csv": "run,sensor,amplitude_mm,phase_deg,mass_g[1],angle_deg[1]\n"
        "a,X,1,30,,\nb,X,2,40,5,0\n",
    }
    for name, text in files.items():
        (place / name).write_text(text, encoding="utf-8")
    return place


@pytest.mark.parametrize(("old", "new", "words"), IN_FILES, ids=[n for _, n, _ in IN_FILES])
def test_a_mistake_in_a_scene_file_is_named(invoke, tmp_path, old, new, words):
    assert DRUM.count(old) == 1
    (tmp_path / "drum.toml").write_text(DRUM.replace(old, new), encoding="utf-8")
    assert words in " ".join(invoke("run", tmp_path / "drum.toml").output.split())


IN_PYTHON = [
    (lambda scene: scene.run(record="rotor.x"), 'must be a list: ["rotor.x"]'),
    (lambda scene: scene.run(fmus="nowhere"), "nowhere: no FMU for 'rotor'"),  # a text is a path
    (lambda scene: scene.speeds(10.0, 300.0, ""), "name at least one"),
    (lambda scene: scene.scatter({"balls.drag": "normal(0.2,1%)"}, n=0), "from 1 to 1000"),
    (lambda scene: scene.motions(n=2.5), "n = 2.5: must be a whole number from 1 to"),
    (lambda scene: scene.motions(n=10**11), "n = 100000000000: must be a whole number from 1"),
    (lambda scene: scene.design(n="many"), "n = 'many': must be a whole number from 1 to"),
    (lambda scene: scene.design(most=1), "most = 1: must be a whole number from 2 to"),
    (lambda scene: scene.design(most=10**20), "must be a whole number from 2 to"),
    (lambda scene: scene.design(reserve="x"), "--reserve x: a ratio is expected"),
    (lambda scene: scene.settling(starts=10**20), "must be a whole number from 1 to"),
    (lambda scene: scene.report("r.html", n=0), "n = 0: must be a whole number from 1 to"),
    (lambda scene: scene.report("r.html", n=math.nan), "n = nan: must be a whole number from"),
    (lambda scene: scene.speeds(10.0, 300.0, 5), "methods = 5: must be text, or a list of texts"),
    (lambda scene: scene.speeds(10.0, 300.0, narrowest=0), "narrowest = 0 rad/s: must be above 0"),
    (lambda scene: scene.speeds(10.0, 300.0, narrowest="x"), "narrowest = x: a speed is expected"),
    (lambda scene: scene.motions(starts=[1]), "starts = [1]: must be text, or a list of texts"),
    (lambda scene: scene.motions(150.0, n=1, store=5), "store = 5: must be the path of a file"),
    (lambda scene: scene.map(5, "speed=1:2:3"), "axis 5: must be PATH=LOW:HIGH:N"),
    (lambda scene: scene.fit("none.csv", "balls.drag", scatter=0), "scatter = 0: must be a number"),
    (lambda scene: scene.race(5), "lobes = 5: must be text, such as"),
    (lambda scene: scene.replace("rotor.mass=3"), "must be a dict of paths and values, such as"),
    (lambda scene: scene.scatter(5), "vary = 5: must be text, or a list of texts, such as"),
    (lambda scene: scene.run().assert_balanced(1.0, last="x"), "last = x: a ratio is expected"),
    (lambda scene: scene.run().plot_orbits("x"), "revolutions = x: a ratio is expected"),
    (lambda scene: scene.run().movie("a.gif", "x"), "length of the movie = x: a time is expected"),
    (
        lambda scene: scene.run().assert_close("rotor.x", [1.0, 2.0], 0.1),
        "assert_close: reference: must be one number, or",
    ),
    (lambda scene: scene.capture([150.0]), "speed [150.0]: a speed is expected"),
    (lambda scene: scene.capture(True), "speed True: a speed is expected"),
    (
        lambda scene: scene.scatter({"balls.drag": "normal(0.2,1%)"}, n=1.5),
        "must be a whole number",
    ),
    (lambda scene: scene.scatter({"balls.drag": 0.2}, n=5), "'normal(0.2,10%)', or a frozen"),
]


@pytest.mark.parametrize(("call", "words"), IN_PYTHON, ids=[words for _, words in IN_PYTHON])
def test_a_mistake_in_a_call_is_named(folder, call, words):
    with pytest.raises(UserError) as said:
        call(load_scene(folder / "drum.toml"))
    assert words in str(said.value)


@pytest.mark.parametrize(("line", "words"), COMMANDS, ids=[line for line, _ in COMMANDS])
def test_a_mistake_in_a_command_is_named_and_ends_it(invoke, folder, line, words):
    outcome = invoke(*line.format(f=folder, n=folder.name).split())
    assert words in " ".join(outcome.output.split())
    assert outcome.exit_code == 2
