"""Forces of supports and feet as outputs, against closed forms of machines in a steady motion."""

from __future__ import annotations

import math

import numpy as np
import pytest
from fmpy import platform_tuple, simulate_fmu

import autobalancer as ab
from autobalancer.harness.master.plan import plan
from autobalancer.models.papers.influence import influence
from tests.native.packaging import Host, Units

# a rotor on a body on one foot: unbalance .01 kg m, speed -> force on the floor [N]
TUB = {
    "kind": "planar", "mass": 10.0, "stiffness": 4e4, "damping": 40.0, "unbalance": 0.01,
    "on": "tub",
    "bodies": [{"name": "tub", "mass": 30.0, "feet": [{"stiffness": 6e4, "damping": 200.0}]}],
}  # fmt: skip
FLOOR = {20.0: 6.10988294, 40.0: 94.72469955, 80.0: 138.15027743, 200.0: 2.97891371}


def floor_force(speed: float) -> complex:
    """Of `TUB` by the closed form of two bodies in a row, 0-peak [N]."""
    k1, c1, k2, c2, m1, m2 = 4e4, 40.0, 6e4, 200.0, 10.0, 30.0
    first, w = k1 + 1j * c1 * speed, speed
    second = first + k2 + 1j * c2 * w - m2 * w * w
    moved = 0.01 * w * w * first / ((first - m1 * w * w) * second - first**2)
    return (k2 + 1j * c2 * w) * moved


def tub(speed: float) -> ab.Scene:
    return ab.Scene(rotor=TUB, speed=speed, run={"duration": 12.0})


def largest_at_end(time, x, y, speed):
    late = time > time[-1] - 4.0 * math.tau / speed
    return np.hypot(x, y)[late].max()


@pytest.mark.parametrize("speed", FLOOR)
def test_the_foot_of_a_tub_feels_the_force_of_the_closed_form(speed):
    assert abs(floor_force(speed)) == pytest.approx(FLOOR[speed], abs=5e-9)
    scene = tub(speed).replace({"coupling.tolerance": 1e-6})
    run = scene.run(record=["rotor.foot[1].force_x", "rotor.foot[1].force_y"])
    x, y = (run[f"rotor.foot[1].force_{axis}"] for axis in "xy")
    assert largest_at_end(run.time, x, y, speed) == pytest.approx(FLOOR[speed], rel=2e-6)
    angle = speed * run.time[-1]
    right = floor_force(speed) * np.exp(1j * angle)
    assert complex(x[-1], y[-1]) == pytest.approx(right, rel=2e-6)


@pytest.mark.parametrize("form", ["separate", "python"])
def test_separate_units_feel_the_same_force(form):
    scene = tub(40.0).replace({"coupling.units": "python" if form == "python" else "native"})
    run = scene.run(record=["rotor.foot[1].force_x", "rotor.foot[1].force_y"], separate=True)
    x, y = (run[f"rotor.foot[1].force_{axis}"] for axis in "xy")
    assert largest_at_end(run.time, x, y, 40.0) == pytest.approx(FLOOR[40.0], rel=1e-5)


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("interface", ["CoSimulation", "ModelExchange"])
def test_the_fmu_of_a_scene_has_the_force_of_its_foot(tmp_path, fmi, interface):
    built = tub(40.0).build(tmp_path, one_file=True, fmi=fmi, platforms=[platform_tuple])
    [fmu] = [path for path in built.files if path.suffix == ".fmu"]
    names = ["rotor.foot[1].force_x", "rotor.foot[1].force_y"]
    found = simulate_fmu(
        str(fmu), stop_time=12.0, fmi_type=interface, output=names, output_interval=0.01,
        relative_tolerance=1e-7,
    )  # fmt: skip
    size = largest_at_end(found["time"], found[names[0]], found[names[1]], 40.0)
    assert size == pytest.approx(FLOOR[40.0], rel=1e-3)


def test_a_system_of_separate_units_has_the_force_of_its_foot(tmp_path):
    tub(40.0).build(tmp_path / "tub.ssp", ssp=True, platforms=[platform_tuple])
    run = ab.load_system(tmp_path / "tub.ssp").run(
        record=["rotor.foot[1].force_x", "rotor.foot[1].force_y"]
    )
    x, y = (run[f"rotor.foot[1].force_{axis}"] for axis in "xy")
    assert largest_at_end(run.time, x, y, 40.0) == pytest.approx(FLOOR[40.0], rel=1e-3)


def tilting_tub() -> ab.Scene:
    """Rotor of 12 kg on two springs of 5e4 N/m in a tub of 30 kg on feet of 2e4 N/m, undamped."""
    foot = {"stiffness": 2e4}
    rotor = {
        "kind": "two_support", "mass": 12.0, "inertia": 0.5, "polar_inertia": 0.3, "span": 0.4,
        "stiffness": [5e4, 5e4], "planes": [0.3], "on": "tub",
        "unbalances": [{"position": 0.3, "amount": 2e-3}],
        "bodies": [{
            "name": "tub", "mass": 30.0, "transverse_inertia": 1.2, "center": 0.2,
            "feet": [foot | {"position": z} for z in (0.0, 0.4)],
        }],
    }  # fmt: skip
    return ab.Scene(rotor=rotor, speed=150.0)


def test_the_feet_of_a_tilting_tub_feel_the_closed_form():
    """Unbalance .1 m from the middle at 150 rad/s: 14.69670307 and 12.47310825 N."""
    scene = tilting_tub()
    forces = {row[0]: row[1] for row in scene.rotor().forces().rows}
    assert forces["tub.foot[1]"] == pytest.approx(14.69670307, abs=5e-9)
    assert forces["tub.foot[2]"] == pytest.approx(12.47310825, abs=5e-9)


def test_the_unit_of_a_tilting_tub_in_its_steady_motion_has_these_forces(tmp_path):
    """The steady motion of the closed form is the start: undamped, nothing else ever dies."""
    scene = tilting_tub()
    unit = plan(scene).units[0]
    rotor = scene.assembly().rotor
    motion = influence(rotor, 150.0, np.eye(4)) @ rotor.unbalance
    start = dict(unit.start)
    for axis, row in zip("xy", motion, strict=True):
        for j, z in enumerate(row.tolist(), 1):
            start[f"station[{j}].{axis}0"] = z.real
            start[f"station[{j}].v{axis}0"] = (150j * z).real
    host = Host(Units(tmp_path).native(unit.model, **unit.sizes))
    host.begin(start | {"speed": 150.0})
    host.run(7, 1e-2)
    for number, size in ((1, 14.69670307), (2, 12.47310825)):
        force = host.get(*(f"foot[{number}].force_{axis}" for axis in "xy"))
        assert np.hypot(*force) == pytest.approx(size, abs=1e-8)


@pytest.mark.parametrize("separate", [False, True])
def test_dry_friction_is_in_the_force_of_its_support(separate):
    slider = {"limit": [2.0, 3.0], "stiffness": [1e5, 1e5]}
    rotor = {"kind": "planar", "mass": 10.0, "stiffness": [4e4, 5e4], "damping": [40.0, 20.0]}
    rotor |= {"unbalance": 2e-3, "friction": [slider]}
    scene = ab.Scene(rotor=rotor, speed=90.0, run={"revolutions": 5})
    names = [*("x", "y", "vx", "vy"), *(f"slider[1].force_{axis}" for axis in "xy")]
    names += ["support[1].force_x", "support[1].force_y"]
    run = scene.run(record=[f"rotor.{name}" for name in names], separate=separate)
    x, y, vx, vy, held_x, held_y, force_x, force_y = (run[f"rotor.{name}"] for name in names)
    assert np.abs(held_x).max() == pytest.approx(2.0, rel=1e-9)
    assert force_x == pytest.approx(4e4 * x + 40.0 * vx - held_x, abs=1e-9)
    assert force_y == pytest.approx(5e4 * y + 20.0 * vy - held_y, abs=1e-9)


@pytest.mark.parametrize("separate", [False, True])
def test_the_force_of_a_bearing_over_the_speed_follows_its_table(separate):
    rows = [[50.0, 1e5, 2e3, -1e3, 9e4, 60.0, 1.0, 2.0, 50.0]]
    rows += [[150.0, 3e5, 6e3, -5e3, 2e5, 20.0, 3.0, 4.0, 90.0]]
    rotor = {"kind": "planar", "mass": 10.0, "unbalance": 2e-3, "bearings": [{"table": rows}]}
    drive = {"profile": [[0.0, 60.0], [1.0, 140.0]]}
    names = ["x", "y", "vx", "vy", "support[1].force_x", "support[1].force_y"]
    scene = ab.Scene(rotor=rotor, operation=drive)
    run = scene.run(record=[f"rotor.{name}" for name in names], separate=separate)
    x, y, vx, vy, force_x, force_y = (run[f"rotor.{name}"] for name in names)
    part = (60.0 + 80.0 * run.time - 50.0) / 100.0
    k_xx, k_xy, k_yx, k_yy, c_xx, c_xy, c_yx, c_yy = (
        begin + part * (end - begin) for begin, end in zip(rows[0][1:], rows[1][1:], strict=True)
    )
    assert force_x == pytest.approx(k_xx * x + k_xy * y + c_xx * vx + c_xy * vy, abs=1e-9)
    assert force_y == pytest.approx(k_yx * x + k_yy * y + c_yx * vx + c_yy * vy, abs=1e-9)


@pytest.mark.parametrize("amount", [0.0, 1e-3])
def test_a_couple_and_a_rotor_without_unbalance_have_no_transmissibility(amount):
    drum = ab.load("drum")
    pair = [
        {"position": place, "amount": amount, "angle": angle}
        for place, angle in zip(drum.rotor.planes, (0.3, 0.3 + math.pi), strict=True)
    ]
    sheet = drum.replace({"rotor.unbalances": pair}).rotor().forces()
    assert [row[2] for row in sheet.rows] == ["", ""]
