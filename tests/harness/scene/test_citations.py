"""What `cite` names: the program, and what a scene's run uses, each with its reason."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import autobalancer as ab
from autobalancer.harness import load_scene
from autobalancer.harness.scene.citations import program

CFF = Path(__file__).parents[3] / "CITATION.cff"


def cited(name, separate=False, **changes):
    """Reasons by the keys of the entries below them."""
    scene = load_scene(name).replace({k.replace("__", "."): v for k, v in changes.items()})
    text = scene.cite(separate=separate)
    found = re.findall(r"^% (.+)\n@\w+\{([^,]+),", text, re.MULTILINE)
    return {key: reason for reason, key in found}


def test_the_program_is_cited_as_its_citation_file_says():
    said = dict(
        re.findall(r"^(title|version|license): (.+)$", CFF.read_text("utf-8"), re.MULTILINE)
    )
    author = re.search(r"authors:\n  - name: (.+)", CFF.read_text("utf-8"))[1]
    fields = program().fields
    assert (fields["title"], fields["version"]) == (said["title"], said["version"])
    assert fields["author"] == f"{{{author}}}"
    assert said["license"] in fields["note"]


@pytest.mark.parametrize(
    ("name", "used", "unused"),
    [
        ("two_balls", {"Filimonikhina2017"}, {"Dubovik2006", "Sicklinger2014", "Goncharov2017"}),
        ("liquid_closed", {"Dubovik2006", "Jorba2005"}, {"Filimonikhina2017", "Schierz2012"}),
        ("washing_machine", {"Jorba2005", "Moreau1988", "Goncharov2017"}, {"Hairer1996"}),
    ],
)
def test_what_a_scene_does_not_use_is_not_cited(name, used, unused):
    keys = set(cited(name))
    assert used | {"autobalancer"} <= keys
    assert not keys & unused


def test_a_rotor_by_its_matrices_cites_no_equations_of_a_paper():
    matrices = {"kind": "matrices", "mass_matrix": [[2.0]], "stiffness_matrix": [[200.0]]}
    document = load_scene("two_balls").document
    scene = ab.Scene.from_document({**document, "source": "", "rotor": matrices, "check": []})
    found = re.findall(r"^@\w+\{([^,]+),", scene.cite(), re.MULTILINE)
    assert {"autobalancer", "Filimonikhina2017", "Jorba2005"} == set(found)  # its balls' equations


def test_every_entry_says_what_it_is_cited_for():
    for name in ("bristol", "two_balls", "washing_machine"):
        text = load_scene(name).cite()
        assert len(cited(name)) == len(re.findall(r"^@", text, re.MULTILINE))


def test_another_scheme_cites_its_own_papers():
    keys = set(cited("two_balls", separate=True, coupling__scheme="compensated"))
    assert {"Benedikt2013", "Sicklinger2014"} <= keys
    assert "Broyden1965" not in keys


@pytest.mark.parametrize(
    "coupling", [{"coupling__tolerance": 1e-4}, {"coupling__scheme": "compensated"}]
)
def test_a_machine_in_one_piece_cites_no_coupling(coupling):
    keys = set(cited("two_balls", **coupling))
    assert "Jorba2005" in keys
    assert not keys & {"Broyden1965", "Schierz2012", "Hairer1993"}


@pytest.mark.parametrize(("drag", "is_stiff"), [(0.02, False), (200.0, True)])
def test_collocation_is_cited_where_a_run_tries_such_steps_and_nothing_runs(
    drag, is_stiff, monkeypatch
):
    def refused(*_args):
        raise AssertionError("a run of the scene")

    monkeypatch.setattr("autobalancer.fmus.composite.run.Run.on", refused)
    keys = set(cited("two_balls", weights__drag=drag))
    assert ("Hairer1996" in keys) == is_stiff


@pytest.mark.parametrize(("damping", "may"), [(0.0, False), (5.0, True)])
def test_collocation_is_cited_where_a_whirl_may_make_the_machine_stiff(damping, may):
    """Internal damping turns a motor's shaft with a large whirl; at the start it is not stiff."""
    scene = ab.Scene(
        rotor={"kind": "planar", "mass": 8.0, "stiffness": 20e3, "damping": 80.0,
               "internal_damping": damping, "unbalance": 0.02},
        operation={"motor": {"inertia": 0.2, "stall_torque": 1.2, "no_load_speed": 300.0}},
        run={"revolutions": 20},
    )  # fmt: skip
    assert ("Hairer1996" in scene.cite()) == may
