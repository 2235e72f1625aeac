"""The builder: valid, reproducible, self-contained FMUs, and refusals that leave nothing behind."""

from __future__ import annotations

import ast
import itertools
import math
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

from autobalancer.fmus.build import build, content_id, contents, identity, options_of
from autobalancer.fmus.catalogue import CATALOGUE
from autobalancer.fmus.python.package import imports
from autobalancer.fmus.xml import fmi2, fmi3
from autobalancer.fmus.xml.description import Capabilities, options_in
from autobalancer.fmus.xml.types import SI_UNITS

SHAPES = [
    ("RotorOnSupports", {}),
    ("RotorOnSupports", {"kind": "two_support", "stations": 2, "unbalances": 2}),
    ("RotorOnSupports", {"kind": "flexible", "stations": 4, "shaft": "compliance"}),
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
        ("output", "continuous", "calculated", False),
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
    identifier = r"[A-Za-z_][A-Za-z0-9_]*(\[[1-9][0-9]*(,[1-9][0-9]*)?\])?"
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

    for unit, exponents in SI_UNITS.items():
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
def test_derivative_attribute_points_at_the_derived_variable(description):
    variables = variables_of(description)
    marked = set()
    for variable in variables:
        index = variable[0].get("derivative")
        if index is None:
            continue
        derived, name = variables[int(index) - 1], variable.get("name")
        of = derived.get("name")
        slope = re.sub(r"(^|\.)([xy])$", r"\1v\2", of)
        higher = re.sub(r"^der\(([^(),]+)(?:,(\d))?\)$", _next_order, of)
        assert name in (f"der({of})", slope, higher, of.replace(".angle", ".speed"))
        assert derived.get("causality") == variable.get("causality")
        marked.add(variable.get("causality"))
    assert marked == {"input", "output"}


def _next_order(match):
    return f"der({match[1]},{int(match[2] or 1) + 1})"


@shapes
def test_types_say_quantity_display_unit_and_nominal(description):
    types = {t.get("name"): t[0] for t in description.findall("TypeDefinitions/SimpleType")}
    units = {u.get("name"): u for u in description.findall("UnitDefinitions/Unit")}
    used = set()
    for variable in variables_of(description):
        if variable[0].tag == "Real":
            used.add(variable[0].get("declaredType"))
            declared = types[variable[0].get("declaredType")]
            assert declared.get("unit") == variable[0].get("unit")
            assert declared.get("quantity")
            assert float(declared.get("nominal")) > 0.0
    assert used == set(types)
    shown = {"rad/s": ("rpm", 1.0 / (2.0 * math.pi / 60.0)), "rad": ("deg", 180.0 / math.pi),
             "m": ("mm", 1000.0)}  # fmt: skip
    for declared in types.values():
        display = shown.get(declared.get("unit"))
        assert declared.get("displayUnit") == (display and display[0])
        if display:
            (element,) = units[declared.get("unit")].findall("DisplayUnit")
            assert element.get("name") == display[0]
            assert float(element.get("factor")) == pytest.approx(display[1], rel=1e-15)


@shapes
def test_bounds_are_values_that_the_unit_takes(unit, options, description, probe):
    """`min` and `max` are allowed, what lies beyond is not; an excluded bound is in the words."""
    for variable in variables_of(description):
        if variable[0].tag == "Boolean":
            continue
        declared = CATALOGUE[unit].sized(options).layout
        declared = declared.reals[declared.index[variable.get("name")]]
        low = variable[0].get("min")
        if declared.above:
            assert low is None
            assert f"(above {declared.minimum:g}" in variable.get("description")
            assert declared.problem(declared.minimum)
        elif low is not None:
            assert not declared.problem(float(low))
            assert declared.problem(math.nextafter(float(low), -math.inf))
        high = variable[0].get("max")
        if high is not None:
            for value, allowed in ((float(high), True), (math.nextafter(float(high), 9.9), False)):
                instance = probe(unit, begin=False, **options)
                instance.put(variable.get("name"), value)
                if allowed:
                    instance.exit_initialization_mode()
                else:
                    with pytest.raises(RuntimeError, match=variable.get("name")):
                        instance.exit_initialization_mode()


@shapes
def test_fmi_3_description_is_valid_and_says_the_same(unit, options, description, tmp_path):
    """Read and checked by fmpy against the standard's schema; only the references of Booleans
    differ, which FMI 3.0 wants unique over all types."""
    sized = CATALOGUE[unit].sized(options)
    can = Capabilities(output_derivatives=1, directional_derivatives=True)
    text = fmi3.model_description(sized, unit, "token", "1.0", can)
    (tmp_path / "modelDescription.xml").write_bytes(text)
    found = fmpy.read_model_description(str(tmp_path))
    assert found.fmiVersion == "3.0"
    assert found.instantiationToken == "token"
    element = ElementTree.fromstring(text).find("CoSimulation")
    assert element.get("providesDirectionalDerivatives") == "true"
    references = {v.name: v.valueReference for v in found.modelVariables}
    assert sorted(references.values()) == list(range(len(references)))
    assert references == fmi3.value_references(sized.layout)
    reals, booleans = len(sized.layout.reals), len(sized.layout.booleans)
    assert references.pop("time") == reals + booleans
    by_name = {v.name: v for v in found.modelVariables}
    assert by_name["time"].causality == "independent"
    outputs = {u.variable.name: {d.name for d in u.dependencies} for u in found.outputs}
    variables = variables_of(description)
    for old in variables:
        new = by_name[old.get("name")]
        shift = reals if old[0].tag == "Boolean" else 0
        assert new.valueReference == int(old.get("valueReference")) + shift
        assert (new.causality, new.variability) == (old.get("causality"), old.get("variability"))
        start = old[0].get("start")
        assert new.start == start
        assert (new.min, new.max, new.unit) == tuple(map(old[0].get, ("min", "max", "unit")))
        index = old[0].get("derivative")
        of = index and variables[int(index) - 1].get("name")
        assert (new.derivative and new.derivative.name) == of
    for unknown in description.findall("ModelStructure/Outputs/Unknown"):
        names = {variables[int(i) - 1].get("name") for i in unknown.get("dependencies").split()}
        assert outputs[variables[int(unknown.get("index")) - 1].get("name")] == names
    assert options_in(ElementTree.fromstring(text)) == {"unit": unit, **sized.options}


def test_native_capabilities_and_sources_stand_in_both_descriptions():
    sized = CATALOGUE["LiquidBalancer"].sized()
    can = Capabilities(True, 1, True, True, ("liquid.c", "unit.c"))
    two = ElementTree.fromstring(fmi2.model_description(sized, "Liquid", "token", "1", can))
    element = two.find("CoSimulation")
    assert element.get("canInterpolateInputs") == "true"
    assert element.get("maxOutputDerivativeOrder") == "1"
    assert element.get("providesDirectionalDerivative") == "true"
    assert [file.get("name") for file in element.iter("File")] == ["liquid.c", "unit.c"]
    sources = ElementTree.fromstring(fmi3.build_description("Liquid", can))
    assert sources.find("BuildConfiguration").get("modelIdentifier") == "Liquid"
    assert [file.get("name") for file in sources.iter("SourceFile")] == ["liquid.c", "unit.c"]


@shapes
def test_declared_dependencies_are_the_real_ones(unit, options, probe):
    """Change each input and parameter in turn and see which outputs answer."""
    layout = CATALOGUE[unit].sized(options).layout
    known = [v for v in layout.reals if v.causality != "output"]
    outputs = [v for v in layout.reals if v.causality == "output"]
    every = list(range(len(layout.reals)))
    answered: dict[str, set[str]] = {v.name: set() for v in outputs}
    placed = _station if options.get("kind") == "flexible" else lambda name: False
    for as_force in (False, True):
        instance = probe(unit, begin=False, **options)
        # nowhere a zero that could hide a dependency
        for k, variable in enumerate(known):
            (value,) = instance.look(variable.name)
            if "radius" not in variable.name and not placed(variable.name):
                instance.put(variable.name, (value or 0.3) * (1.0 + 0.03 * (k + 1) / len(known)))
        for flag in layout.booleans:
            instance.put(flag.name, as_force)
        base = instance.get_real(every)
        rounding = {
            v.unit: 1e-14
            * max(abs(base[layout.index[o.name]]) for o in outputs if o.unit == v.unit)
            for v in outputs
        }
        for variable in known:
            (value,) = instance.look(variable.name)
            if placed(variable.name):
                continue
            instance.put(variable.name, value * 1.1)
            values = instance.get_real(every)
            instance.put(variable.name, value)
            for out in outputs:
                change = abs(values[layout.index[out.name]] - base[layout.index[out.name]])
                if change > rounding[out.unit]:
                    answered[out.name].add(variable.name)
    for out in outputs:
        declared = {*out.depends, *out.begins} - {v.name for v in layout.booleans}
        assert answered[out.name] <= declared, (out.name, answered[out.name] - declared)
        # a direct dependency that is not there would look like an algebraic loop
        beyond = set(out.depends) - answered[out.name]
        assert not beyond, (out.name, beyond)


def _station(name):
    """Whether a parameter must be the place of a station."""
    return re.fullmatch(r"(station\[\d+\]\.z|(support|plane|unbalance)\[\d+\]\.position)", name)


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
                found = imports(module, ast.unparse(lines))
                files = [f"{name.replace('.', '/')}.py" for name in found]
                if node.col_offset == 0:
                    waiting += files
                else:
                    later.update(files)
            elif isinstance(node, ast.Import):
                assert node.col_offset == 0, path
    return at_once, later


@pytest.mark.parametrize("unit", CATALOGUE)
def test_everything_inside_is_imported_at_once_and_under_its_own_name(unit):
    files = contents(unit)
    sources = {p: d.decode() for p, d in files.items() if p.endswith(".py")}
    at_once, later = _imported(sources, f"fmus/{CATALOGUE[unit].folder}/slave.py")
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
unit = getattr(module, sys.argv[2])(instance_name="unit", resources=sys.argv[1])
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


def test_older_and_newer_fmu_run_side_by_side(tmp_path, altered):
    newer = build("LiquidBalancer", tmp_path / "new")
    older = altered(
        "LiquidBalancer",
        "models/liquid.py",
        "self.density * math.pi * self.chamber_radius**2",
        "3.0 * self.density * math.pi * self.chamber_radius**2",
    )
    assert content_id(older) != content_id(newer) == identity("LiquidBalancer")
    assert options_of(older) == options_of(newer)
    for pair in ((older, newer), (newer, older)):
        script = SIDE_BY_SIDE if pair[0] == older else SIDE_BY_SIDE.replace("- 3.0", "- 1 / 3.0")
        subprocess.run([sys.executable, "-c", script, *map(str, pair)], check=True)


def test_content_id_sees_a_change_that_left_the_guid_alone(tmp_path, rewritten):
    path = build("LiquidBalancer", tmp_path)

    def halve(name, data):
        return name, data.replace(b"-self.sent", b"-0.5 * self.sent")

    other = rewritten(path, tmp_path / "other.fmu", halve)
    guids = [fmpy.read_model_description(str(file)).guid for file in (path, other)]
    assert guids[0] == guids[1]
    assert content_id(other) != content_id(path)
    packed_again = rewritten(path, tmp_path / "again.fmu", lambda *member: member)
    assert content_id(packed_again) == content_id(path)


@shapes
def test_options_are_read_from_the_file_as_they_were_built(unit, options, tmp_path):
    path = build(unit, tmp_path, **options)
    assert options_of(path) == {"unit": unit, **CATALOGUE[unit].sized(options).options}
    text = zipfile.ZipFile(path).read("modelDescription.xml").decode()
    annotations = ElementTree.fromstring(text).find("VendorAnnotations")
    assert not list(annotations.iter("Unit"))


@pytest.mark.parametrize(
    ("unit", "small", "large"),
    [
        ("BallBalancer", {"weights": 1}, {"weights": 7, "frame": "fixed"}),
        ("RotorOnSupports", {"planes": 3}, {"kind": "flexible", "stations": 5}),
    ],
)
def test_sizes_are_data_beside_the_same_sources(unit, small, large):
    one, other = contents(unit, **small), contents(unit, **large)
    assert one.keys() == other.keys()
    assert {name for name in one if one[name] != other[name]} == {
        "modelDescription.xml", "documentation/index.html", "resources/options.json",
    }  # fmt: skip


def test_units_of_two_sizes_run_in_one_process_even_from_one_folder(fmu, host_of):
    """They share every module; what is in the folder when an instance is made is what counts."""
    two, five = (host_of(fmu("BallBalancer", weights=k)) for k in (2, 5))
    for host in (two, five):
        host.start()
        host.run(3)
    assert len(five.outputs()) - len(two.outputs()) == 2 * 3
    folder = Path(two.slave.unzipDirectory)
    shutil.copy(
        Path(five.slave.unzipDirectory) / "resources" / "options.json", folder / "resources"
    )
    two.slave.terminate()
    two.slave.fmi2FreeInstance(two.slave.component)
    two.reference = five.reference
    two.description = five.description
    two.start()
    two.run(3)
    assert two.outputs() == five.outputs()
    for host in (two, five):
        host.free()


DECLARED = """
import sys
for name in ("numpy", "scipy", "pythonfmu", "markdown_it"):
    sys.modules[name] = None
from autobalancer.fmus.catalogue import CATALOGUE
from autobalancer.fmus.rotor.variables import ROTOR
print(*(len(unit.sized().layout.reals) for unit in CATALOGUE.values()))
"""


def test_declarations_need_the_standard_library_alone():
    found = subprocess.run([sys.executable, "-c", DECLARED], check=True, capture_output=True)
    expected = [len(unit.sized().layout.reals) for unit in CATALOGUE.values()]
    assert list(map(int, found.stdout.split())) == expected


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
        ("BallBalancer", {"backend": "c"}, "backend = 'c': must be one of 'python', 'native'"),
        ("BallBalancer", {"fmi": 1}, "fmi = 1: must be one of 2, 3"),
        ("BallBalancer", {"fmi": 3}, "fmi = 3: Python units are of FMI 2.0 only"),
        ("BallBalancer", {"platforms": ["linux64"]}, "platforms: only native units"),
    ],
)
def test_wrong_arguments_are_named_and_write_nothing(unit, options, message, tmp_path):
    with pytest.raises(ValueError, match=re.escape(message)):
        build(unit, tmp_path / "out", **options)
    assert not (tmp_path / "out").exists()


def test_option_that_no_unit_has_is_refused_with_the_nearest(tmp_path):
    with pytest.raises(TypeError, match=r"weigths: no unit has this .* did you mean 'weights'\?"):
        build("BallBalancer", tmp_path / "out", weigths=3)
    assert not (tmp_path / "out").exists()


def test_options_of_other_units_are_left_aside(tmp_path):
    path = build("LiquidBalancer", tmp_path, weights=3, planes=2)
    assert content_id(path) == identity("LiquidBalancer")


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

    monkeypatch.setattr("os.replace", full)
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
