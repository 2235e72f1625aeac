"""A scene as a system structure package: read and run by tools that nobody here wrote."""

from __future__ import annotations

import math
import re
import zipfile
from functools import cache

import numpy as np
import pytest
from fmpy import platform_tuple, read_model_description
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import get_connections, read_ssd, read_ssv
from lxml import etree

from autobalancer.harness import Scene, SceneError, cosimulate, load_scene
from autobalancer.harness.export.ssp.build import build_ssp
from autobalancer.harness.export.ssp.structure import separate
from autobalancer.harness.master.plan import plan
from autobalancer.harness.master.recorder import recorded
from autobalancer.harness.master.schedule import end_time, step_size
from tests.studies.tools.measure import TOOLS, VALUES, driven

SCENES = ("two_balls", "drum", "balls_and_liquid", "three_mass_shaft", "run_up", "liquid_closed")
SPACES = {"ssd": "http://ssp-standard.org/SSP1/SystemStructureDescription"}


@pytest.fixture(scope="module")
def packages(tmp_path_factory):
    """Packages of scenes, each made once."""
    folder = tmp_path_factory.mktemp("ssp")

    @cache
    def package(name, one_file=False):
        path = folder / f"{name}-{one_file}.ssp"
        return build_ssp(load_scene(name), path, one_file=one_file, platforms=[platform_tuple])

    return package


@pytest.mark.parametrize("name", SCENES)
def test_fmpy_reads_the_plan_back_from_a_package_that_keeps_to_the_schema(packages, name):
    path, planned = packages(name), plan(load_scene(name))
    structure = read_ssd(str(path))  # checks the schema of SSP 1.0, as `read_ssv` does
    read = {
        (f"{a.parent.name}.{a.name}", f"{b.parent.name}.{b.name}")
        for a, b in get_connections(structure.system)
        if a.parent is not structure.system
    }
    expected = set()
    for target, (source, *more) in planned.inputs("signal").items():
        assert not more
        for shape in ("{}", "der({})"):
            ends = [f"{p.unit}.{shape.format(p.variable)}" for p in (source, target)]
            expected.add(tuple(ends))
    for target, sources in planned.inputs("value", "mass").items():
        if len(sources) == 1:
            expected.add(tuple(f"{p.unit}.{p.variable}" for p in (sources[0], target)))
    assert read == expected
    parameters = {p.name: p for p in read_ssv(str(path), "resources/parameters.ssv").parameters}
    for unit in planned.units:
        for key, value in unit.start.items():
            written = parameters.get(f"{unit.name}.{key}")
            if value is False:
                assert written is None
            else:
                assert written.value == ("true" if value is True else repr(float(value)))


@pytest.mark.parametrize("name", SCENES)
def test_every_connector_is_a_variable_of_its_fmu_of_that_kind_and_unit(packages, name, tmp_path):
    with zipfile.ZipFile(packages(name)) as archive:
        archive.extractall(tmp_path)
    root = etree.parse(tmp_path / "SystemStructure.ssd")
    for component in root.iterfind(".//ssd:Component", SPACES):
        fmu = read_model_description(str(tmp_path / component.get("source")))
        variables = {v.name: v for v in fmu.modelVariables}
        for connector in component.iterfind(".//ssd:Connector", SPACES):
            variable = variables[connector.get("name")]
            assert connector.get("kind") == variable.causality
            assert connector[0].get("unit") == variable.unit


def test_what_the_rotor_carries_is_known_where_masses_add_up(packages):
    parameters = read_ssv(str(packages("balls_and_liquid")), "resources/parameters.ssv").parameters
    with_both = {p.name: float(p.value) for p in parameters}["rotor.plane[1].added_mass"]
    scene = load_scene("balls_and_liquid").replace({"run.revolutions": 0.1})
    ours = cosimulate(scene, record=[f"{b.label}.added_mass" for b in scene.balancer])
    masses = [ours[f"{b.label}.added_mass"][0] for b in scene.balancer]
    assert min(masses) > 0.0
    assert with_both == pytest.approx(sum(masses), rel=1e-14)


def test_an_unbalance_that_changes_is_refused_with_the_way_out():
    with pytest.raises(SceneError, match="--one-file --ssp has the changes"):
        separate(load_scene("washing_machine"))


def test_forces_that_add_up_are_refused_with_the_way_out():
    document = load_scene("two_balls").document
    [ring] = document["balancer"]
    both = [ring, {**ring, "name": "second"}]
    with pytest.raises(SceneError, match=r"weights, second .* add up.*--one-file --ssp"):
        separate(Scene.from_document({**document, "balancer": both}))
    with pytest.raises(SceneError, match=r"motor: .*torques .* add up.*--one-file --ssp"):
        separate(load_scene("sommerfeld"))


def _simulated(path, scene, steps, **given):
    """Run by FMPy; it shows the end of each step under the time of its begin."""
    step = step_size(scene)
    parameters = read_ssv(str(path), "resources/parameters.ssv")
    return simulate_ssp(str(path), 0.0, (steps - 0.5) * step, step, parameters, **given)


@pytest.mark.parametrize("name", ["two_balls", "sommerfeld"])
def test_the_composite_in_fmpy_moves_as_the_harness_has_it(packages, name):
    """Within the tolerance: a run repeats itself with finer steps."""
    scene = load_scene(name).replace({"run.revolutions": 20, "coupling.steps_per_rev": 40})
    steps = round(end_time(scene) / step_size(scene))
    theirs = _simulated(packages(name, one_file=True), scene, steps)
    ours = cosimulate(scene, record=["rotor.x", "rotor.y"])
    for signal in ("rotor.x", "rotor.y"):
        gap = np.abs(theirs[f"{scene.name}.{signal}"] - ours[signal][1:]).max()
        assert gap < 1e-4 * np.abs(ours[signal]).max()


def test_parameters_of_the_set_reach_the_units_in_fmpy(packages):
    """Its first step has no added mass and no force: the error is a tenth, and falls with steps."""
    scene = load_scene("two_balls")
    gaps = []
    for factor in (1, 4):
        finer = scene.replace({"coupling.steps_per_rev": 20 * factor})
        steps = round(end_time(finer) / step_size(finer))
        theirs = _simulated(packages("two_balls"), finer, steps)["rotor.x"]
        right = cosimulate(finer, record=["rotor.x"])["rotor.x"][1:]
        gaps.append(np.abs(theirs - right).max() / np.abs(right).max())
    assert 0.05 < gaps[0] < 0.2
    assert gaps[1] < gaps[0] / 2.0


def test_libcosim_couples_the_units_of_a_package_to_the_digits_of_held_jacobi(tmp_path):
    """Another master, nobody's here: it counts time in whole nanoseconds."""
    pytest.importorskip("libcosimpy")
    step, names = 1.0 / 64.0, ["rotor.x", "rotor.plane[1].a_xi", "weights.weight[2].speed"]
    scene = load_scene("two_balls").replace(
        {
            "operation.speed": 2.0 * math.pi / (40.0 * step),
            "coupling.steps_per_rev": 40,
            "coupling.scheme": "jacobi",
            "coupling.order": 0,
            "coupling.corrections": None,
        }
    )
    ours = cosimulate(scene, record=names, separate=True)
    (tool,) = (tool for tool in TOOLS if tool.name == "libcosim")
    path = build_ssp(scene, tmp_path / "two.ssp", slopes=False, platforms=[platform_tuple])
    _, rows = driven(tool, VALUES, path, step, len(ours.time) - 1, names)
    for column, name in zip(rows.T, names, strict=True):
        assert np.abs(column - ours[name][1:]).max() <= 1e-9 * np.abs(ours[name]).max(), name


def test_a_run_up_takes_its_speed_from_outside(packages):
    structure = read_ssd(str(packages("run_up"))).system
    assert [c.name for c in structure.connectors] == ["speed", "acceleration"]
    wired = {
        (a.name, b.parent.name) for a, b in get_connections(structure) if a.parent is structure
    }
    assert wired == {(n, u) for n in ("speed", "acceleration") for u in ("rotor", "weights")}


def test_omsimulator_finds_its_step(packages):
    with zipfile.ZipFile(packages("two_balls")) as archive:
        root = etree.fromstring(archive.read("SystemStructure.ssd"))
    found = root.xpath(
        "ssd:System/ssd:Annotations/*[@type='org.openmodelica']/*/*/*", namespaces=SPACES
    )
    assert [etree.QName(x).localname for x in found] == ["FixedStepMaster"]
    assert float(found[0].get("stepSize")) == step_size(load_scene("two_balls"))


@pytest.mark.parametrize("one_file", [False, True])
def test_a_variant_has_what_a_run_records_as_outputs_of_the_system(packages, tmp_path, one_file):
    """Written over the default, which libcosim needs without them, it runs in FMPy."""
    scene, path = load_scene("two_balls"), tmp_path / "two.ssp"
    with zipfile.ZipFile(packages("two_balls", one_file)) as old, zipfile.ZipFile(path, "w") as new:
        for name in old.namelist():
            if not name.endswith(".ssd"):
                new.writestr(name, old.read(name))
        new.writestr("SystemStructure.ssd", old.read("SystemOutputs.ssd"))
    outputs = {c.name for c in read_ssd(str(path)).system.connectors if c.kind == "output"}
    owner = "two_balls." if one_file else ""
    assert outputs >= {re.sub(r"\W+", "_", name).strip("_") for name in recorded(scene)}
    theirs = _simulated(path, scene, 20)
    assert (theirs["rotor_x"] == theirs[f"{owner}rotor.x"]).all()
    assert np.abs(theirs["rotor_x"]).max() > 0.0


@pytest.mark.parametrize("one_file", [False, True])
def test_fmus_of_fmi_3_are_packed_as_ssp_2(packages, tmp_path, one_file):
    """The namespaces and structure of 1.0, with the types of FMI 3.0 and the number of 2.0."""
    scene = load_scene("two_balls")
    platforms = [platform_tuple]
    path = build_ssp(scene, tmp_path / "two.ssp", one_file=one_file, platforms=platforms, fmi=3)
    with zipfile.ZipFile(path) as new, zipfile.ZipFile(packages("two_balls", one_file)) as old:
        assert sorted(new.namelist()) == sorted(old.namelist())
        for name in ("SystemStructure.ssd", "SystemOutputs.ssd", "resources/parameters.ssv"):
            text = new.read(name).decode()
            assert etree.fromstring(text.encode()).get("version") == "2.0"
            back = text.replace("Float64", "Real").replace('version="2.0"', 'version="1.0"')
            assert back == old.read(name).decode()
        fmu = next(name for name in new.namelist() if name.endswith(".fmu"))
        (tmp_path / "unit.fmu").write_bytes(new.read(fmu))
    assert read_model_description(str(tmp_path / "unit.fmu")).fmiVersion == "3.0"


def test_the_command_builds_a_package(invoke, tmp_path):
    platform = ["--platform", "x86_64-linux"]
    for asked, made in ((tmp_path, "two_balls.ssp"), (tmp_path / "one.ssp", "one.ssp")):
        assert invoke("build", "two_balls", "--ssp", "-o", asked, *platform).exit_code == 0
        assert zipfile.is_zipfile(tmp_path / made)
    refused = invoke("build", "two_balls", "--ssp", "--python", "--fmi", 3, "-o", tmp_path)
    assert refused.exit_code != 0
    assert "--fmi 3" in str(refused.exception) + refused.output
