"""FMUs and systems that are wrong: a message, exit code 2, no traceback, no temporary folders."""

from __future__ import annotations

import os
import re
import stat
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import pytest
import tomli_w

import autobalancer as ab
from autobalancer.harness.master.foreign import archive, failures, versions


@pytest.fixture(scope="module")
def good(guest):
    return guest("mass")


def described(edit):
    """An FMU whose model description is edited."""
    return lambda good, altered, _: altered(good, edit)


def replaced(old, new):
    def edit(text):
        assert old in text
        return text.replace(old, new)

    return described(edit)


def with_file(name, data=b""):
    return lambda good, altered, _: altered(good, added={name: data})


def written(data):
    def make(_good, _altered, folder):
        (folder / "file.fmu").write_bytes(data)
        return folder / "file.fmu"

    return make


def cosimulation_gone(text):
    start = text.index("<CoSimulation")
    end = text.index("/>", start) + 2
    return text[:start] + '<ModelExchange modelIdentifier="Mass"/>' + text[end:]


BOMB = '<?xml version="1.0"?><!DOCTYPE b [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;">]>'
FILES = {
    "missing": (lambda *_: Path("nowhere.fmu"), "nowhere.fmu: no such file"),
    "directory": (lambda _g, _a, folder: folder, "is a directory"),
    "text": (written(b"this is no archive"), "not a sound FMU, which is a zip archive"),
    "empty": (written(b""), "not a sound FMU"),
    "cut": (
        lambda good, _a, folder: written(good.read_bytes()[:5000])(good, _a, folder),
        "File is not a zip file; copy, download or export the file again",
    ),
    "no description": (
        lambda good, altered, _: altered(good, without="modelDescription.xml"),
        "has no modelDescription.xml: is not an FMU",
    ),
    "no XML": (described(lambda text: text[:300]), "modelDescription.xml is not XML"),
    "invalid": (replaced("<ModelVariables>", "<ModelVariables><Nonsense/>"), "is not valid"),
    "no version": (replaced('fmiVersion="2.0"', ""), "states no fmiVersion"),
    "FMI 1": (replaced('fmiVersion="2.0"', 'fmiVersion="1.0"'), "is of FMI 1.0; FMI 2.0 and 3.0"),
    "FMI 9": (replaced('fmiVersion="2.0"', 'fmiVersion="9.1"'), "is of FMI 9.1"),
    "model exchange": (described(cosimulation_gone), "is for model exchange only"),
    "no binaries": (
        lambda good, altered, _: altered(good, without="binaries/"),
        "has no binaries, none for this machine",
    ),
    "another platform": (
        lambda good, altered, _: altered(
            good, without="binaries/", added={"binaries/win32/Mass.dll": b""}
        ),
        "has binaries for win32, none for this machine",
    ),
    "outside": (with_file("../elsewhere"), "a path outside the archive: it is not unpacked"),
    "absolute": (with_file("/etc/elsewhere"), "a path outside the archive"),
    "drive": (with_file("C:/elsewhere"), "a path outside the archive"),
    "zip bomb": (with_file("resources/big", bytes(150_000_000)), "would unpack to 1.5"),
    "entities": (described(lambda text: BOMB + text[text.index("<fmi") :]), "defines entities"),
    "link outwards": (
        lambda good, altered, folder: linked(altered(good), "../../../etc/passwd"),
        "resources/link is a link to '../../../etc/passwd', which is no file of the archive",
    ),
    "one name twice": (replaced('name="v0"', 'name="x0"'), 'variable name "x0"'),
    "identifier": (
        described(lambda text: re.sub('modelIdentifier="[^"]*"', 'modelIdentifier="../x"', text)),
        "modelIdentifier = '../x': must be the name of a library, without a path",
    ),
    "identifier with a folder": (
        lambda good, altered, _: altered(
            good,
            lambda text: re.sub('modelIdentifier="[^"]*"', 'modelIdentifier="a/Mass"', text),
            added={f"binaries/{instance_platform()}/a/Mass.so": b"no library"},
        ),
        "modelIdentifier = 'a/Mass': must be the name of a library",
    ),
    "library": (
        lambda good, altered, _: altered(
            good,
            without="binaries/",
            added={f"binaries/{instance_platform()}/Mass.so": b"no library"},
        ),
        "cannot be loaded",
    ),
}


def linked(path, target):
    """The FMU with a symbolic link in it."""
    link = zipfile.ZipInfo("resources/link")
    link.create_system, link.external_attr = 3, (stat.S_IFLNK | 0o777) << 16
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr(link, target)
    return path


def instance_platform():
    import fmpy

    return fmpy.platform


@pytest.fixture
def ran(invoke, tmp_path):
    """Run a system with a command; what it said, once nothing is left behind."""

    def run(**tables):
        document = {"coupling": {"step": 0.1}, "run": {"duration": 0.5}, **tables}
        (tmp_path / "system.toml").write_text(tomli_w.dumps(document))
        before = set(os.listdir(tempfile.gettempdir()))
        done = invoke("run", tmp_path / "system.toml")
        assert done.exit_code == 2, done.output
        assert "Traceback" not in done.output
        left = {n for n in set(os.listdir(tempfile.gettempdir())) - before if "unit" in n}
        assert not left
        return " ".join(done.output.split())

    return run


@pytest.mark.parametrize("case", FILES)
def test_a_broken_file_is_refused_with_what_is_wrong(case, good, altered, ran, tmp_path):
    make, words = FILES[case]
    assert words in ran(unit=[{"name": "m", "fmu": str(make(good, altered, tmp_path))}])


MOODS = {
    "fails": "moody (Moody.fmu) at t = 0.1 s: a step of 0.1 s failed",
    "raises": "ZeroDivisionError('a division in the second step')",
    "nan": "moody.y is no finite number at t = 0.1 s",
    "refuses": "mass must be positive",
}


@pytest.mark.parametrize("mood", MOODS)
def test_a_unit_that_fails_while_it_runs_is_named_with_time_and_reason(mood, guest, ran):
    unit = [{"name": "moody", "fmu": str(guest("moody")), "start": {"mood": mood}}]
    unit += [{"name": "s", "fmu": str(guest("spring"))}]
    assert MOODS[mood] in ran(unit=unit, connection=[{"from": "moody.y", "to": "s.x1"}])


def test_a_unit_that_hangs_when_it_is_freed_is_left_and_named(guest, ran, monkeypatch):
    monkeypatch.setattr(failures, "PATIENCE", 0.3)
    unit = [{"name": "moody", "fmu": str(guest("moody")), "start": {"mood": "hangs"}}]
    assert "hangs when it is freed: not back after 0.3 s" in ran(unit=unit)


WIRES = {
    "unknown unit": ([{"from": "q.x", "to": "s.x1"}], "no unit 'q'; units: m, s, n"),
    "unknown output": ([{"from": "m.q", "to": "s.x1"}], "Mass.fmu has no variable 'q'"),
    "unknown input": (
        [{"from": "m.x", "to": "s.q1"}],
        "Spring.fmu has no variable 'q1'; it has: k, c, x1",
    ),
    "from an input": ([{"from": "m.F", "to": "s.x1"}], "causality input in Mass.fmu: only outputs"),
    "to an output": ([{"from": "m.x", "to": "s.F"}], "only inputs are fed; inputs: x1, v1"),
    "two sources": (
        [{"from": "m.x", "to": "s.x1"}, {"from": "m.v", "to": "s.x1"}],
        "has a source already, m.x; give add = true if their sum is meant",
    ),
    "Boolean to real": ([{"from": "n.on", "to": "s.x1"}], "is of type Boolean, s.x1 of type Real"),
    "real to integer": ([{"from": "m.x", "to": "n.into"}], "types must be the same"),
    "a factor of an integer": (
        [{"from": "n.steps", "to": "n.into", "factor": 2.0}],
        "is of type Integer, which is not multiplied",
    ),
}


@pytest.mark.parametrize("case", WIRES)
def test_a_wrong_connection_is_refused_with_what_is_possible(case, guest, ran):
    files = {"m": "mass", "s": "spring", "n": "moody"}
    unit = [{"name": name, "fmu": str(guest(file))} for name, file in files.items()]
    wires, words = WIRES[case]
    assert words in ran(unit=unit, connection=wires)


STARTS = {
    "unknown": ({"mas": 1.0}, "has no variable 'mas'"),
    "text": ({"m": "heavy"}, "m = 'heavy': is of type Real in Mass.fmu"),
    "output": ({"x": 1.0}, "is an output of Mass.fmu, and cannot be set"),
}


def test_a_derivative_from_elsewhere_than_its_value_is_refused(guest, altered, ran):
    """That of an input is taken from where its value is; the connection was passed over."""
    spring = altered(guest("spring"), lambda text: text.replace('name="v1"', 'name="der(x1)"'))
    unit = [{"name": "m", "fmu": str(guest("mass"))}, {"name": "s", "fmu": str(spring)}]
    wires = [{"from": "m.x", "to": "s.x1"}, {"from": "m.v", "to": "s.der(x1)"}]
    said = ran(unit=unit, connection=wires)
    assert "is the derivative of s.x1, which m.x feeds: it can come from m.der(x) alone" in said


def test_a_derivative_beside_its_value_must_exist(guest, altered, ran):
    spring = altered(guest("spring"), lambda text: text.replace('name="v1"', 'name="der(x1)"'))
    unit = [{"name": "m", "fmu": str(guest("mass"))}, {"name": "s", "fmu": str(spring)}]
    wires = [{"from": "m.x", "to": "s.x1"}, {"from": "m.der(x)", "to": "s.der(x1)"}]
    assert "Mass.fmu has no variable 'der(x)'" in ran(unit=unit, connection=wires)


@pytest.mark.parametrize("case", STARTS)
def test_a_wrong_start_value_is_refused(case, good, ran):
    start, words = STARTS[case]
    assert words in ran(unit=[{"name": "m", "fmu": str(good), "start": start}])


def test_other_dimensions_are_refused(guest, altered, ran):
    definitions = (
        '<UnitDefinitions><Unit name="m"><BaseUnit m="1"/></Unit>'
        '<Unit name="N"><BaseUnit kg="1" m="1" s="-2"/></Unit></UnitDefinitions><LogCategories>'
    )

    def measured(name, unit):
        def edit(text):
            text = text.replace("<LogCategories>", definitions)
            real = text.index("<Real", text.index(f'name="{name}"'))
            return f'{text[:real]}<Real unit="{unit}"{text[real + 5 :]}'

        return edit

    mass = altered(guest("mass"), measured("x", "m"), name="mass.fmu")
    spring = altered(guest("spring"), measured("x1", "N"), name="spring.fmu")
    unit = [{"name": "m", "fmu": str(mass)}, {"name": "s", "fmu": str(spring)}]
    said = ran(unit=unit, connection=[{"from": "m.x", "to": "s.x1"}])
    assert "m.x is in m, s.x1 in N: m and N are of different dimensions" in said


def test_a_unit_that_exists_once_is_not_made_twice(good, altered, ran):
    once = altered(
        good,
        lambda text: text.replace(
            'canBeInstantiatedOnlyOncePerProcess="false"',
            'canBeInstantiatedOnlyOncePerProcess="true"',
        ),
    )
    unit = [{"name": name, "fmu": str(once)} for name in "ab"]
    assert "can be instantiated only once per process" in ran(unit=unit)


def test_a_scheme_that_takes_steps_back_is_refused_to_units_that_cannot(guest, ran):
    unit = [
        {"name": n, "fmu": str(guest(f, state=False))} for n, f in (("m", "mass"), ("s", "spring"))
    ]
    wires = [{"from": "m.x", "to": "s.x2"}, {"from": "s.F", "to": "m.F", "factor": -1.0}]
    coupling = {"step": 0.1, "scheme": "iterated"}
    said = ran(unit=unit, connection=wires, coupling=coupling)
    assert 'coupling.scheme = "iterated": m, s cannot restore a state' in said


def test_a_signal_that_no_unit_has_is_refused(good, ran):
    run = {"duration": 0.5, "record": ["m.q"]}
    assert "'m.q' is not recorded by any unit" in ran(
        unit=[{"name": "m", "fmu": str(good)}], run=run
    )


def test_a_link_within_the_archive_is_followed(good, altered):
    linked(altered(good), "slavemodule.txt")
    path = good.parent / "linked.fmu"
    path.write_bytes(altered(good).read_bytes())
    with versions.foreign_unit(linked(path, "slavemodule.txt"), "m") as unit:
        assert (unit.folder / "resources" / "link").read_text() == "mass"


@pytest.mark.skipif(os.name == "nt", reason="signals of a crash are answered on POSIX alone")
@pytest.mark.parametrize("mood", ["crashes", "aborts"])
def test_a_unit_that_crashes_the_process_is_named_and_leaves_nothing(mood, guest, tmp_path):
    unit = [{"name": "moody", "fmu": str(guest("moody")), "start": {"mood": mood}}]
    document = {"unit": unit, "coupling": {"step": 0.1}, "run": {"duration": 0.5}}
    (tmp_path / "system.toml").write_text(tomli_w.dumps(document))
    (tmp_path / "temporary").mkdir()
    done = subprocess.run(
        [sys.executable, "-m", "autobalancer.harness", "run", tmp_path / "system.toml"],
        capture_output=True, text=True, env={**os.environ, "TMPDIR": str(tmp_path / "temporary")},
    )  # fmt: skip
    assert done.returncode == 2, done.stderr
    assert "moody (Moody.fmu) at t = 0.1 s: a step of 0.1 s crashed this process" in done.stderr
    assert not list((tmp_path / "temporary").iterdir())


def test_a_unit_that_asks_to_end_ends_the_run_there(guest, altered, monkeypatch):
    monkeypatch.setattr(versions.Fmi2Unit, "_is_terminated", lambda _: True)
    system = ab.System(
        unit=[{"name": "moody", "fmu": str(guest("moody")), "start": {"mood": "fails"}}],
        coupling={"step": 0.1},
        run={"duration": 0.5},
    )
    result = system.run()
    assert result.time[-1] == pytest.approx(0.1)
    assert "asks to end the simulation at t = 0.1 s: the run ends there" in result.events[0]


def test_an_output_that_is_no_number_ends_the_run_though_nobody_listens(guest, ran):
    unit = [{"name": "moody", "fmu": str(guest("moody")), "start": {"mood": "nan"}}]
    assert "moody.y is no finite number at t = 0.2 s: Moody.fmu has failed" in ran(unit=unit)


def test_a_huge_description_is_refused(good, altered, ran, monkeypatch):
    monkeypatch.setattr(archive, "LARGEST_DESCRIPTION", 100_000)
    huge = altered(good, lambda text: text.replace("</fmi", f"<!--{'x' * 100_000}--></fmi", 1))
    assert "modelDescription.xml has 10" in ran(unit=[{"name": "m", "fmu": str(huge)}])
