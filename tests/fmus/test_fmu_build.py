"""The builder: valid, reproducible, self-contained FMUs, and refusals that leave nothing behind."""

from __future__ import annotations

import ast
import inspect
import itertools
import os
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import fmpy
import pytest
from fmpy.validation import validate_fmu

from autobalancer.fmus import build as builder
from autobalancer.fmus.build import UNITS, build, content_id, identity
from autobalancer.fmus.description import UNITS as SI

SHAPES = [
    ("RotorOnSupports", {}),
    ("RotorOnSupports", {"planes": 3, "frame": "fixed"}),
    ("LiquidBalancer", {}),
    ("LiquidBalancer", {"frame": "fixed"}),
    ("BallBalancer", {}),
    ("BallBalancer", {"weights": 1}),
    ("BallBalancer", {"weights": 5, "frame": "fixed"}),
]
shapes = pytest.mark.parametrize(("unit", "options"), SHAPES)


@pytest.fixture
def description(unit, options, tmp_path):
    with zipfile.ZipFile(build(unit, tmp_path, **options)) as archive:
        return ElementTree.fromstring(archive.read("modelDescription.xml"))


def variables_of(description):
    return description.findall("ModelVariables/ScalarVariable")


@shapes
def test_fmpy_finds_nothing(unit, options, tmp_path):
    assert validate_fmu(str(build(unit, tmp_path, **options))) == []


@shapes
def test_date_ends_in_z(description):
    assert re.fullmatch(
        r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", description.get("generationDateAndTime")
    )


@shapes
def test_causality_variability_initial_and_start_are_a_legal_combination(description):
    """FMI 2.0.4, tables of section 2.2.7, and where `start` must or must not stand."""
    legal = {
        ("parameter", "fixed", "exact", True),
        ("input", "continuous", None, True),
        ("input", "discrete", None, True),
        ("output", "continuous", "calculated", False),
        ("output", "discrete", "calculated", False),
    }
    for variable in variables_of(description):
        (kind,) = variable
        found = (
            variable.get("causality"),
            variable.get("variability"),
            variable.get("initial"),
            kind.get("start") is not None,
        )
        assert found in legal, variable.get("name")
        if kind.tag == "Boolean":
            assert found[1] == "fixed"
            assert kind.get("start") in ("true", "false")


@shapes
def test_value_references_and_names_are_unique(description):
    seen = [(v[0].tag, v.get("valueReference")) for v in variables_of(description)]
    assert len(set(seen)) == len(seen)
    names = [v.get("name") for v in variables_of(description)]
    assert len(set(names)) == len(names)
    identifier = r"[A-Za-z_][A-Za-z0-9_]*(\[[1-9][0-9]*\])?"
    structured = rf"{identifier}(\.{identifier})*"
    for name in names:
        assert re.fullmatch(rf"{structured}|der\({structured}(,[1-9])?\)", name)


@shapes
def test_every_unit_of_measure_is_defined(description):
    defined = [u.get("name") for u in description.findall("UnitDefinitions/Unit")]
    assert len(set(defined)) == len(defined)
    used = {v[0].get("unit") for v in variables_of(description) if v[0].tag == "Real"}
    assert used == set(defined)


def test_base_unit_exponents_agree_with_the_units_names():
    base = {
        "1": {},
        "kg": {"kg": 1},
        "m": {"m": 1},
        "s": {"s": 1},
        "rad": {"rad": 1},
        "N": {"kg": 1, "m": 1, "s": -2},
    }

    def factor(text):
        match = re.fullmatch(r"([A-Za-z]+|1)(\d?)", text)
        assert match, text
        name, power = match.groups()
        return {k: v * int(power or 1) for k, v in base[name].items()}

    for unit, exponents in SI.items():
        total: dict[str, int] = {}
        for sign, part in itertools.zip_longest((1, -1), unit.split("/"), fillvalue=""):
            for word in filter(None, part.split(".")):
                for key, power in factor(word).items():
                    total[key] = total.get(key, 0) + sign * power
        assert {k: v for k, v in total.items() if v} == exponents, unit


@shapes
def test_structure_lists_every_output_with_legal_dependencies(description):
    variables = variables_of(description)
    outputs = [str(i) for i, v in enumerate(variables, 1) if v.get("causality") == "output"]
    for element, known, kinds in (
        ("Outputs", {"input"}, {"dependent", "fixed"}),
        ("InitialUnknowns", {"input", "parameter"}, {"dependent"}),
    ):
        unknowns = description.findall(f"ModelStructure/{element}/Unknown")
        assert [u.get("index") for u in unknowns] == outputs
        for unknown in unknowns:
            indices = [int(i) for i in unknown.get("dependencies").split()]
            assert indices == sorted(set(indices))
            assert {variables[i - 1].get("causality") for i in indices} <= known
            found = unknown.get("dependenciesKind").split()
            assert len(found) == len(indices)
            assert set(found) <= kinds


@shapes
def test_derivative_attribute_points_at_the_derived_output(description):
    variables = variables_of(description)
    marked = 0
    for variable in variables:
        index = variable[0].get("derivative")
        if index is None:
            continue
        marked += 1
        of, name = variables[int(index) - 1].get("name"), variable.get("name")
        slope = re.sub(r"(^|\.)([xy])$", r"\1v\2", of)
        assert name in (f"der({of})", slope, of.replace(".angle", ".speed"))
        assert variables[int(index) - 1].get("causality") == "output"
    assert marked


@shapes
def test_declared_dependencies_are_the_real_ones(unit, options):
    """Change each input and parameter in turn and see which outputs answer."""
    cls = UNITS[unit].configured(**builder._options(**_all(unit, options)))
    layout = cls.layout
    known = [v for v in layout.reals if v.causality != "output"]
    outputs = [v for v in layout.reals if v.causality == "output"]
    every = list(range(len(layout.reals)))
    answered: dict[str, set[str]] = {v.name: set() for v in outputs}
    for as_force in (False, True):
        instance = cls(instance_name="unit")
        # nowhere a zero that could hide a dependency
        for k, vr in enumerate(range(layout.inputs.stop)):
            variable = layout.reals[vr]
            if "radius" in variable.name:
                continue
            value = instance.real[vr] or 0.3
            instance.set_real([vr], [value * (1.0 + 0.03 * (k + 1) / len(known))])
        if layout.booleans:
            instance.set_boolean([0], [as_force])
        instance.exit_initialization_mode()
        instance._running = False
        base = dict(zip((v.name for v in layout.reals), instance.get_real(every), strict=True))
        rounding = {
            v.unit: 1e-14 * max(abs(base[o.name]) for o in outputs if o.unit == v.unit)
            for v in outputs
        }
        state = instance._get_fmu_state()
        for variable in known:
            instance._set_fmu_state(state)
            vr = layout.index[variable.name]
            instance.set_real([vr], [state["real"][vr] * 1.1])
            instance._stale = 3
            values = instance.get_real(every)
            for out in outputs:
                change = abs(values[layout.index[out.name]] - base[out.name])
                if change > rounding[out.unit]:
                    answered[out.name].add(variable.name)
    for out in outputs:
        declared = {*out.depends, *out.begins} - {v.name for v in layout.booleans}
        assert answered[out.name] <= declared, (out.name, answered[out.name] - declared)
        # a direct dependency that is not there would look like an algebraic loop
        beyond = set(out.depends) - answered[out.name]
        assert not beyond, (out.name, beyond)


def _all(unit, options):
    """Every argument that `builder._options` takes, with the defaults of `build`."""
    defaults = inspect.signature(build).parameters
    names = [name for name in inspect.signature(builder._options).parameters if name != "unit"]
    return {"unit": unit, **{name: defaults[name].default for name in names}, **options}


@shapes
def test_two_builds_are_the_same_bytes_from_another_folder_and_process(unit, options, tmp_path):
    here = build(unit, tmp_path / "here", **options).read_bytes()
    script = f"from autobalancer.fmus.build import build; build({unit!r}, 'there', **{options!r})"
    environment = {**os.environ, "PYTHONHASHSEED": "7", "TZ": "Asia/Tokyo"}
    subprocess.run([sys.executable, "-c", script], cwd=tmp_path, env=environment, check=True)
    assert (tmp_path / "there" / f"{unit}.fmu").read_bytes() == here
    assert content_id(tmp_path / "there" / f"{unit}.fmu") == identity(unit, **options)


def _imported(sources, begin):
    """Files imported with `begin`, one by the other, and files imported within functions."""
    inside = {path.split("/", 2)[2]: text for path, text in sources.items() if "/fmus/" in path
              or "/models/" in path or "/pythonfmu/" in path}  # fmt: skip
    at_once, later, waiting = set(), set(), [begin]
    while waiting:
        path = waiting.pop()
        if path in at_once:
            continue
        at_once.add(path)
        for node in ast.walk(ast.parse(inside[path])):
            if isinstance(node, ast.ImportFrom) and node.level:
                lines = ast.Module([node], [])
                module = path.removesuffix(".py").replace("/", ".")
                found = builder._imports(module, ast.unparse(lines))
                files = [f"{name.replace('.', '/')}.py" for name in found]
                if node.col_offset == 0:
                    waiting += files
                else:
                    later.update(files)
            elif isinstance(node, ast.Import):
                assert node.col_offset == 0, path
    return at_once, later


@pytest.mark.parametrize("unit", UNITS)
def test_everything_inside_is_imported_at_once_and_under_its_own_name(unit):
    files = builder.contents(unit)
    sources = {p: d.decode() for p, d in files.items() if p.endswith(".py")}
    at_once, later = _imported(sources, f"fmus/{builder._MODULES[unit]}.py")
    assert later <= at_once  # an import that comes later finds its module there already
    for path, text in sources.items():
        assert not re.search(r"^\s*(from|import)\s+pythonfmu", text, re.MULTILINE), path
        assert not re.search(r"^\s*(from|import)\s+autobalancer\.", text, re.MULTILINE), path
    folders = {p.split("/")[1] for p in sources}
    assert len(folders) == 2  # the slave and one package, both named after their content
    assert all(re.fullmatch(r"\w+_[0-9a-f]{16}(\.py)?", folder) for folder in folders)


BARE = """
import sys
import importlib.abc
class Refuse(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in ("numpy", "scipy", "autobalancer", "pythonfmu"):
            raise ImportError("not in this FMU: " + name)
sys.meta_path.insert(0, Refuse())
sys.path.insert(0, sys.argv[1])
module = __import__(open(sys.argv[1] + "/slavemodule.txt").read())
unit = getattr(module, sys.argv[2])(instance_name="unit")
unit.exit_initialization_mode()
assert unit.do_step(0.0, 1e-3)
"""


@pytest.mark.parametrize("unit", ["LiquidBalancer", "BallBalancer"])
def test_balancers_run_on_the_bare_standard_library(unit, tmp_path):
    folder = fmpy.extract(str(build(unit, tmp_path)), unzipdir=str(tmp_path / "unzipped"))
    command = [sys.executable, "-I", "-c", BARE, f"{folder}/resources", unit]
    subprocess.run(command, check=True)
    text = (Path(folder) / "documentation" / "externalDependencies.txt").read_text()
    assert "standard library" in text


def altered(tmp_path, old, new):
    """A builder over a copy of the sources in which `old` reads `new`."""
    root = tmp_path / "older"
    for folder in ("fmus", "models"):
        shutil.copytree(builder._ROOT / folder, root / folder)
    hits = 0
    for path in (root / "models").rglob("*.py"):
        text = path.read_text()
        hits += old in text
        path.write_text(text.replace(old, new))
    assert hits == 1
    return root


SIDE_BY_SIDE = """
import sys, math, fmpy
results = {}
for path in sys.argv[1:] + sys.argv[1:]:
    run = fmpy.simulate_fmu(path, stop_time=0.01, step_size=1e-3, output_interval=1e-3,
                            output=["added_mass"])
    results.setdefault(path, set()).add(float(run["added_mass"][-1]))
ratio = results[sys.argv[1]].pop() / results[sys.argv[2]].pop()
assert not results[sys.argv[1]] and not results[sys.argv[2]]
assert abs(ratio - 3.0) < 1e-12, ratio
loaded = [name for name in sys.modules if name.split(".")[0] in ("autobalancer", "pythonfmu")]
assert not loaded, loaded
"""


def test_older_and_newer_fmu_run_side_by_side(tmp_path, monkeypatch):
    newer = build("LiquidBalancer", tmp_path / "new")
    root = altered(
        tmp_path,
        "self.density * math.pi * self.chamber_radius**2",
        "3.0 * self.density * math.pi * self.chamber_radius**2",
    )
    monkeypatch.setattr(builder, "_ROOT", root)
    older = build("LiquidBalancer", tmp_path / "old")
    monkeypatch.undo()
    assert content_id(older) != content_id(newer) == identity("LiquidBalancer")
    for pair in ((older, newer), (newer, older)):
        script = SIDE_BY_SIDE if pair[0] == older else SIDE_BY_SIDE.replace("- 3.0", "- 1 / 3.0")
        subprocess.run([sys.executable, "-c", script, *map(str, pair)], check=True)


@pytest.mark.parametrize(
    ("unit", "options", "message"),
    [
        ("Rotor", {}, "unit = 'Rotor': must be one of 'RotorOnSupports'"),
        ("LiquidBalancer", {"frame": "moving"}, "frame = 'moving': must be one of 'rotor'"),
        ("RotorOnSupports", {"kind": "round"}, "kind = 'round': must be one of 'planar'"),
        ("RotorOnSupports", {"stations": 2}, "stations = 2: a planar rotor has exactly 1"),
        ("RotorOnSupports", {"planes": 0}, "planes = 0: must be a whole number, at least 1"),
        ("BallBalancer", {"weights": 0}, "weights = 0: must be a whole number, at least 1"),
        ("BallBalancer", {"weights": 2.5}, "weights = 2.5"),
        ("BallBalancer", {"name": "my unit"}, "name = 'my unit': must be letters"),
    ],
)
def test_wrong_arguments_are_named_and_write_nothing(unit, options, message, tmp_path):
    with pytest.raises(ValueError, match=re.escape(message)):
        build(unit, tmp_path / "out", **options)
    assert not (tmp_path / "out").exists()


def test_name_names_model_file_and_binaries(tmp_path):
    path = build("BallBalancer", tmp_path, name="weights_left")
    assert path.name == "weights_left.fmu"
    assert validate_fmu(str(path)) == []
    assert fmpy.read_model_description(str(path)).coSimulation.modelIdentifier == "weights_left"


def test_full_disk_leaves_the_old_file_and_no_other(tmp_path, monkeypatch):
    path = build("LiquidBalancer", tmp_path)
    before = path.read_bytes()

    def full(source, target):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(builder.os, "replace", full)
    with pytest.raises(OSError, match="No space left"):
        build("LiquidBalancer", tmp_path, frame="fixed")
    assert list(tmp_path.iterdir()) == [path]
    assert path.read_bytes() == before


def test_destination_below_a_file_is_an_error(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match="file"):
        build("LiquidBalancer", tmp_path / "file" / "folder")


def test_content_id_refuses_what_is_not_an_fmu(tmp_path):
    junk = tmp_path / "junk.fmu"
    junk.write_bytes(b"junk")
    with pytest.raises(ValueError, match=r"junk\.fmu: not an FMU"):
        content_id(junk)
    with zipfile.ZipFile(junk, "w") as archive:
        archive.writestr("modelDescription.xml", "<a/>")
    with pytest.raises(ValueError, match="not an FMU"):
        content_id(junk)
