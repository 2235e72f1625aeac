"""Native FMUs and the wheel: what is inside, where, and that it is all a tool needs."""

from __future__ import annotations

import re
import shutil
import tarfile
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import fmpy
import numpy as np
import pytest
from fmpy.build import build_platform_binary

from autobalancer.fmus.build import build, contents
from autobalancer.fmus.catalogue import CATALOGUE
from autobalancer.fmus.native.build.compile import (
    PLATFORMS,
    SOURCE,
    libraries,
    one_source,
    stamp,
    texts,
)
from autobalancer.fmus.native.build.package import universal
from autobalancer.fmus.present import is_present_build
from tests.wheel import build_backend

pytestmark = pytest.mark.slow

pytest.importorskip("ziglang", reason="no compiler: ziglang is not installed")


def native(unit, folder, **options):
    return build(unit, folder, backend="native", **options)


def _names(path: Path, folder: str) -> set[str]:
    with zipfile.ZipFile(path) as archive:
        return {name for name in archive.namelist() if name.startswith(folder)}


# --- FMU --------------------------------------------------------------------------------------


@pytest.mark.parametrize("unit", CATALOGUE)
def test_a_native_unit_needs_no_python(unit):
    files = contents(unit, backend="native")
    assert not [name for name in files if name.endswith(".py")]
    assert not any(b"pythonfmu" in data.lower() for data in files.values())
    assert b"libpython" not in b"".join(files.values())


def test_guid_says_unit_sizes_layout_and_sources():
    files = contents("BallBalancer", backend="native", weights=3)
    guid = ElementTree.fromstring(files["modelDescription.xml"]).get("guid")
    assert re.fullmatch(rf"BallBalancer/frame=rotor/weights=3/[0-9a-f]{{16}}-{stamp()}", guid)


def test_fmi_2_folders_serve_x86_and_arm(tmp_path):
    path = native("LiquidBalancer", tmp_path, name="liquid")
    assert _names(path, "binaries/") == {
        "binaries/linux64/liquid.so",
        "binaries/aarch64-linux/liquid.so",
        "binaries/win64/liquid.dll",
        "binaries/darwin64/liquid.dylib",
        "binaries/aarch64-darwin/liquid.dylib",
    }
    made = {name: file.read_bytes() for name, file in libraries().items()}
    with zipfile.ZipFile(path) as archive:
        assert archive.read("binaries/linux64/liquid.so") == made["x86_64-linux"]
        both = universal([made["x86_64-darwin"], made["aarch64-darwin"]])
        assert archive.read("binaries/darwin64/liquid.dylib") == both


def test_fmi_3_folders_are_named_as_the_platforms_are_and_the_build_is_described():
    files = contents("LiquidBalancer", backend="native", fmi=3, name="liquid")
    found = {name for name in files if name.startswith("binaries/")}
    suffixes = {"linux": "so", "windows": "dll", "darwin": "dylib"}
    assert found == {f"binaries/{name}/liquid.{suffixes[name.split('-')[1]]}" for name in PLATFORMS}
    made = ElementTree.fromstring(files["sources/buildDescription.xml"])
    assert made.find("BuildConfiguration").get("modelIdentifier") == "liquid"
    listed = {file.get("name") for file in made.iter("SourceFile")}
    assert listed == {SOURCE}


@pytest.mark.parametrize(
    ("platforms", "folders"),
    [
        (["x86_64-linux"], {"linux64"}),
        (["x86_64-darwin", "x86_64-windows"], {"darwin64", "win64"}),
        # fmpy on arm64 looks in linux64
        (["aarch64-linux"], {"linux64", "aarch64-linux"}),
        (["aarch64-darwin"], {"darwin64", "aarch64-darwin"}),
    ],
)
def test_chosen_platforms_and_no_other(platforms, folders, tmp_path):
    path = native("LiquidBalancer", tmp_path, platforms=platforms)
    assert {name.split("/")[1] for name in _names(path, "binaries/")} == folders


@pytest.mark.parametrize("platforms", [["x86_64-linux"], list(PLATFORMS)])
def test_a_present_build_has_this_machines_library_and_its_sizes(platforms, tmp_path):
    path = native("LiquidBalancer", tmp_path, platforms=platforms)
    assert is_present_build(path, "LiquidBalancer")
    assert not is_present_build(path, "LiquidBalancer", frame="fixed")
    other = native("LiquidBalancer", tmp_path, platforms=["x86_64-windows"])
    assert not is_present_build(other, "LiquidBalancer")


def test_the_source_in_a_unit_is_that_of_its_libraries(tmp_path):
    path = native("BallBalancer", tmp_path)
    with zipfile.ZipFile(path) as archive:
        listed = ElementTree.fromstring(archive.read("modelDescription.xml"))
        files = [file.get("name") for file in listed.findall("CoSimulation/SourceFiles/File")]
        assert files == [SOURCE]
        assert archive.read(f"sources/{SOURCE}").decode() == one_source()
    assert _names(path, "sources/") == {f"sources/{SOURCE}"}


GENERATED = ("constants.h", "layout.h", "stamp.h", "weights_parameters.h")


def test_the_one_source_holds_each_file_once_behind_what_it_includes():
    files = re.findall(r'^#line 1 "(.+)"$', one_source(), re.M)
    special = {name for name in texts() if name.split("/")[0] in ("wasm", "windows")}
    parts = ("copies", "lanes", "places_beside", "steps_beside", "weights_beside")
    beside = [f"{part}.c" for part in parts]  # texts of their own
    headers = ("copies.h", "lane_machine.h", "lane_names.h", "lane_number.h", "two_weights.h")
    special |= {f"lanes/{name}" for name in (*beside, *headers)}
    assert sorted(files) == sorted({*texts(), *GENERATED} - special)
    place = {name: k for k, name in enumerate(files)}
    for name in texts().keys() - special:
        for included in re.findall(r'^#include "(.+)"$', texts()[name], re.M):
            in_place = included.endswith("_template.h")
            assert place[included] < place[name] or in_place


# --- in a tool --------------------------------------------------------------------------------


def _run(path: Path) -> np.ndarray:
    return fmpy.simulate_fmu(
        str(path),
        stop_time=0.05,
        output_interval=0.0005,
        start_values={"a_xi": 30.0, "speed": 200.0, "weight[1].angle0": 0.2},
        output=["F_xi", "F_eta", "weight[1].angle", "spread"],
    )


@pytest.mark.skipif(shutil.which("cmake") is None, reason="no cmake: fmpy compiles with it")
@pytest.mark.parametrize(("fmi", "optimised"), [(2, "Debug"), (3, "Debug")])
def test_a_unit_that_a_tool_compiles_from_its_sources_gives_the_same_bits(fmi, optimised, tmp_path):
    built = native("BallBalancer", tmp_path, platforms=["x86_64-windows"], fmi=fmi)
    folder = Path(fmpy.extract(str(built), unzipdir=str(tmp_path / "unit")))
    assert len(list((folder / "binaries").iterdir())) == 1
    build_platform_binary(folder, configuration=optimised)
    ours = _run(native("BallBalancer", tmp_path / "ours"))
    assert np.ptp(ours["weight[1].angle"]) > 1e-4
    assert _run(folder).tobytes() == ours.tobytes()


# --- wheel ------------------------------------------------------------------------------------


def test_the_wheel_has_libraries_sources_and_the_manual_in_at_most_7_million_bytes(wheel):
    assert wheel.name.endswith("-py3-none-any.whl")
    assert wheel.stat().st_size <= 7_000_000
    home = "autobalancer/fmus/native"
    with zipfile.ZipFile(wheel) as archive:
        manual = [e.compress_size for e in archive.infolist() if "/manual/" in e.filename]
        assert wheel.stat().st_size - sum(manual) <= 2_800_000
        for target, path in libraries().items():
            assert archive.read(f"{home}/bin/{target}/{path.name}") == path.read_bytes()
            assert archive.read(f"{home}/bin/{target}/stamp").decode() == stamp()
        everything = archive.namelist()
    assert {f"{home}/{name}" for name in texts()} <= {*everything}
    # of units the documentation, not the recorded runs that tests compare with
    pages = [name for name in everything if name.endswith(".md") and "/fmus/" in name]
    folders = {"composite", *(unit.folder for unit in CATALOGUE.values())}
    assert sorted(pages) == [f"autobalancer/fmus/{name}/README.md" for name in sorted(folders)]
    assert not [name for name in everything if name.endswith(("_in.csv", "_ref.csv"))]


def test_the_source_distribution_has_the_sources_and_no_library(checkout, tmp_path):
    name = build_backend(checkout, f"build_sdist({str(tmp_path)!r})")
    with tarfile.open(tmp_path / name) as archive:
        names = {n.split("/", 1)[-1] for n in archive.getnames()}
    assert {f"fmus/native/{name}" for name in texts()} <= names
    assert not [n for n in names if "/bin/" in n]
    assert {"CONTRIBUTING.md", "CHANGELOG.md", "CITATION.cff"} <= names  # a wheel's manual has them


def test_the_compiler_is_asked_for_only_when_the_libraries_are_stale(checkout):
    for kind in ("wheel", "editable"):
        call = f"get_requires_for_build_{kind}()"
        assert build_backend(checkout, call) == "[]"
        stamp = checkout / "fmus/native/bin/x86_64-windows/stamp"
        kept = stamp.read_text()
        stamp.write_text("0" * 16)
        wanted = build_backend(checkout, call)
        stamp.write_text(kept)
        assert "ziglang==" in wanted
        assert "numpy" not in wanted
