"""The virtual balancing machine against Polushkin's closed forms and the ISO grades."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from autobalancer.harness import Scene, SceneError, SimulationError, load_scene
from autobalancer.harness.balancing.cycles import balance, support_levers
from autobalancer.harness.balancing.machine import Machine
from autobalancer.harness.scene.grade import permissible
from autobalancer.harness.stability.revolution import Revolution
from autobalancer.models.linear.synchronous import synchronous
from tests.studies.papers import (
    balancing_cycles,
    inverse_dynamic_stiffness,
    left_plane,
    right_plane,
)

STIFFNESS, DAMPING = ((3e4, 2e5), (3.4e4, 1e5)), ((250.0, 300.0), (200.0, 150.0))
MASS, INERTIA, SPAN, LEFT, RIGHT = 14.0, 1.9, 1.1, 0.08, -0.05


def machine(speed=58.0, rotor=None, **balancing):
    """Polushkin's rotor: centre of mass in the middle, no polar inertia; right plane overhung."""
    return Scene.from_document(
        {
            "rotor": {
                "kind": "two_support",
                "mass": MASS,
                "inertia": INERTIA,
                "span": SPAN,
                "stiffness": [list(pair) for pair in STIFFNESS],
                "damping": [list(pair) for pair in DAMPING],
                "planes": [LEFT, SPAN - RIGHT],
                "unbalances": [
                    {"position": 0.2, "amount": 6e-3, "angle": 0.3},
                    {"position": 0.9, "amount": 5e-3, "angle": 2.4},
                ],
                **(rotor or {}),
            },
            "operation": {"speed": speed},
            "balancing": {"grade": "G16", "service_speed": 314.0, **balancing},
        }
    )


def closed_forms(speed, axis):
    """(15), (17): K of x = Re(K D e^{i w t}), that of y a quarter turn later."""
    k, c = ([pair[axis] for pair in values] for values in (STIFFNESS, DAMPING))
    inverse = inverse_dynamic_stiffness(MASS, INERTIA, SPAN, k, c, speed)
    columns = [left_plane(inverse, SPAN, speed, LEFT), right_plane(inverse, SPAN, speed, RIGHT)]
    return np.column_stack(columns) * (1.0, -1j)[axis]


@pytest.mark.parametrize("axis", ["x", "y"])
@pytest.mark.parametrize("speed", [20.0, 95.0, 400.0])
def test_measured_coefficients_are_the_papers_closed_forms(speed, axis):
    """Below, between and above the resonances; one plane overhung."""
    result = balance(machine(speed, axis=axis, technology="complex"))
    np.testing.assert_allclose(result.measured, closed_forms(speed, "xy".index(axis)), rtol=1e-6)
    assert result.difference < 1e-6


def scenes():
    yield "bundled", load_scene("balancing_machine")
    yield "overhung", machine(95.0)
    yield "gyroscopic", machine(120.0, rotor={"polar_inertia": 2.5, "com": 0.3})
    grinder = load_scene("grinder").model_dump(by_alias=True, exclude_none=True)
    shaft = {key: grinder[key] for key in ("rotor", "operation")}
    table = {"grade": "G2.5", "planes": [2, 4]}
    yield "flexible", Scene.from_document({**shaft, "balancing": table})
    disc = {"kind": "planar", "mass": 2.0, "stiffness": [8e4, 6e4], "damping": 40.0,
            "unbalance": 3e-3, "unbalance_angle": 1.0}  # fmt: skip
    yield (
        "planar",
        Scene.from_document(
            {"rotor": disc, "operation": {"speed": 150.0}, "balancing": {"grade": "G2.5"}}
        ),
    )


@pytest.mark.parametrize("scene", [pytest.param(s, id=name) for name, s in scenes()])
def test_complex_coefficients_without_noise_need_two_cycles(scene):
    result = balance(scene.replace({"balancing.technology": "complex"}))
    (technology,) = result.technologies
    assert technology.meets
    assert technology.actually_met
    assert len(technology.cycles) == 2
    assert result.difference < 1e-6
    first, last = technology.cycles
    assert np.any(first.actual_at_supports > result.at_supports)
    assert last.actual_at_supports.max() < 1e-6 * first.actual_at_supports.max()


def test_a_rotor_within_its_grade_needs_one_cycle():
    result = balance(load_scene("balancing_machine").replace({"balancing.grade": "G4000"}))
    for technology in result.technologies:
        assert len(technology.cycles) == 1
        assert technology.actually_met
        assert not technology.cycles[0].mounted.any()


def test_scalar_technology_takes_five_cycles_where_the_complex_one_takes_two():
    """Polushkin 2016, conclusion: 5 and 2, control run included, at the same permissible values."""
    result = balance(load_scene("balancing_machine"))
    cycles = {t.name: len(t.cycles) for t in result.technologies}
    assert cycles == {"complex": 2, "scalar": 5}
    assert all(t.actually_met for t in result.technologies)
    # the same by arithmetic alone, without a machine
    scalar = result.technologies[1]
    start = scalar.cycles[0].actual
    plain = balancing_cycles(result.analytic, scalar.coefficients, start, 0.0, most=5)
    for cycle, unbalance in zip(scalar.cycles, plain, strict=True):
        np.testing.assert_allclose(cycle.actual, unbalance, rtol=1e-9, atol=1e-15)


def test_scalar_technology_converges_only_where_its_residual_map_contracts():
    """Spectral radius below and above 1: the grade is met, or the technology given up."""
    for speed, contracts in ((40.0, True), (95.0, False)):
        result = balance(machine(speed, technology="scalar"))
        (technology,) = result.technologies
        # the unbalance after a correction by that before it, D - used^-1 (true D)
        matrix = np.eye(2) - np.linalg.pinv(technology.coefficients) @ result.analytic
        assert (np.abs(np.linalg.eigvals(matrix)).max() < 1.0) == contracts
        assert technology.actually_met == contracts
        if not contracts:
            assert len(technology.cycles) == 20
            assert technology.note == "grade not met after 20 cycles"


def test_permissible_unbalance_is_the_iso_one():
    """ISO 21940-11: U_per = m e_per, e_per = 6.3 mm/s / w; shares by the lever within limits."""

    def shares(com, **rotor):
        scene = machine(rotor={"com": com, **rotor}, grade="G6.3", service_speed=300.0)
        return permissible(scene, scene.balancing)

    total, parts = shares(0.44)
    assert total == pytest.approx(14.0 * 6.3e-3 / 300.0, rel=1e-12)
    assert parts == pytest.approx(np.array([0.6, 0.4]) * total)
    assert shares(0.11)[1] == pytest.approx(np.array([0.7, 0.3]) * total)
    assert shares(1.1 * 1.2)[1] == pytest.approx(np.array([0.3, 1.2]) * total)
    assert shares(1.1 * 1.6)[1] == pytest.approx(np.array([0.6, 1.3]) * total)


def test_unbalance_moves_to_the_supports_by_the_lever():
    levers = support_levers(machine(), [1, 2])
    places = np.array([LEFT, SPAN - RIGHT])
    assert levers.sum(axis=0) == pytest.approx([1.0, 1.0])
    assert levers[1] * SPAN == pytest.approx(places)  # the moment about support 1


def test_synchronous_part_is_found_among_other_vibration():
    """Other whole harmonics and an offset are orthogonal over whole revolutions."""
    angle = 2.0 * math.pi * np.arange(320) / 40
    amplitude = np.array([2.0 - 1.0j, 0.3j])
    samples = np.real(amplitude[:, None] * np.exp(1j * angle)) + 0.7
    samples += 0.5 * np.cos(2.0 * angle + 0.3)
    np.testing.assert_allclose(synchronous(angle, samples), amplitude, rtol=1e-12)


def test_machine_reaches_steady_state_from_any_transient():
    """The fixed point is what hundreds of revolutions from rest end in."""
    scene = load_scene("balancing_machine")
    with Machine(scene) as machine:
        steady = machine.measure(np.zeros(2))
    with Revolution(scene.without_balancers()) as units:
        outputs = ["angle", "station[1].x", "station[2].x"]
        rest = np.zeros(len(units.states))
        table = units.record(rest, scene.operation.speed, outputs, revolutions=158)
    late = table[-8 * units.steps :]
    waited = synchronous(late[:, 0], late[:, 1:].T)
    np.testing.assert_allclose(steady, waited, rtol=1e-8)


def test_planes_that_the_supports_do_not_tell_apart_are_refused():
    alike = load_scene("balancing_machine").replace({"rotor.planes": [0.3, 0.3]})
    with pytest.raises(SceneError, match="of rank 1 for 2 planes: move a plane or a sensor"):
        balance(alike)


def test_unstable_rotor_is_refused():
    """Internal damping beyond Dubovik's limit w^* = (1 + chi/p) sqrt(c/m): nothing is steady."""
    disc = {"kind": "planar", "mass": 2.0, "stiffness": 8e4, "damping": 4.0,
            "internal_damping": 40.0, "unbalance": 1e-3}  # fmt: skip
    for factor, stable in ((0.99, True), (1.01, False)):
        scene = Scene.from_document(
            {
                "rotor": disc,
                "operation": {"speed": factor * 1.1 * 200.0},
                "balancing": {"grade": "G2.5", "technology": "complex"},
            }
        )
        if stable:
            assert balance(scene).technologies[0].actually_met
        else:
            with pytest.raises(SimulationError, match=r"not stable at 222.2 rad/s: free vibration"):
                balance(scene)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"grade": "2.5"}, r'balancing.grade = "2.5": must be "G" and a number of mm/s'),
        ({"grade": "G0"}, r'balancing.grade = "G0": must be "G" and a number of mm/s above 0'),
        ({"planes": [1, 3]}, r"balancing.planes = \[1, 3\]: must be planes of the rotor, 1 to 2"),
        ({"planes": [2, 2]}, r"balancing.planes = \[2, 2\]: must all be different"),
        ({"planes": [2]}, r"balancing.planes = \[2\]: must be 2 of the rotor's 2 planes"),
        ({"planes": []}, r"balancing.planes = \[\]: must have at least 1 value"),
    ],
)
def test_mistakes_in_the_table_are_named(changes, message):
    with pytest.raises(SceneError, match=message):
        machine(**changes)


def test_grade_is_required_and_a_scene_without_the_table_says_what_to_add():
    document = machine().model_dump(by_alias=True, exclude_none=True)
    document["balancing"].pop("grade")
    with pytest.raises(SceneError, match=r"balancing.grade: missing"):
        Scene.from_document(document)
    with pytest.raises(SceneError, match=r'no table \[balancing\]; .* grade = "G2.5"'):
        balance(load_scene("drum"))


def test_command_prints_cycles_and_writes_json_and_picture(invoke, tmp_path):
    picture, data = tmp_path / "b.png", tmp_path / "b.json"
    arguments = ["balance", "balancing_machine", "-o", str(picture), "--json", str(data)]
    done = invoke(*arguments)
    assert done.exit_code == 0, done.output
    assert "Grade met after 2 cycles" in done.output
    assert "Grade met after 5 cycles" in done.output
    found = json.loads(data.read_text())
    assert [len(t["cycles"]) for t in found["technologies"]] == [2, 5]
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_command_fails_when_a_technology_does_not_meet_the_grade(invoke, tmp_path):
    arguments = ["balance", "balancing_machine", "--set", "operation.speed=95.0"]
    done = invoke(*arguments)
    assert done.exit_code == 1
    assert "Not balanced: grade not met after 20 cycles." in done.output
    wrong = invoke("balance", "drum")
    assert wrong.exit_code == 2
    assert "Traceback" not in wrong.output
