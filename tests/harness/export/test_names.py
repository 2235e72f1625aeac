"""A balancer's name is the same in every command, and quoted where FMI wants it."""

from __future__ import annotations

import pytest
from fmpy import platform_tuple, read_model_description, simulate_fmu
from fmpy.validation import validate_fmu

from autobalancer.harness import Scene, SceneError, UserError, cosimulate, load_scene
from autobalancer.harness.master.one_file import composition
from autobalancer.harness.show.content import content

BALLS = {"kind": "balls", "count": 2, "mass": 0.05, "track_radius": 0.2, "drag": 0.2}


def pair() -> Scene:
    """Two rings of balls on one disc, with names as people write them."""
    return Scene.from_document(
        {
            "rotor": {"kind": "planar", "mass": 8.0, "stiffness": 2e4, "damping": 80.0,
                      "unbalance": 0.02},
            "balancer": [
                {**BALLS, "name": "left-ring", "angles": [0.3, 1.7]},
                {**BALLS, "name": "right_ring", "angles": [2.3, -1.0]},
            ],
            "operation": {"speed": 150.0},
            "run": {"revolutions": 5},
        }
    )  # fmt: skip


def renamed(scene: Scene) -> Scene:
    document = scene.document
    document["balancer"][0]["name"] = "left_ring"
    return Scene.from_document(document)


def test_a_name_with_a_hyphen_runs_in_the_same_engine_to_the_same_bits():
    ours, plain = cosimulate(pair()), cosimulate(renamed(pair()))
    assert not ours.calls  # the one file, in C
    assert (ours["left-ring.weight[1].angle"] == plain["left_ring.weight[1].angle"]).all()


@pytest.mark.parametrize("fmi", [2, 3])
def test_variables_of_such_a_part_are_quoted_as_fmi_structures_names(tmp_path, fmi):
    path = pair().build(tmp_path, fmi=fmi, platforms=[platform_tuple], one_file=True).files[0]
    assert validate_fmu(str(path)) == []
    description = read_model_description(str(path))
    assert description.variableNamingConvention == "structured"
    names = [v.name for v in description.modelVariables]
    assert {"'left-ring'.drag", "'left-ring'.weight[2].angle", "der('left-ring'.F_xi)"} <= {*names}
    assert "right_ring.drag" in names
    assert not [name for name in names if "left-ring" in name.replace("'left-ring'.", "")]
    angle = "'left-ring'.weight[1].angle"
    run = simulate_fmu(
        str(path), stop_time=0.1, output=[angle], start_values={"'left-ring'.drag": 0.3}
    )
    assert run[angle][0] == 0.3
    assert run[angle][-1] != 0.3


def test_flat_names_packages_and_pages_take_such_a_name(tmp_path):
    scene = pair()
    flat = scene.build(tmp_path, platforms=[platform_tuple], one_file=True, flat=True).files[0]
    names = [v.name for v in read_model_description(str(flat)).modelVariables]
    assert "left_ring_weight_1_angle" in names
    scene.build(tmp_path / "one.ssp", platforms=[platform_tuple], one_file=True, ssp=True)
    assert content(scene)
    files = scene.build(tmp_path / "units", platforms=[platform_tuple]).files
    assert [path.name for path in files] == ["rotor.fmu", "left-ring.fmu", "right_ring.fmu"]


def test_the_longest_name_fits_into_every_description_and_a_longer_one_is_refused():
    document = pair().document
    for length, refused in ((32, False), (33, True)):
        document["balancer"][0] |= {"name": "a-" * (length // 2) + "b" * (length % 2)}
        if refused:
            with pytest.raises(SceneError, match=r"name = .*only, at most 32"):
                Scene.from_document(document)
            continue
        scene = Scene.from_document(document)
        said = composition(scene).described("one")
        # as many weights as a track may have: the longest index there is
        many = {v.name.replace("weight[2]", "weight[10000]") for v in said.shown}
        many |= {f"der({name})" for name in said.states}
        assert max(len(said.label(name)) for name in many) <= 63


def test_a_change_of_engine_is_said_with_its_reason():
    scene = load_scene("two_balls").replace({"run.revolutions": 1})
    python = {"coupling.units": "python"}
    run = cosimulate(scene.replace(python))
    assert run.calls
    assert "separate FMUs ran, coupled in Python" in run.events[0]
    assert "coupling.units" in run.events[0]
    assert not [event for event in cosimulate(scene).events if "separate FMUs ran" in event]
    asked = cosimulate(scene.replace(python), separate=True)
    assert not [event for event in asked.events if "separate FMUs ran" in event]


@pytest.mark.parametrize(
    ("name", "form", "message"),
    [
        ("two.fmu", {"ssp": True}, r"two\.fmu: must be a folder, or a file that ends in \.ssp"),
        ("two.ssp", {"one_file": True}, r"two\.ssp: .* or a file that ends in \.fmu"),
        ("two.fmu", {}, r"two\.fmu: must be a folder; --one-file writes an FMU"),
    ],
)
def test_a_file_named_for_another_kind_is_refused(tmp_path, name, form, message):
    with pytest.raises(UserError, match=message):
        load_scene("two_balls").build(tmp_path / name, **form)
    assert not list(tmp_path.iterdir())


def test_one_file_can_be_named(tmp_path):
    built = load_scene("two_balls").build(
        tmp_path / "mine.fmu", one_file=True, platforms=[platform_tuple]
    )
    assert built.files == (tmp_path / "mine.fmu",)
    assert built.files[0].is_file()
