"""One mistake on purpose in each place of a scene file, and the message it earns."""

import re

import pytest

from autobalancer.harness import load_scene
from autobalancer.harness.errors import SceneError

GOOD = """
title = "good"
[rotor]
kind = "planar"
mass = 1.0
stiffness = [1.0, 2.0]
unbalance = 0.1
[[balancer]]
name = "weights"
kind = "balls"
count = 3
mass = 0.1
track_radius = 0.5
[[balancer]]
name = "water"
kind = "liquid"
chamber_radius = 0.2
float_radius = 0.1
height = 0.1
density = 1000.0
[operation]
speed = 3.0
[coupling]
scheme = "auto"
[run]
revolutions = 5
"""

TWO_SUPPORT = """
[rotor]
kind = "two_support"
mass = 1.0
inertia = 0.1
span = 1.0
stiffness = [[1.0, 2.0], 3.0]
planes = [0.2, 0.8]
[operation]
speed = 3.0
"""

FLEXIBLE = """
[rotor]
kind = "flexible"
stations = [0.0, 0.5, 1.0]
masses = [1.0, 2.0, 1.0]
supports = [1, 3]
support_stiffness = [1.0e6, 1.0e6]
bending_stiffness = 100.0
[operation]
speed = 3.0
"""


def complaint(tmp_path, text: str) -> str:
    """Message about a scene file with this text, without the file's name."""
    path = tmp_path / "scene.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(SceneError) as caught:
        load_scene(path)
    lines = str(caught.value).splitlines()
    assert all(line.startswith(f"{path}: ") for line in lines)
    return "\n".join(line.removeprefix(f"{path}: ") for line in lines)


VALUES = [
    # key = value in GOOD, the mistake, the message
    ("mass = 1.0", "mass = -0.025", "rotor.mass = -0.025 kg: must be greater than 0"),
    ("mass = 1.0", "mass = nan", "rotor.mass = nan kg: must be a finite number"),
    ("mass = 1.0", "mass = true", "rotor.mass = true: must be a number in kg"),
    ("mass = 1.0", 'mass = "1 m"', 'rotor.mass = "1 m": a mass is expected, such as "50 g" or'),
    ("mass = 1.0", "mass = [1.0]", "rotor.mass = [1.0] kg: must be a number in kg"),
    ("mass = 1.0", "mass = 2020-01-01", "rotor.mass = 2020-01-01: must be a number in kg"),
    ("mass = 1.0", f"mass = 1{400 * '0'}", "rotor.mass = a huge number kg: must be a number"),
    ("mass = 1.0\nst", "st", "rotor.mass: missing; give a value in kg"),
    ("[1.0, 2.0]", "-4", "rotor.stiffness = -4 N/m: must be greater than 0"),
    ("[1.0, 2.0]", "[1.0, 0.0]", "rotor.stiffness[2] = 0.0 N/m: must be greater than 0"),
    ("[1.0, 2.0]", "[1.0]", "rotor.stiffness = [1.0] N/m: must be one number, or two: [x, y]"),
    ("unbalance = 0.1", "unbalance = -1", "rotor.unbalance = -1 kg m: must be 0 or more"),
    ('"planar"', '"plana"', 'rotor.kind = "plana": must be one of "planar", "two_support", "flex'),
    ('kind = "planar"', "", 'rotor.kind: missing; must be one of "planar"'),
    ("unbalance = 0.1", "unbalanced = 0.1", 'rotor.unbalanced: unknown key (did you mean "unb'),
    ("count = 3", "count = 3.0", "balancer[1].count = 3.0: must be a whole number"),
    ("count = 3", "count = true", "balancer[1].count = true: must be a whole number"),
    ("count = 3", "count = 3\nangles = []", "balancer[1].angles = []: must not be empty: give 3"),
    (
        "count = 3",
        "count = 3\nangles = [1, 2]",
        "balancer[1].angles = [1, 2] rad: has 2 values: must have 3, one for each weight",
    ),
    (
        "count = 3",
        "count = 3\nangles = [1, nan, 3]",
        "balancer[1].angles[2] = nan rad: must be a finite number",
    ),
    (
        "count = 3",
        "count = 3\nweight_radius = 0.45",
        "balancer[1].weight_radius = 0.45 m: 3 weights do not fit on a track of radius 0.5 m: "
        "must be at most 0.433013 m",
    ),
    (
        "count = 3",
        "count = 3\nweight_radius = 0.5",
        "balancer[1].weight_radius = 0.5 m: must be less than track_radius = 0.5 m",
    ),
    (
        "count = 3",
        "count = 3\nweight_radius = 0.1\nangles = [0.0, 3.0, 6.2]",
        "weights 3 and 1 overlap: 0.0831853 rad apart, must be at least 0.402716 rad",
    ),
    ("count = 3", "count = 3\nat = 2", "balancer[1].at = 2: must be 1, the rotor's only plane"),
    ("count = 3", "count = 3\nat = 0", "balancer[1].at = 0: must be 1 or more"),
    ('"balls"', '"bals"', 'balancer[1].kind = "bals": must be one of "balls", "rollers"'),
    ('"weights"', '"water"', 'balancer[2].name = "water": taken by balancer[1]'),
    ('"weights"', '"rotor"', 'balancer[1].name = "rotor": taken by the table [rotor]'),
    ('"weights"', '"my weights"', 'balancer[1].name = "my weights": must begin with a letter'),
    (
        "float_radius = 0.1",
        "float_radius = 0.3",
        "balancer[2].float_radius = 0.3 m: must be less than chamber_radius = 0.2 m",
    ),
    (
        "density = 1000.0",
        "density = 1000.0\ninertia_as_force = 1",
        "balancer[2].inertia_as_force = 1: must be true or false",
    ),
    ("count = 3", 'count = 3\nfmu = ""', 'balancer[1].fmu = "": must not be empty'),
    ("speed = 3.0", 'profile = ""', 'operation.profile: "": must not be empty: name a CSV file'),
    ("speed = 3.0", "", "operation.speed: give one of speed, run_up, profile and motor: none is"),
    (
        "speed = 3.0",
        "speed = 3.0\nrun_up = {from = 0.0, to = 9.0, seconds = 60.0}",
        "give one of speed, run_up, profile and motor: not speed and run_up",
    ),
    (
        "speed = 3.0",
        "run_up = {from = 1.0, start = 1.0, to = 9.0, seconds = 60.0}",
        "operation.run_up.start: unknown key; allowed: from, to, seconds",
    ),
    (
        "[run]",
        '[[connection]]\nfrom = "abc"\nto = "rotor.F_x"\n[run]',
        'connection[1].from = "abc": must be unit.variable, such as rotor.x',
    ),
    ("[operation]\nspeed = 3.0", "", "operation: missing; give a table [operation]"),
    ('"auto"', '"jacob"', 'coupling.scheme = "jacob": must be one of'),
    ('"auto"', '"auto"\norder = 5', "coupling.order = 5: must be one of 0, 1 or 3"),
    ('"auto"', '"auto"\norder = true', "coupling.order = true: must be one of 0 (held)"),
    ('"auto"', '"auto"\nsteps_per_rev = 2', "coupling.steps_per_rev = 2: must be 4 or more"),
    (
        '"auto"',
        '"auto"\nsteps_per_rev = 20\ntolerance = 1e-4',
        "coupling.steps_per_rev = 20: give either steps_per_rev or tolerance = 0.0001, not both",
    ),
    ('"auto"', '"auto"\ntolerance = 0.5', "coupling.tolerance = 0.5: must be 0.1 or less"),
    ("revolutions = 5", "revolutions = 0", "run.revolutions = 0: must be 1e-09 or more"),
    ("revolutions = 5", 'record = "rotor.x"', 'run.record = "rotor.x": must be a list'),
    ("revolutions = 5", "record = [1]", "run.record[1] = 1: must be text in quotes"),
    ("revolutions = 5", "initial = {z = 1}", "run.initial.z: unknown key"),
    ("revolutions = 5", "initial = 3", "run.initial = 3: must be a table of keys and values"),
    ("[run]", "[runs]", 'runs: unknown key (did you mean "run"?); allowed: title, source, rotor'),
    ("[run]", "[[check]]\nkind = 'nothing'\n[run]", 'check[1].kind = "nothing": must be one of "l'),
    (
        "[run]",
        "[[check]]\nkind = 'critical_speeds'\nrange = [9.0, 1.0]\n[run]",
        "check[1].range = [9.0, 1.0] rad/s: must be [low, high] with low less than high",
    ),
    (
        '"auto"',
        '"compensated"\norder = 1',
        'coupling.order = 1: must be 3 with scheme = "compensated"',
    ),
    (
        "[run]",
        "[[check]]\nkind = 'liquid_window'\n[run]",
        'check[1].kind = "liquid_window": needs a planar rotor with equal stiffness',
    ),
]


@pytest.mark.parametrize(
    ("right", "wrong", "message"), VALUES, ids=[wrong[:40] or right for right, wrong, _ in VALUES]
)
def test_message_names_key_value_unit_and_what_is_allowed(tmp_path, right, wrong, message):
    assert right in GOOD
    found = complaint(tmp_path, GOOD.replace(right, wrong, 1))
    assert message in found
    assert len(found.splitlines()) == 1


def test_every_problem_of_a_file_is_reported_at_once(tmp_path):
    text = GOOD.replace("mass = 1.0", "mass = -1.0").replace("count = 3", "count = 0\nat = 4")
    text = text.replace("float_radius = 0.1", "float_radius = 0.9").replace('"water"', '"weights"')
    text = text.replace("revolutions = 5", "revolution = 5")
    found = complaint(tmp_path, text).splitlines()
    for key in ("rotor.mass", "[1].count", "[2].float_radius", "[2].name", "run.revolution:"):
        assert any(key in line for line in found)
    assert len(found) == 5  # `at` cannot be judged without a rotor
    found = complaint(tmp_path, text.replace("mass = -1.0", "mass = 1.0"))
    assert "balancer[1].at = 4: must be 1, the rotor's only plane" in found


@pytest.mark.parametrize(
    ("text", "right", "wrong", "message"),
    [
        (TWO_SUPPORT, "inertia = 0.1", "inertia = 0.1\npolar_inertia = 0.3", "no body has more"),
        (TWO_SUPPORT, "[[1.0, 2.0], 3.0]", "[[1.0, 2.0]]", "rotor.stiffness[2]: missing"),
        (FLEXIBLE, "[0.0, 0.5, 1.0]", "[0.0, 1.5, 1.0]", "must rise from one station to the next"),
        (FLEXIBLE, "masses = [1.0, 2.0, 1.0]", "masses = [1.0]", "must have 3, one for each stat"),
        (FLEXIBLE, "[1, 3]", "[1, 4]", "rotor.supports = [1, 4]: must be two different stations"),
        (FLEXIBLE, "bending_stiffness = 100.0", "", "give either bending_stiffness"),
        (FLEXIBLE, "bending_stiffness = 100.0", "compliance = [[1, 2]]", "1 rows of 1"),
    ],
)
def test_mistakes_in_the_other_rotors_are_named(tmp_path, text, right, wrong, message):
    assert right in text
    assert message in complaint(tmp_path, text.replace(right, wrong, 1))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"title = 'x'\nmass = = 3\n", "not TOML: line 2, column 8"),
        (b"title = 'x'\n[rotor", "not TOML:"),
        (b"title = 'x'\ntitle = 'y'\n", "not TOML: line 2"),
        (b"title = 'x'\nsource = '\xff'\n", "line 2: byte 0xff is not UTF-8"),
        (b"PK\x03\x04", "a zip archive, not a text file"),
        (b"a = 1\nmass = 8,0", "after a statement: mass = 8,0 (did you mean mass = 8.0?)"),
        (b"mass = 8,0 kg # bare", '(did you mean mass = "8.0 kg" # bare?)'),
        (b"stiffness = 2e4 N/m", '(did you mean stiffness = "2e4 N/m"?)'),
        (b"speed = 1200 rpm", '(did you mean speed = "1200 rpm"?)'),
        (b"kind = planar # or", ': kind = planar # or (did you mean kind = "planar" # or?)'),
        (b"inertia_as_force = True", "(did you mean inertia_as_force = true?)"),
        (b"mass: .5", "(did you mean mass = 0.5?)"),
        (b"a = " + 5000 * b"[", "not a TOML file"),
        (b"", "rotor: missing"),
        (b"rotor = 3\n[operation]\nspeed = 1\n", "rotor = 3: must be a table"),
        (b"[balancer]\nkind = 'balls'\n", "balancer: must be a list of tables; write [[balancer]]"),
    ],
)
def test_files_that_hold_no_scene_are_refused_with_the_place(tmp_path, content, message):
    path = tmp_path / "scene.toml"
    path.write_bytes(content)
    with pytest.raises(SceneError, match=re.escape(message)):
        load_scene(path)


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("rotr.mass", 1.0, "'rotr.mass': unknown (did you mean \"rotor\"?); begins with one of"),
        (
            "rotor.mas",
            1.0,
            "'rotor.mas': unknown (did you mean \"mass\"?); rotor has: kind, fmu, bearings",
        ),
        ("weights.drga", 1.0, 'unknown (did you mean "drag"?); weights has: kind, name'),
        (
            "rotor",
            1.0,
            "'rotor': name a key of it: kind, fmu, bearings",
        ),
        ("rotor.stiffness[3]", 1.0, "the scene gives 2 values there"),
        ("rotor.mass.value", 1.0, "mass has no keys of its own"),
        ("rotor..mass", 1.0, "unknown"),
        ("run.initial.z", 1.0, "run.initial has: x, y, vx, vy, angle"),
        ("rotor.mass", -1.0, "rotor.mass = -1.0 kg: must be greater than 0"),
        ("speed", -1.0, "operation.speed = -1.0 rad/s: must be greater than 0"),
        (
            "weights.drag",
            "a lot",
            'balancer[1].drag = "a lot": a damping or drag is expected, such as',
        ),
        ("weights.angles[2]", float("inf"), "angles[2] = inf rad: must be a finite number"),
    ],
)
def test_replace_refuses_what_it_cannot_do(path, value, message):
    with pytest.raises(SceneError, match=re.escape(message)):
        load_scene("two_balls").replace({path: value})


@pytest.mark.parametrize(
    ("scene", "one", "other"),
    [
        ("two_balls", "operation.speed", "speed"),
        ("bristol_friction", "rotor.support_stiffness[1][1]", "rotor.support_stiffness[1][x]"),
        ("washing_machine_tub", "tub.mass", "body[1].mass"),
        ("washing_machine_tub", "rotor.bodies[1].mass", "tub.mass"),
    ],
)
def test_two_names_of_one_value_are_not_given_together(scene, one, other):
    message = f"'{other}': the same as '{one}', which is given too"
    with pytest.raises(SceneError, match=re.escape(message)):
        load_scene(scene).replace({one: 2.0, other: 3.0})
