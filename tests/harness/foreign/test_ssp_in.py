"""SSP files run as systems: nested systems, parameter sets, mappings, factors of connections."""

from __future__ import annotations

import zipfile

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import autobalancer as ab

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


@pytest.mark.parametrize(
    ("edit", "words"),
    [
        (lambda t: t.replace("resources/Spring.fmu", "../Spring.fmu"), "a path within the SSP"),
        (lambda t: t.replace('factor="-1.0"', 'factor="-1.0" offset="2"'), "offset or a table"),
        (lambda t: t.replace("stiff.ssv", "none.ssv"), "has no none.ssv"),
        (lambda t: t.replace("</ssd:System>", "", 1), "is not XML"),
        (
            lambda t: t.replace('source="resources/Spring.fmu"', 'source="a.ssd"'),
            "components are FMUs",
        ),
        (lambda t: t.replace("<?xml", "<!DOCTYPE a><?xml"), "defines entities"),
    ],
)
def test_an_ssp_that_cannot_be_read_is_refused_with_what_is_wrong(chain, edit, words, invoke):
    done = invoke("run", chain(edit=edit))
    assert done.exit_code == 2
    assert words in " ".join(done.output.split())
