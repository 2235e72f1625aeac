"""Units built for a scene start from its values, in the description and in the library alike."""

from __future__ import annotations

import fmpy
import pytest
from fmpy import platform_tuple

from autobalancer.fmus.build import build, contents, written
from autobalancer.fmus.native.build.tokens import identity_of
from autobalancer.fmus.present import is_present_build
from autobalancer.harness import cosimulate, load_scene
from autobalancer.harness.export.ssp.build import build_ssp
from autobalancer.harness.export.start import start_values
from autobalancer.harness.master.plan import about, plan

SCENES = ["two_balls", "sommerfeld"]


def units_of(name: str, **form) -> list:
    scene = load_scene(name)
    start = start_values(scene)
    return [
        (unit, {"start": start[unit.name], "about": about(unit, scene), **unit.sizes, **form})
        for unit in plan(scene).units
    ]


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("name", SCENES)
def test_the_library_starts_from_what_the_description_says(tmp_path, name, fmi):
    for unit, form in units_of(name, fmi=fmi, platforms=[platform_tuple]):
        path = build(unit.model, tmp_path / f"{unit.name}.fmu", **form)
        description = fmpy.read_model_description(str(path), validate=True)
        variables = {v.name: v for v in description.modelVariables}
        host = fmpy.instantiate_fmu(fmpy.extract(str(path), str(tmp_path / unit.name)), description)
        read = host.getReal if fmi == 2 else host.getFloat64
        for v in description.modelVariables:
            if v.causality in ("parameter", "input"):
                real = v.type in ("Real", "Float64")
                found = (read if real else host.getBoolean)([v.valueReference])[0]
                assert found == (float(v.start) if real else v.start == "true"), v.name
        for key, value in form["start"].items():
            assert variables[key].start in (repr(float(value)), str(value).lower()), key
        host.freeInstance()


def test_an_ssp_is_right_in_a_tool_that_reads_no_parameter_set(fmus, packaging, tmp_path):
    """The first outputs of its units, told nothing, are those of plain units told everything."""
    package = build_ssp(load_scene("two_balls"), tmp_path / "scene.ssp", platforms=[platform_tuple])
    folder = fmpy.extract(str(package), str(tmp_path / "scene"))
    for unit, form in units_of("two_balls"):
        untold = packaging.Host(f"{folder}/resources/{unit.name}.fmu").begin()
        told = packaging.Host(fmus.native(unit.model, **unit.sizes)).begin(form["start"])
        assert untold.outputs() == told.outputs()
        assert any(untold.outputs())
        untold.free()
        told.free()


def test_start_values_of_inputs_are_the_first_outputs_of_the_coupled_machine(hosted):
    start, host = start_values(load_scene("two_balls")), hosted(load_scene("two_balls"))
    for target, variable, source in (
        ("weights", "a_", "rotor.plane[1].a_"),
        ("rotor", "plane[1].F_", "weights.F_"),
    ):
        found = [start[target][f"{variable}{axis}"] for axis in ("xi", "eta")]
        assert found == pytest.approx(host.get(f"{source}xi", f"{source}eta"), rel=1e-10)
        assert all(found)


def test_files_built_for_a_scene_run_it_and_others_of_their_sizes(tmp_path):
    """Two balancers of one size have values of their own."""
    scene = load_scene("two_plane_rodrigues").replace({"run.revolutions": 1})
    for unit, form in units_of(scene.name, platforms=[platform_tuple]):
        path = build(unit.model, tmp_path / f"{unit.name}.fmu", **form)
        assert is_present_build(path, unit.model, **unit.sizes)
        assert not is_present_build(path, "LiquidBalancer")
    other = scene.replace({"run.initial.angle": 0.5})
    found, expected = cosimulate(other, fmus=tmp_path), cosimulate(other, separate=True)
    assert all((found[name] == expected[name]).all() for name in expected.signals)


@pytest.mark.parametrize("wrong", ["start=9999:3ff0000000000000", "flags=9", "begin=0"])
def test_start_values_of_no_variable_are_refused(packaging, tmp_path, wrong):
    unit, form = units_of("two_balls", platforms=[platform_tuple])[1]
    files = dict(contents(unit.model, **form))
    text = files["resources/composition.txt"].decode()
    changed = text.split(";")[0] + ";" + wrong
    files["resources/composition.txt"] = changed.encode()
    identities = identity_of(text).encode(), identity_of(changed).encode()
    files["modelDescription.xml"] = files["modelDescription.xml"].replace(*identities)
    path = written(files, tmp_path / "wrong.fmu", "wrong")
    assert "not those of variables that it has" in packaging.refusal(path)
