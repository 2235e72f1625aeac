"""The builder: valid, reproducible, self-contained FMUs, and refusals that leave nothing behind."""

from __future__ import annotations

import ast
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

from autobalancer.fmus.build import build, contents
from autobalancer.fmus.catalogue import CATALOGUE
from autobalancer.fmus.present import is_present_build, options_of
from autobalancer.fmus.python.package import imports
from tests.fmus.conftest import ELSEWHERE, SHAPES

pytestmark = pytest.mark.slow


@pytest.mark.parametrize(
    ("shape", "backend"),
    [*((one, "native") for one in SHAPES), *((one, "python") for one in ELSEWHERE)],
)
def test_fmpy_finds_nothing(unit, options, tmp_path, backend):
    assert validate_fmu(str(build(unit, tmp_path, backend=backend, **options))) == []


@pytest.mark.parametrize("shape", ELSEWHERE)
def test_two_builds_are_the_same_bytes_from_another_folder_and_process(shape, elsewhere, tmp_path):
    unit, options = shape
    here = build(unit, tmp_path, **options).read_bytes()
    assert elsewhere(shape).read_bytes() == here


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


@pytest.mark.parametrize("unit", [name for name, unit in CATALOGUE.items() if not unit.native])
def test_everything_inside_is_imported_at_once_and_under_its_own_name(unit):
    files = contents(unit, backend="python")
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
    folder = fmpy.extract(
        str(build(unit, tmp_path, backend="python")), unzipdir=str(tmp_path / "unzipped")
    )
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
    newer = build("LiquidBalancer", tmp_path / "new", backend="python")
    older = altered(
        "LiquidBalancer",
        "models/liquid.py",
        "self.density * math.pi * self.chamber_radius**2",
        "3.0 * self.density * math.pi * self.chamber_radius**2",
    )
    found = [is_present_build(path, "LiquidBalancer") for path in (older, newer)]
    assert found == [False, True]
    assert options_of(older) == options_of(newer)
    for pair in ((older, newer), (newer, older)):
        script = SIDE_BY_SIDE if pair[0] == older else SIDE_BY_SIDE.replace("- 3.0", "- 1 / 3.0")
        subprocess.run([sys.executable, "-c", script, *map(str, pair)], check=True)


def test_a_change_that_left_the_guid_alone_is_no_present_build(tmp_path, rewritten):
    path = build("LiquidBalancer", tmp_path, backend="python")

    def halve(name, data):
        return name, data.replace(b"-self.sent", b"-0.5 * self.sent")

    other = rewritten(path, tmp_path / "other.fmu", halve)
    packed_again = rewritten(path, tmp_path / "again.fmu", lambda *member: member)
    assert not is_present_build(other, "LiquidBalancer")
    assert is_present_build(packed_again, "LiquidBalancer")


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
    one, other = (contents(unit, backend="python", **o) for o in (small, large))
    assert one.keys() == other.keys()
    assert {name for name in one if one[name] != other[name]} == {
        "modelDescription.xml", "documentation/index.html", "resources/options.json",
    }  # fmt: skip


def test_units_of_two_sizes_run_in_one_process_even_from_one_folder(host_of):
    """They share every module; what is in the folder when an instance is made is what counts."""
    two, five = (host_of("BallBalancer", "python", weights=k) for k in (2, 5))
    for host in (two, five):
        host.begin().run(3)
    assert len(five.outputs()) - len(two.outputs()) == 2 * 3
    folder = Path(two.slave.unzipDirectory)
    shutil.copy(
        Path(five.slave.unzipDirectory) / "resources" / "options.json", folder / "resources"
    )
    two.slave.terminate()
    two.slave.fmi2FreeInstance(two.slave.component)
    two.variables = five.variables
    two.instantiate()
    two.begin().run(3)
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
        ("Motor", {"backend": "python"}, "Motor: exists as a native unit only"),
        ("RotorOnSupports", {"backend": "python", "sliders": 2}, "sliders = 2: must be 0 in a"),
        ("BallBalancer", {"backend": "c"}, "backend = 'c': must be one of 'python', 'native'"),
        ("BallBalancer", {"fmi": 1}, "fmi = 1: must be one of 2, 3"),
        (
            "BallBalancer",
            {"fmi": 3, "backend": "python"},
            "fmi = 3: Python units are of FMI 2.0 only",
        ),
        (
            "BallBalancer",
            {"platforms": ["x86_64-linux"], "backend": "python"},
            "platforms: only native units",
        ),
        ("BallBalancer", {"platforms": ["amiga"]}, "platform = 'amiga': must be one of 'x86_64-"),
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
    assert is_present_build(path, "LiquidBalancer")


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


def test_destination_that_is_a_file_of_another_kind_is_kept_and_said(tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(OSError, match=r"notes\.txt: is a file: give a folder, or a file that ends"):
        build("LiquidBalancer", tmp_path / "notes.txt")
    assert (tmp_path / "notes.txt").read_text() == "mine"


def test_what_is_not_an_fmu_is_refused(tmp_path):
    junk = tmp_path / "junk.fmu"
    junk.write_bytes(b"junk")
    with pytest.raises(ValueError, match=r"junk\.fmu: not an FMU"):
        options_of(junk)
    with zipfile.ZipFile(junk, "w") as archive:
        archive.writestr("modelDescription.xml", "<a/>")
    with pytest.raises(ValueError, match="not an FMU"):
        options_of(junk)


def test_an_archive_of_unknown_compression_is_not_an_fmu(tmp_path):
    path = build("LiquidBalancer", tmp_path)
    data = bytearray(path.read_bytes())
    entry = data.rindex(b"PK\x01\x02")  # in the directory at the archive's end
    local = int.from_bytes(data[entry + 42 : entry + 46], "little")
    data[local + 8] = data[entry + 10] = 99
    path.write_bytes(bytes(data))
    with pytest.raises(ValueError, match="not an FMU"):
        options_of(path)


def test_a_written_fmu_has_the_permissions_that_the_umask_leaves(tmp_path):
    before = os.umask(0o027)
    try:
        path = build("LiquidBalancer", tmp_path)
    finally:
        os.umask(before)
    assert path.stat().st_mode & 0o777 == 0o640
