"""SSP files run as systems: nested systems, parameter sets, mappings, factors of connections."""

from __future__ import annotations

import re
import zipfile

import numpy as np
import pytest
from fmpy import platform_tuple
from scipy.interpolate import CubicSpline

import autobalancer as ab
from autobalancer.harness.export.ssp.build import build_ssp

NAMES = (
    'xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription" '
    'xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon" '
    'xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues" '
    'xmlns:ssm="http://ssp-standard.org/SSP1/SystemStructureParameterMapping"'
)
STRUCTURE = """<?xml version="1.0"?>
<ssd:SystemStructureDescription {names} version="{version}" name="chain">
 <ssd:System name="root" description="two masses">
  <ssd:Connectors><ssd:Connector name="y" kind="output"/></ssd:Connectors>
  <ssd:ParameterBindings>
   <ssd:ParameterBinding source="stiff.ssv">
      <ssd:ParameterMapping source="map.ssm"/></ssd:ParameterBinding>
  </ssd:ParameterBindings>
  <ssd:Elements>
   <ssd:Component name="spring" source="resources/Spring.fmu"/>
   <ssd:System name="left">
    <ssd:Connectors><ssd:Connector name="x" kind="output"/>
      <ssd:Connector name="F" kind="input"/></ssd:Connectors>
    <ssd:Elements><ssd:Component name="mass" source="resources/Mass.fmu">
     <ssd:ParameterBindings><ssd:ParameterBinding>
      <ssd:ParameterValues><ssv:ParameterSet version="1.0" name="p">
      <ssv:Parameters>
      <ssv:Parameter name="x0"><ssv:{real} value="1.0"/></ssv:Parameter></ssv:Parameters>
     </ssv:ParameterSet></ssd:ParameterValues></ssd:ParameterBinding></ssd:ParameterBindings>
    </ssd:Component></ssd:Elements>
    <ssd:Connections>
     <ssd:Connection startElement="mass" startConnector="x" endConnector="x"/>
     <ssd:Connection startConnector="F" endElement="mass" endConnector="F"/>
    </ssd:Connections>
   </ssd:System>
   <ssd:Component name="right" source="resources/Mass.fmu"/>
  </ssd:Elements>
  <ssd:Connections>
   <ssd:Connection startElement="left" startConnector="x" endElement="spring" endConnector="x1"/>
   <ssd:Connection startElement="right" startConnector="x" endElement="spring" endConnector="x2"/>
   <ssd:Connection startElement="spring" startConnector="F" endElement="left" endConnector="F"/>
   <ssd:Connection startElement="spring" startConnector="F" endElement="right" endConnector="F">
    <ssc:LinearTransformation factor="-1.0"/>
   </ssd:Connection>
   <ssd:Connection startElement="right" startConnector="x" endConnector="y"/>
  </ssd:Connections>
 </ssd:System>
 <ssd:DefaultExperiment startTime="0.0" stopTime="1.0"/>
</ssd:SystemStructureDescription>
"""
VALUES = """<ssv:ParameterSet {names} version="1.0" name="all"><ssv:Parameters>
<ssv:Parameter name="kilo"><ssv:{real} value="0.02"/></ssv:Parameter>
<ssv:Parameter name="spring.c"><ssv:{real} value="0.0"/></ssv:Parameter>
</ssv:Parameters></ssv:ParameterSet>"""
MAPPING = """<ssm:ParameterMapping {names} version="1.0">
<ssm:MappingEntry source="kilo" target="right.k">
      <ssc:LinearTransformation factor="1000.0"/></ssm:MappingEntry>
</ssm:ParameterMapping>"""


@pytest.fixture
def chain(guest, tmp_path):
    """An SSP of two masses and a spring, one of them in a system of its own."""

    def make(version="1.0", edit=lambda text: text):
        real = "Real" if version == "1.0" else "Float64"
        texts = {"SystemStructure.ssd": STRUCTURE, "stiff.ssv": VALUES, "map.ssm": MAPPING}
        with zipfile.ZipFile(tmp_path / "chain.ssp", "w") as archive:
            for name, text in texts.items():
                archive.writestr(name, edit(text.format(names=NAMES, version=version, real=real)))
            archive.write(guest("mass"), "resources/Mass.fmu")
            archive.write(guest("spring"), "resources/Spring.fmu")
        return tmp_path / "chain.ssp"

    return make


@pytest.mark.parametrize("version", ["1.0", "2.0"])
def test_an_ssp_is_flattened_with_its_parameters(chain, version):
    system = ab.load_system(chain(version))
    start = {unit.name: unit.start for unit in system.unit}
    assert start == {"spring": {"c": 0.0}, "left_mass": {"x0": 1.0}, "right": {"k": 20.0}}
    wires = {(c.source, c.to): c.factor for c in system.connection}
    assert wires == {
        ("left_mass.x", "spring.x1"): 1.0,
        ("right.x", "spring.x2"): 1.0,
        ("spring.F", "left_mass.F"): 1.0,
        ("spring.F", "right.F"): -1.0,
    }
    assert system.run.record == ("right.x",)
    assert system.run.duration == 1.0


def test_an_ssp_runs_as_the_same_system_of_a_scene_file(chain, guest):
    found = ab.load_system(chain()).replace({"coupling.step": 0.02}).run()
    mass, spring = str(guest("mass")), str(guest("spring"))
    same = ab.System(
        unit=[
            {"name": "s", "fmu": spring, "start": {"c": 0.0}},
            {"name": "a", "fmu": mass, "start": {"x0": 1.0}},
            {"name": "b", "fmu": mass, "start": {"k": 20.0}},
        ],
        connection=[
            {"from": "a.x", "to": "s.x1"},
            {"from": "b.x", "to": "s.x2"},
            {"from": "s.F", "to": "a.F"},
            {"from": "s.F", "to": "b.F", "factor": -1},
        ],
        coupling={"step": 0.02},
        run={"duration": 1.0},
    ).run()
    np.testing.assert_allclose(found["right.x"], same["b.x"], rtol=0, atol=1e-6)


def test_an_ssp_of_ours_runs_as_its_scene(tmp_path):
    scene = ab.load("two_balls").replace({"run.revolutions": 2})
    from fmpy import platform_tuple

    (path,) = scene.build(tmp_path, ssp=True, platforms=[platform_tuple]).files
    system = ab.load_system(path).replace({"coupling.step": 0.05, "run.duration": 4.0})
    found, expected = system.run(record=["rotor.x"]), scene.replace({"run.duration": 4.0}).run()
    x = CubicSpline(expected.time, expected["rotor.x"])(found.time)
    assert np.abs(found["rotor.x"] - x).max() < 1e-4 * np.abs(x).max()


def test_a_parameter_of_any_whole_type_is_read(chain):
    """A type of FMI 3.0, which no other parameter of the file has."""
    edit = put('<ssv:Real value="1.0"', '<ssv:UInt64 value="2"')
    start = {unit.name: unit.start for unit in ab.load_system(chain(edit=edit)).unit}
    assert start["left_mass"] == {"x0": 2}


def put(old, new):
    """An edit of a file that has the text."""
    return lambda text: text.replace(old, new) if old in text else text


ONE = (
    '<ssd:Connection startElement="left" startConnector="x" endElement="spring" endConnector="x1"/>'
)
BACK = (
    '<ssd:Connection startElement="spring" startConnector="x1" endElement="left" endConnector="x"/>'
)
WRONG = {
    "outside": (put("resources/Spring.fmu", "../Spring.fmu"), "a path within the SSP"),
    "offset": (put('factor="-1.0"', 'factor="-1.0" offset="2"'), "offset or a table"),
    "no set": (put("stiff.ssv", "none.ssv"), "has no none.ssv"),
    "no XML": (lambda t: t.replace("</ssd:System>", "", 1), "is not XML"),
    "no FMU": (put('source="resources/Spring.fmu"', 'source="a.ssd"'), "components are FMUs"),
    "entities": (put("<?xml", "<!DOCTYPE a><?xml"), "defines entities"),
    "missing FMU": (
        put("Spring.fmu", "Gone.fmu"),
        "spring: the archive has no 'resources/Gone.fmu'",
    ),
    "missing component": (
        put('<ssd:Component name="spring" source="resources/Spring.fmu"/>', ""),
        "parameter 'spring.c': is of no component and no connector",
    ),
    "unknown element": (put('startElement="right"', 'startElement="rigth"'), "no element 'rigth'"),
    "unknown connector": (put('endConnector="x1"', 'endConnector="q"'), "has no variable 'q'"),
    "open chain": (
        put('<ssd:Connection startElement="mass" startConnector="x" endConnector="x"/>', ""),
        "spring.x1: is connected to a connector that nothing feeds",
    ),
    "one name twice": (
        put('name="right" source', 'name="spring" source'),
        "spring: two elements have this name",
    ),
    "one connection twice": (put(ONE, ONE + ONE), "spring.x1: has two connections"),
    "no number": (
        put('value="1.0"', 'value="1,0"'),
        "parameter x0 = '1,0': must be a finite number",
    ),
    "no factor": (
        put('factor="-1.0"', 'factor="minus"'),
        "factor = 'minus': must be a finite number",
    ),
    "binary parameter": (
        put('<ssv:Real value="1.0"', '<ssv:Binary value="00"'),
        "parameter x0: type Binary is not supported",
    ),
    "no stop": (
        put('stopTime="1.0"', 'stopTime="soon"'),
        "stopTime = 'soon': must be a finite number",
    ),
    "infinite whole number": (
        lambda t: re.sub(r"<ssv:(Real|Float64) value=\"1.0\"", '<ssv:Integer value="inf"', t),
        "parameter x0 = 'inf': must be a finite number",
    ),
    "no stop known": (put('stopTime="1.0"', 'stopTime="nan"'), "'nan': must be a finite number"),
    "later start": (put('startTime="0.0"', 'startTime="5"'), "systems start at 0 s here"),
    "parameter of nobody": (put('name="spring.c"', 'name="nobody.c"'), "is of no component"),
    "unknown parameter": (put('name="x0"', 'name="x9"'), "Mass.fmu has no variable 'x9'"),
}


@pytest.mark.parametrize("case", WRONG)
def test_an_ssp_that_cannot_be_read_is_refused_with_what_is_wrong(chain, case, invoke):
    edit, words = WRONG[case]
    done = invoke("run", chain(edit=edit))
    assert done.exit_code == 2, done.output
    assert words in " ".join(done.output.split())


def test_an_fmu_of_an_ssp_is_named_by_the_package_and_its_place_in_it(chain, invoke):
    path = chain()
    with zipfile.ZipFile(path) as archive:
        kept = {name: archive.read(name) for name in archive.namelist()}
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in {**kept, "resources/Spring.fmu": b"no archive"}.items():
            archive.writestr(name, data)
    done = invoke("run", path)
    assert done.exit_code == 2, done.output
    assert f"{path.name}: resources/Spring.fmu: is not a sound FMU" in done.output
    assert "/autobalancer-ssp-" not in done.output


def test_an_ssp_that_is_cut_off_says_what_to_do(chain, invoke):
    whole = chain().read_bytes()
    # by its last bytes the end of an FMU in it seems to be that of the archive
    for left, words in ((20, "is not a sound SSP"), (len(whole) - 100, "is not complete")):
        path = chain()
        path.write_bytes(whole[:left])
        done = invoke("run", path)
        assert done.exit_code == 2, done.output
        assert words in done.output
        assert "copy, download or export the file again" in " ".join(done.output.split())


def test_either_end_of_a_connection_can_be_written_first(chain):
    runs = [ab.load_system(chain(edit=edit)).connection for edit in (str, put(ONE, BACK))]
    assert {(c.source, c.to) for c in runs[0]} == {(c.source, c.to) for c in runs[1]}


def test_names_of_components_become_names_of_units(chain):
    def edit(text):
        return text.replace('"spring"', '"1 spring!"').replace("spring.c", "1 spring!.c")

    assert "_1_spring_" in [unit.name for unit in ab.load_system(chain(edit=edit)).unit]


def test_an_input_of_the_whole_system_keeps_its_start(chain):
    top = '<ssd:Connector name="u" kind="input"/>'
    wire = '<ssd:Connection startConnector="u" endElement="spring" endConnector="v1"/>'

    def edit(text):
        text = text.replace('<ssd:Connector name="y"', f'{top}<ssd:Connector name="y"')
        return text.replace(ONE, ONE + wire)

    system = ab.load_system(chain(edit=edit))
    assert "spring.v1" not in [c.to for c in system.connection]


@pytest.fixture(scope="module")
def run_up(tmp_path_factory):
    """A scene whose speed changes, and its package of separate units."""
    scene = ab.load("washing_machine_stops")
    file = tmp_path_factory.mktemp("ssp") / "stops.ssp"
    return scene, build_ssp(scene, file, platforms=[platform_tuple])


def test_a_package_whose_speed_nothing_changes_is_refused_with_the_ways_out(run_up):
    with pytest.raises(ab.UserError, match=r"rotor, ring: nothing feeds.*--one-file --ssp.*hold"):
        ab.load_system(str(run_up[1])).run()


def test_a_package_with_a_stop_moves_as_its_scene_at_a_speed_that_is_held(run_up):
    scene, file = run_up
    held = {f"{unit}.{key}": v for unit in ("rotor", "ring") for key, v in
            (("speed", 20.0), ("acceleration", 0.0))}  # fmt: skip
    found = ab.load_system(str(file)).replace({**held, "run.duration": 2.0}).run()
    changes = {"operation.run_up": None, "operation.speed": 20.0, "run.duration": 2.0}
    ours = scene.replace(changes).run()
    assert ours["rotor.stop[1].touches"][-1] >= 1
    name = "rotor.stop[1].largest_force"
    assert found[name][-1] == pytest.approx(ours[name][-1], rel=1e-3)
