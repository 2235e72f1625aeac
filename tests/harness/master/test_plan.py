"""The plan of a scene: units, start values and connections; names of signals and their units."""

from __future__ import annotations

import pytest

from autobalancer.harness import Scene, bundled_scenes, load_scene
from autobalancer.harness.master.cosimulation import CoSimulation
from autobalancer.harness.master.names import readable, signals, stations
from autobalancer.harness.master.plan import Port, plan
from autobalancer.harness.master.recorder import Recorder, recorded


def shaft(**changes):
    """Three discs on a shaft, with two balancers on station 2."""
    return Scene.from_document(
        {
            "rotor": {
                "kind": "flexible",
                "stations": [0.0, 0.3, 0.7],
                "masses": [1.0, 2.0, 1.0],
                "supports": [1, 3],
                "support_stiffness": [[1e5, 2e5], [3e5, 4e5]],
                "bending_stiffness": 1e3,
                "unbalances": [{"position": 0.3, "amount": 1e-3, "angle": 0.5}],
            },
            "balancer": [
                {"kind": "balls", "at": 2, "count": 2, "mass": 0.02, "track_radius": 0.05},
                {"kind": "liquid", "at": 2, "chamber_radius": 0.05, "float_radius": 0.03,
                 "height": 0.1, "density": 1000.0, "inertia_as_force": True},
            ],
            "operation": {"speed": 300.0},
        }
    ).replace(changes)  # fmt: skip


@pytest.mark.parametrize("name", bundled_scenes())
def test_every_port_of_a_plan_is_a_variable_that_its_unit_has(name):
    from autobalancer.fmus.catalogue import sized_unit

    found = plan(load_scene(name))
    layouts = {u.name: sized_unit(u.model, **u.sizes).layout for u in found.units}
    names = {unit: {v.name: v for v in layout.variables} for unit, layout in layouts.items()}
    for unit in found.units:
        assert set(unit.start) <= set(names[unit.name])
    for target, sources in found.inputs("signal", "value", "mass").items():
        assert names[target.unit][target.variable].causality == "input"
        for source in sources:
            assert names[source.unit][source.variable].causality == "output"


def test_outputs_of_several_balancers_on_a_plane_add_up_at_its_inputs():
    wires = plan(shaft()).inputs("signal", "mass")
    assert wires[Port("rotor", "plane[1].F_xi")] == [Port("balls", "F_xi"), Port("liquid", "F_xi")]
    assert wires[Port("rotor", "plane[1].added_mass")] == [
        Port("balls", "added_mass"),
        Port("liquid", "added_mass"),
    ]
    assert wires[Port("liquid", "a_eta")] == [Port("rotor", "plane[1].a_eta")]


def test_a_liquid_that_is_carried_exchanges_mass_and_place_alone():
    found = plan(shaft(**{"liquid.inertia_as_force": False}))
    mine = [(c.kind, c.source, c.target) for c in found.connections if "liquid" in
            (c.source.unit, c.target.unit)]  # fmt: skip
    assert mine == [
        ("value", Port("rotor", "plane[1].x"), Port("liquid", "x")),
        ("value", Port("rotor", "plane[1].y"), Port("liquid", "y")),
        ("mass", Port("liquid", "added_mass"), Port("rotor", "plane[1].added_mass")),
    ]


def test_keys_of_a_scene_reach_the_parameters_they_feed():
    rotor, balls, _ = plan(shaft(**{"run.initial": {"vy": 0.2, "angle": 0.1}})).units
    assert rotor.start["support[2].stiffness_y"] == 4e5
    assert rotor.start["station[2].mass"] == 2.0
    assert rotor.start["support[2].position"] == 0.7
    assert rotor.start["plane[1].position"] == 0.3
    assert rotor.start["unbalance[1].angle"] == 0.5
    assert rotor.start["station[3].vy0"] == 0.2
    assert rotor.start["angle0"] == 0.1
    assert balls.start["weight[2].angle0"] == pytest.approx(3.14159265)
    assert balls.start["kappa"] == 1.4


def test_rotors_say_where_their_planes_supports_and_centre_of_mass_are():
    planar = load_scene("two_balls").rotor
    assert planar.stations == planar.planes == planar.support_positions == (0.0,)
    rigid = load_scene("balancing_machine").rotor
    assert rigid.stations == rigid.support_positions == (0.0, rigid.span)
    assert rigid.plane_count == len(rigid.build().planes)
    flexible = shaft().rotor
    assert flexible.mass == 4.0
    assert flexible.centre == pytest.approx((2.0 * 0.3 + 0.7) / 4.0)
    assert flexible.support_positions == (0.0, 0.7)


def test_a_rigid_rotor_without_a_centre_of_mass_has_it_in_the_middle():
    rotor = load_scene("drum").replace({"rotor.com": None}).rotor
    assert rotor.centre == rotor.span / 2.0
    assert plan(load_scene("drum").replace({"rotor.com": None})).units[0].start["com"] == (
        rotor.centre
    )


def test_corrections_go_beside_the_unbalance_there_is():
    room = shaft().rotor.with_corrections([2, 3])
    assert room.parameters == [
        ("unbalance[2].amount", "unbalance[2].angle"),
        ("unbalance[3].amount", "unbalance[3].angle"),
    ]
    changed = shaft().replace(room.changes).rotor
    assert [u.position for u in changed.unbalances] == [0.3, 0.3, 0.7]
    planar = load_scene("two_balls").replace({"rotor.unbalance_angle": 2.0}).rotor
    (present,) = planar.with_corrections([1]).present
    assert abs(present) == pytest.approx(planar.unbalance)


def test_signals_are_named_values_first_then_slopes():
    assert stations(1) == [""]
    assert stations(2) == ["station[1].", "station[2]."]
    assert signals(["F"], 3)[2:] == [
        "der(F_xi)", "der(F_eta)", "der(F_xi,2)", "der(F_eta,2)", "der(F_xi,3)", "der(F_eta,3)",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("declared", "read"),
    [("kg.m", "kg m"), ("rad/s2", "rad/s^2"), ("N.s/m", "N s/m"), ("m/s5", "m/s^5"), ("1", "1")],
)
def test_units_of_measurement_read_as_people_write_them(declared, read):
    assert readable(declared) == read


def test_records_are_measured_in_what_the_fmus_declare():
    scene = load_scene("balls_and_liquid")
    names = [*recorded(scene), "rotor.vx", "weights.der(F_xi)", "liquid.added_mass"]
    expected = {"rotor.x": "m", "weights.moment_xi": "kg m", "weights.weight[1].angle": "rad",
                "liquid.clearance": "m", "rotor.vx": "m/s", "weights.der(F_xi)": "N/s",
                "liquid.added_mass": "kg"}  # fmt: skip
    names = [name.replace("weights.", f"{scene.balancer[0].label}.") for name in names]
    with CoSimulation(scene) as cosim:
        found = Recorder(cosim.units, names).signal_units
    assert found == plan(scene).signal_units(names)
    for name, unit in expected.items():
        name = name.replace("weights.", f"{scene.balancer[0].label}.")
        assert found[name] == unit
