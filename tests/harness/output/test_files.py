"""Outputs: a place is looked at before the work, and nothing that is there is lost."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from matplotlib.figure import Figure
from typer.testing import CliRunner

from autobalancer.harness import load_scene
from autobalancer.harness.__main__ import program
from autobalancer.harness.checks.runner import check_all, unique_names
from autobalancer.harness.errors import SimulationError, UserError
from autobalancer.harness.output.files import write_whole
from autobalancer.harness.output.plot import save
from autobalancer.harness.output.table import Sheet

pytestmark = pytest.mark.slow

AUTOBALANCER = [sys.executable, "-m", "autobalancer.harness"]
SHORT = ["run", "two_balls", "--set", "run.revolutions=1", "--set", 'run.record=["rotor.x"]']


def test_a_write_protected_file_is_refused_before_the_run_and_kept(tmp_path, monkeypatch):
    def never(*_arguments, **_options):
        raise AssertionError("work begun for an output that cannot be written")

    monkeypatch.setattr("autobalancer.harness.result.run.cosimulate", never)
    kept = tmp_path / "kept.csv"
    kept.write_text("a year's work", encoding="utf-8")
    kept.chmod(0o444)
    outcome = CliRunner().invoke(program(), [*SHORT, "-o", str(kept)])
    assert outcome.exit_code == 2, outcome.output
    assert outcome.stderr == f"{kept}: cannot be written: it is write-protected\n"
    with pytest.raises(UserError, match="write-protected"), write_whole(kept) as stream:
        stream.write("new")
    assert kept.read_text(encoding="utf-8") == "a year's work"


@pytest.mark.parametrize("place", ["/proc/out.csv", "/sys/out.csv", "/nowhere/out.csv", "/"])
def test_a_place_that_takes_no_file_is_refused_before_the_run(place, monkeypatch):
    def never(*_arguments, **_options):
        raise AssertionError("work begun for an output that cannot be written")

    monkeypatch.setattr("autobalancer.harness.result.run.cosimulate", never)
    outcome = CliRunner().invoke(program(), [*SHORT, "-o", place])
    assert outcome.exit_code == 2, outcome.output
    assert f"{place}: cannot be written" in outcome.stderr


def test_a_name_too_long_for_a_file_is_refused_before_the_run(tmp_path):
    outcome = CliRunner().invoke(program(), [*SHORT, "-o", str(tmp_path / ("a" * 251 + ".csv"))])
    assert outcome.exit_code == 2, outcome.output
    assert "too long" in outcome.stderr


@pytest.mark.parametrize("to_file", [False, True])
def test_signals_can_go_to_standard_output(tmp_path, to_file):
    target = tmp_path / "all"
    with target.open("w") as stream:
        done = subprocess.run(
            [*AUTOBALANCER, *SHORT, "-o", "/dev/stdout"],
            stdout=stream if to_file else subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert done.returncode == 0, done.stderr
    lines = (target.read_text() if to_file else done.stdout).splitlines()
    assert "time,rotor.x" in lines
    assert any(line.startswith(("Balanced", "Not ", "Vibration")) for line in lines)


@pytest.mark.parametrize("redirection", [">&-", "| true", "> /dev/full"])
def test_a_standard_output_that_nobody_reads_gives_no_traceback(redirection):
    command = " ".join(f"'{part}'" for part in [*AUTOBALANCER, *SHORT])
    done = subprocess.run(
        ["bash", "-c", f"set -o pipefail; {command} {redirection}"],
        stderr=subprocess.PIPE,
        text=True,
        check=False,
    )
    assert done.returncode in (0, 1, 2)
    assert "Traceback" not in done.stderr
    assert "Exception" not in done.stderr


def same_names(tmp_path: Path) -> list[Path]:
    text = load_scene("liquid_touch").path.read_text(encoding="utf-8")
    paths = []
    for folder in ("one", "two"):
        (tmp_path / folder).mkdir()
        paths.append(tmp_path / folder / "same.toml")
        paths[-1].write_text(text, encoding="utf-8")
    return paths


def test_scenes_that_share_a_file_name_have_pictures_of_their_own(tmp_path):
    first, second = map(load_scene, same_names(tmp_path))
    assert unique_names([first, second, first]) == ["same", "same-2", "same"]


def test_scenes_that_share_a_file_name_have_headings_of_their_own(tmp_path):
    reports = check_all([load_scene(path) for path in same_names(tmp_path)], workers=1)
    assert [{row.scene for row in report.rows} for report in reports] == [{"same"}, {"same-2"}]


def test_a_picture_that_cannot_be_measured_does_not_cost_the_report(tmp_path, monkeypatch):
    def singular(_scene, _speeds):  # as an undamped shaft at its critical speed
        raise SimulationError("no steady state")

    monkeypatch.setattr("autobalancer.harness.checks.pictures.cosimulated_bending", singular)
    report = tmp_path / "report"
    outcome = CliRunner().invoke(program(), ["check", "liquid_touch", "--report", str(report)])
    assert outcome.exit_code == 0, outcome.output
    text = (report / "report.html").read_text(encoding="utf-8")
    assert "All 9 rows hold." in text
    assert "no steady state" in text


def test_a_title_neither_commands_the_terminal_nor_writes_html():
    sheet = Sheet(("a",), [["\x1b[31mred<script>x</script> 1 < 2"]], title="\x1b]0;mine\x07")
    from rich.console import Console

    screen = Console(record=True, file=open(os.devnull, "w"), width=100)  # noqa: SIM115
    screen.print(sheet.rich())
    shown = screen.export_text()
    assert "\x1b" not in shown
    assert "\x07" not in shown
    assert r"\x1b[31mred" in shown
    assert "&lt;script>" in sheet.markdown()
    assert "1 < 2" in sheet.markdown()
    outcome = CliRunner().invoke(program(), [*SHORT, "--set", "rotor.mass\x1b[31m=1"])
    assert "\x1b" not in outcome.output


def test_a_dollar_in_a_title_is_drawn_as_it_stands(tmp_path):
    path = tmp_path / "dollar.toml"
    text = load_scene("two_balls").path.read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if not line.startswith("title")]
    path.write_text("\n".join(['title = "costs $\\\\frac$ 5"', *lines]), encoding="utf-8")
    setting = ["--set", "run.revolutions=1"]
    outcome = CliRunner().invoke(
        program(), ["run", str(path), *setting, "--plot", str(tmp_path / "p.png")]
    )
    assert outcome.exit_code == 0, outcome.output


@pytest.mark.parametrize("kind", ["png", "svg", "pdf"])
@pytest.mark.filterwarnings("ignore:overflow encountered")
def test_a_picture_that_cannot_be_drawn_is_refused_and_leaves_no_file(tmp_path, kind):
    figure = Figure()
    figure.add_subplot().plot([0.0, 1.0], [-1e308, 1e308])
    with pytest.raises(UserError, match="cannot be drawn"):
        save(figure, tmp_path / f"wide.{kind}")
    assert not list(tmp_path.iterdir())
