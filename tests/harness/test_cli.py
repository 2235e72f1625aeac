"""The command line: what it prints, what it writes, and how it ends."""

import csv
import json
import re
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import pytest
from fmpy import read_model_description
from typer.main import get_command

from autobalancer.fmus import catalogue
from autobalancer.harness import bundled_scenes, load_scene
from autobalancer.harness.__main__ import program

pytestmark = pytest.mark.slow

COMMANDS = get_command(program()).commands
ROW_KEYS = [
    "scene", "check", "quantity", "expected", "measured", "error", "tolerance", "holds", "seconds",
    "source",
]  # fmt: skip


def altered(tmp_path, name: str, **replacements: str):
    """Path of a copy of a bundled scene with text replaced, old=new."""
    text = load_scene(name).path.read_text(encoding="utf-8")
    for old, new in replacements.items():
        assert old in text
        text = text.replace(old, new, 1)
    path = tmp_path / f"{name}_altered.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_check_prints_a_table_writes_json_and_ends_with_zero(invoke, tmp_path):
    target = tmp_path / "rows.json"
    outcome = invoke("check", "liquid_touch", "--json", target)
    assert outcome.exit_code == 0, outcome.output
    assert "lower boundary w_*" in outcome.output
    assert "FMUs loaded: RotorOnSupports.fmu, LiquidBalancer.fmu" in outcome.output
    assert "Left out: BallBalancer" in outcome.output
    document = json.loads(target.read_text(encoding="utf-8"), parse_constant=pytest.fail)
    assert document["holds"] is True
    assert all(list(row) == ROW_KEYS for row in document["rows"])
    lower = next(r for r in document["rows"] if "w_* [rad/s]" in r["quantity"])
    assert lower["measured"] == pytest.approx(81.7461, rel=1e-4)
    touching = next(r for r in document["rows"] if "float clear" in r["quantity"])
    assert "113.63" in touching["measured"]


def test_a_balanced_rotor_has_no_window_to_check_and_ends_with_two(invoke, tmp_path):
    path = altered(tmp_path, "liquid_disc", **{"unbalance = ": "unbalance = 0.0 # "})
    outcome = invoke("check", path)
    assert outcome.exit_code == 2, outcome.output
    assert "rotor.unbalance = 0 kg m: needs an unbalance" in outcome.stderr
    assert len(outcome.stderr.splitlines()) == 1


def test_without_a_command_the_help_is_shown(invoke):
    outcome = invoke()
    assert (outcome.exit_code, outcome.stdout) == (0, invoke("--help").stdout)
    assert all(name in outcome.stdout for name in COMMANDS)


def test_the_version_is_that_of_the_package(invoke):
    outcome = invoke("--version")
    assert (outcome.exit_code, outcome.stdout) == (0, f"autobalancer {version('autobalancer')}\n")


@pytest.mark.parametrize("name", COMMANDS)
def test_help_shows_every_text_whole_with_its_units_in_brackets(invoke, name):
    command, shown = COMMANDS[name], "".join(invoke(name, "--help").stdout.split())
    summary = " ".join(invoke("--help").stdout.split())
    visible = [option for option in command.params if not getattr(option, "hidden", False)]
    for text in (command.help, *(option.help for option in visible)):
        assert "".join(text.split()) in shown
    assert "[[" not in shown
    assert " ".join([name, *command.help.split("\n")[0].split()]) in summary


def test_without_a_scene_all_bundled_scenes_with_checks_are_checked(invoke, monkeypatch):
    checked = []

    def note(scenes, progress):
        checked.extend(scene.name for scene in scenes)
        return []

    monkeypatch.setattr("autobalancer.harness.checks.runner.check_all", note)
    outcome = invoke("check")
    assert outcome.exit_code == 0
    scenes = [load_scene(name) for name in bundled_scenes()]
    assert checked == [scene.name for scene in scenes if scene.checks and not scene.on_request]
    assert {n for n in checked if n.startswith("liquid_")} == {
        "liquid_closed",
        "liquid_disc",
        "liquid_heavy",
        "liquid_heavy_force",
        "liquid_no_internal",
        "liquid_touch",
    }


def test_run_writes_the_recorded_signals(invoke, tmp_path):
    target, picture = tmp_path / "out.csv", tmp_path / "out.svg"
    outcome = invoke("run", "two_balls", "--verbose", "-o", target, "--plot", picture)
    assert outcome.exit_code == 0, outcome.output
    assert "Left out: LiquidBalancer (none in the scene)" in outcome.output
    with target.open(encoding="utf-8", newline="") as stream:
        rows = list(csv.reader(stream))
    assert rows[0][:3] == ["time", "rotor.x", "rotor.y"]
    assert len(rows) == 1 + 20 * 20 + 1
    # the weights end where they balance: 2 m R cos(theta) = -unbalance, theta = 2 pi/3
    ends = sorted(float(rows[-1][rows[0].index(f"weights.weight[{k}].angle")]) for k in (1, 2))
    assert ends == pytest.approx([-2.0944, 2.0944], abs=5e-3)
    assert "<svg" in picture.read_text(encoding="utf-8")


def test_every_command_that_takes_a_scene_takes_values_to_set_in_it():
    commands = get_command(program()).commands
    taking = {
        name: [option for parameter in command.params for option in parameter.opts]
        for name, command in commands.items()
        if {parameter.name for parameter in command.params} & {"scene", "scenes"}
    }
    assert set(taking) == set(commands) - {"stress", "drag", "bearing", "new", "manual"}
    assert [name for name, options in taking.items() if "--set" not in options] == []


def test_a_value_set_for_the_one_file_is_its_start_value(invoke, tmp_path):
    outcome = invoke(
        "build", "two_balls", "--one-file", "--set", "speed=4.5", "--platform", "x86_64-linux",
        "-o", tmp_path,
    )  # fmt: skip
    assert outcome.exit_code == 0, outcome.output
    variables = read_model_description(str(tmp_path / "two_balls.fmu")).modelVariables
    assert float(next(v.start for v in variables if v.name == "speed")) == 4.5


def test_build_makes_exactly_the_units_of_a_scene_and_run_takes_them(invoke, tmp_path):
    outcome = invoke("build", "liquid_disc", "-o", tmp_path)
    assert outcome.exit_code == 0, outcome.output
    assert {p.name for p in tmp_path.iterdir()} == {"liquid.fmu", "rotor.fmu"}
    outcome = invoke("run", "liquid_disc", "--fmus", tmp_path, "--set", "run.revolutions=1")
    assert outcome.exit_code == 0, outcome.output
    outcome = invoke("run", "two_balls", "--fmus", tmp_path)
    assert outcome.exit_code == 2
    assert "weights" in outcome.stderr


def test_run_names_the_engine_and_refuses_separate_fmus_for_one_file(invoke):
    said = invoke("run", "two_balls", "--verbose").output
    assert re.search(r"In one piece, by power series of order \d+, as one file: two_balls", said)
    assert "coupling.steps_per_rev, coupling.corrections: of separate FMUs (--separate)" in said
    assert "rows are at the given ones" in said
    assert "FMUs loaded: Rotor" in invoke("run", "two_balls", "--separate", "--verbose").output
    explicit = ["--set", 'coupling.scheme="jacobi"', "--set", "coupling.order=0"]
    said = invoke("run", "two_balls", "--verbose", *explicit).output
    keys = "coupling.scheme, coupling.order, coupling.steps_per_rev"
    assert said.count(f"{keys}: of separate FMUs (--separate)") == 1
    outcome = invoke("run", "two_balls", "--one-file")
    assert outcome.exit_code == 0, outcome.output
    assert "deprecated" in outcome.stderr
    outcome = invoke("run", "two_balls", "--one-file", "--fmus", ".")
    assert outcome.exit_code == 2
    assert "one file is to run: give one of them" in outcome.stderr


def test_an_implausible_value_is_one_line_of_check(invoke, recwarn):
    outcome = invoke("check", "sommerfeld")
    assert outcome.exit_code == 0, outcome.output
    assert outcome.stderr.count("WARNING: sommerfeld: unbalance: 10 g m to balance") == 1
    assert not recwarn


def test_what_is_warned_of_is_a_line_without_its_place_in_the_code(tmp_path):
    (tmp_path / "measured.csv").write_text("time [s],speed [rpm]\n0,0\n1,900\n2,900\n")
    text = load_scene("two_balls").toml.replace("speed = 3.0", 'profile = "measured.csv"')
    (tmp_path / "traced.toml").write_text(text.replace("revolutions", "# revolutions"))
    command = [sys.executable, "-m", "autobalancer.harness", "rotor", "traced.toml"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "WARNING: measured.csv: 3 readings lie on 2 lines" in done.stderr
    assert "TraceNote" not in done.stderr


@pytest.mark.parametrize("form", [[], ["--one-file"], ["--ssp"]])
def test_a_place_that_takes_no_fmu_is_refused_before_anything_is_built(invoke, monkeypatch, form):
    def compiled(*_):
        raise AssertionError("compiling can take minutes")

    monkeypatch.setattr("autobalancer.fmus.native.build.compile._compiled", compiled)
    outcome = invoke("build", "two_balls", "-o", "/proc/made", *form)
    assert outcome.exit_code == 2, outcome.output
    assert "/proc/made: cannot be made a directory" in outcome.stderr


def test_a_missing_file_of_the_program_is_an_internal_error_to_report(
    invoke, monkeypatch, tmp_path
):
    missing = Path(catalogue.__file__).with_name("missing")
    monkeypatch.setattr(catalogue, "__file__", str(missing / "catalogue.py"))
    outcome = invoke("build", "-o", tmp_path / "units")
    assert outcome.exit_code == 1, outcome.output
    assert outcome.stderr.startswith(f"internal error: {missing}")
    assert "report this message" in outcome.stderr
    assert "cannot be written" not in outcome.stderr


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["check", "nowhere.toml"], "nowhere.toml: no such file"),
        (["run", "two_balls", "--set", "rotor.mass=heavy"], "must be KEY=VALUE"),
        (["run", "two_balls", "--set", "rotor.mass=-1"], "rotor.mass = -1 kg: must be greater"),
        (["run", "two_balls", "--set", 'run.record=["rotor.z"]'], "rotor.z"),
        (["speeds", "two_balls", "--range", "1", "9", "--method", ""], "name at least one of"),
        (["speeds", "two_balls", "--range", "1", "9", "--narrowest", "1e-9"], "at most 100000"),
        (["check", "liquid_disc", "--json", "/"], "it is a directory"),
        (["run", "two_balls", "-o", "x.png"], "x.png: must end in .csv"),
        (["build", "--set", "rotor.mass=3"], "--set: give the scene"),
        (["map", "two_balls", "--x", "speed=1:x:3", "--y", "speed=1:2:2"], "speed=1:x:3: must be"),
        (["run", "two_balls", "--fmus", "/nowhere"], "is not a directory with FMUs"),
        (["check", "two_balls"], "two_balls: nothing to check"),
        (
            ["speeds", "two_balls", "--range", "100-2000"],
            "2 values, with spaces between: --range L",
        ),
        (["motions", "two_balls", "--speeds", "1", "2", "--sweep"], "between: --speeds LOW HIGH N"),
        (["capture", "two_balls", "--speed", "20", "rpm"], 'needs quotes: "20 rpm"'),
    ],
)
def test_wrong_input_ends_with_two_and_one_line(invoke, arguments, message):
    outcome = invoke(*arguments)
    assert outcome.exit_code == 2, outcome.output
    assert message in outcome.stderr
    assert len(outcome.stderr.splitlines()) == 1
    assert "Traceback" not in outcome.output


@pytest.mark.parametrize(
    "arguments",
    [
        ["check", "two_balls"],
        ["run", "two_balls", "--fmus", "/nowhere"],
        ["fit", "two_balls", "--measured", "/nowhere.csv", "--free", "rotor.mass"],
    ],
)
def test_a_command_that_is_refused_leaves_no_folder_for_its_report(invoke, tmp_path, arguments):
    outcome = invoke(*arguments, "--report", tmp_path / "made" / "report")
    assert outcome.exit_code == 2, outcome.output
    assert not list(tmp_path.iterdir())


def modules_after(statement: str) -> set[str]:
    """Top-level modules loaded in a fresh interpreter."""
    code = f"import sys; {statement}; print(*sys.modules, file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return {name.split(".")[0] for name in done.stderr.split()}


@pytest.mark.parametrize("module", ["__main__ as main; main.program()", "pytest_plugin", "errors"])
def test_importing_loads_nothing_heavy(module):
    loaded = modules_after(f"from autobalancer.harness import {module}")
    assert not loaded & {"numpy", "scipy", "matplotlib", "pydantic", "fmpy", "pythonfmu"}


def test_a_run_that_shows_nothing_but_words_does_without_scipy():
    """Whose statistics and signal processing take longer to load than the run takes."""
    run = "from autobalancer.harness.__main__ import program; "
    run += "program()(['run', 'two_balls', '--set', 'run.revolutions=1'], standalone_mode=False)"
    assert not modules_after(run) & {"matplotlib", "scipy"}


def test_exports_are_there_and_loaded_when_used():
    import autobalancer.harness as harness

    assert {"load_scene", "cosimulate", "check", "build"} <= set(dir(harness))
    assert all(getattr(harness, name) is not None for name in harness.__all__)
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = harness.nothing


def test_a_float_that_touches_the_wall_is_said_loudly(invoke):
    outcome = invoke("run", "liquid_touch", "--set", "run.revolutions=5")
    assert outcome.exit_code == 0, outcome.output
    assert "NOTE: liquid at t = 0.00863938 s: bending 0.000629246 m" in outcome.stderr
    assert "exceeds the gap 0.0006 m" in outcome.stderr


def test_a_run_that_diverges_ends_with_one_and_says_when(invoke, tmp_path):
    path = altered(
        tmp_path, "liquid_heavy_force", **{"[run]": '[coupling]\nscheme = "jacobi"\n\n[run]'}
    )
    outcome = invoke("run", path, "--separate", "-o", tmp_path / "out.csv")
    assert outcome.exit_code == 1, outcome.output
    assert "t = " in outcome.stderr
    assert "Traceback" not in outcome.output
    assert not (tmp_path / "out.csv").exists()
