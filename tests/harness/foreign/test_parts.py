"""Parts of a scene that are FMUs of others: the rotor, balancers, and units beside them."""

from __future__ import annotations

import re
import zipfile

import numpy as np
import pytest
from fmpy import platform_tuple
from scipy.interpolate import CubicSpline

import autobalancer as ab

SHORT = {"run.revolutions": 2}
SHOWN = ("rotor.x", "rotor.y", "weights.weight[1].angle")


@pytest.fixture(scope="module")
def native():
    """The two-ball scene with our own rotor, in fine steps."""
    return ab.load("two_balls").replace({**SHORT, "coupling.steps_per_rev": 400}).run()


@pytest.fixture(scope="module")
def with_their_rotor(guest):
    scene = ab.load("two_balls").replace({**SHORT, "rotor.fmu": str(guest("turning_rotor"))})
    return lambda **coupling: scene.replace({f"coupling.{k}": v for k, v in coupling.items()})


def error(result, native):
    """Of displacements, relative to the largest one."""
    largest = max(np.abs(native[name]).max() for name in SHOWN[:2])
    return max(
        np.abs(result[name] - CubicSpline(native.time, native[name])(result.time)).max() / largest
        for name in SHOWN[:2]
    )


def test_a_rotor_of_others_with_our_balls_errs_by_the_square_of_the_step(with_their_rotor, native):
    coarse, fine = (
        error(with_their_rotor(steps_per_rev=n).run(record=SHOWN), native) for n in (20, 80)
    )
    assert coarse < 1e-3
    assert fine < coarse / 12.0  # 16 by order 2


def test_a_rotor_of_others_keeps_a_tolerance(with_their_rotor, native):
    result = with_their_rotor(tolerance=1e-4).run(record=SHOWN)
    assert error(result, native) < 3.0 * result.estimated_error
    assert result.estimated_error < 1e-4


def test_what_is_not_known_of_a_part_is_said(with_their_rotor):
    result = with_their_rotor(steps_per_rev=20).run(record=["rotor.x"])
    said = " ".join(result.events)
    assert "TurningRotor.fmu is not of this installation: its equations" in said
    assert "TurningRotor.fmu" in result.units
    assert "are not known" in str(result.summary())


def test_values_that_a_part_does_not_have_are_named(with_their_rotor):
    scene = with_their_rotor(steps_per_rev=20).replace({"rotor.internal_damping": 0.5})
    said = " ".join(scene.run(record=["rotor.x"]).events)
    assert "it has no internal_damping = 0.5" in said


def test_theory_is_refused_where_equations_are_not_known(with_their_rotor):
    scene = with_their_rotor(steps_per_rev=20)
    with pytest.raises(
        ab.SceneError, match=r"rotor \(TurningRotor\.fmu\): this requires equations"
    ):
        scene.speeds(1.0, 10.0)


def test_a_part_without_a_port_is_refused_with_what_it_has(guest):
    scene = ab.load("two_balls").replace({**SHORT, "rotor.fmu": str(guest("mass"))})
    with pytest.raises(
        ab.UnitError, match=r"Mass\.fmu has no variable 'plane\[1\]\.a_xi'.*it has: m"
    ):
        scene.run()


def test_a_file_that_is_missing_is_named_with_the_key_of_the_scene(guest, tmp_path):
    part = ab.load("two_balls").replace({"rotor.fmu": "none.fmu"})
    with pytest.raises(ab.UnitError, match=r"^two_balls: rotor\.fmu: none\.fmu: no such file"):
        part.run()
    path = tmp_path / "system.toml"
    unit = '[[unit]]\nname = "{}"\nfmu = "{}"\n'
    units = unit.format("mass", guest("mass")) + unit.format("spring", "none.fmu")
    path.write_text(f"run.duration = 1.0\n{units}", encoding="utf-8")
    with pytest.raises(ab.UnitError, match=r"system\.toml: unit\[2\]\.fmu: .*none\.fmu: no such"):
        ab.load_system(path).run()
    broken = tmp_path / "Mass.fmu"
    with zipfile.ZipFile(guest("mass")) as whole, zipfile.ZipFile(broken, "w") as archive:
        for name in whole.namelist():
            if not name.startswith("binaries/"):
                archive.writestr(name, whole.read(name))
    with pytest.raises(ab.UnitError, match=rf"^{re.escape(str(broken))}") as said:
        ab.load_system(broken).run()
    assert "unit[1].fmu" not in str(said.value)  # no scene names it
    beside = ab.load("two_balls").document | {"unit": [{"name": "spring", "fmu": "none.fmu"}]}
    with pytest.raises(ab.UnitError, match=r": unit\[1\]\.fmu: none\.fmu: no such file; give"):
        ab.Scene.from_document(beside).run()


def test_fmus_of_fmi_3_of_this_installation_run_as_parts(tmp_path):
    scene = ab.load("two_balls").replace({**SHORT, "coupling.steps_per_rev": 40})
    scene.build(tmp_path, fmi=3, platforms=[platform_tuple])
    result = scene.run(fmus=tmp_path, record=SHOWN)
    expected = scene.run(separate=True, record=SHOWN)
    assert error(result, expected) < 1e-6  # of the motion: one pass here, iterated there
    assert "rotor.fmu is not of this installation (of FMI 3.0)" in " ".join(result.events)


def test_a_unit_beside_the_rotor_follows_it(guest):
    """A sensor on a spring: its force is that of the rotor's displacement."""
    scene = ab.load("two_balls").replace({**SHORT, "coupling.steps_per_rev": 40})
    document = scene.document | {
        "unit": [{"name": "sensor", "fmu": str(guest("spring")), "start": {"c": 0.0}}],
        "connection": [{"from": "rotor.x", "to": "sensor.x2"}],
    }
    watched = ab.Scene.from_document(document)
    result = watched.run(record=["rotor.x", "sensor.F"])
    force, right = result["sensor.F"], 5.0 * result["rotor.x"]
    assert result["rotor.x"][0] == 0.0
    np.testing.assert_allclose(force, right, rtol=1e-9, atol=1e-12 * np.abs(right).max())
    alone = scene.run(separate=True, record=["rotor.x"])
    np.testing.assert_allclose(result["rotor.x"], alone["rotor.x"], atol=1e-7)  # of 0.05 m


def test_a_second_source_of_a_fed_input_is_refused_unless_a_sum_is_meant(guest):
    document = ab.load("two_balls").replace(SHORT).document | {
        "unit": [{"name": "sensor", "fmu": str(guest("spring"))}],
        "connection": [{"from": "sensor.F", "to": "rotor.plane[1].F_xi"}],
    }
    with pytest.raises(ab.UnitError, match=r"has a source already, weights\.F_xi; give add = true"):
        ab.Scene.from_document(document).run()
