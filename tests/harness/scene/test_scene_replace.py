"""Laws of `Scene.replace`, for any values in any of a scene's tables."""

from __future__ import annotations

import copy
import re

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from autobalancer.harness import Scene, load_scene
from autobalancer.harness.errors import SceneError
from autobalancer.harness.scene.run import UNCORRECTED

SCENE = load_scene("two_balls")

SIZE = st.floats(0.01, 100.0)
RIGHT = {
    "rotor.mass": SIZE,
    "rotor.unbalance": st.floats(0.0, 1.0),
    "rotor.stiffness[2]": SIZE,
    "rotor.damping": st.tuples(SIZE, SIZE),
    "weights.drag": st.floats(0.0, 10.0),
    "weights.angles[1]": st.floats(-10.0, 10.0),
    "weights.speeds": st.none() | st.tuples(SIZE, SIZE),
    "weights.inertia_as_force": st.booleans(),
    "operation.speed": SIZE,
    "coupling.scheme": st.sampled_from(["auto", "iterated", "jacobi"]),
    "coupling.steps_per_rev": st.integers(4, 1000),
    "coupling.tolerance": st.floats(1e-9, 0.1),
    "coupling.corrections": st.none() | st.integers(0, 100),
    "run.revolutions": SIZE,
    "run.record": st.none() | st.lists(st.sampled_from(["rotor.x", "rotor.y"]), max_size=3),
    "run.initial.vx": st.floats(-5.0, 5.0),
}
RIVALS = [  # some of their values mean nothing beside each other
    {"coupling.steps_per_rev", "coupling.tolerance"},
    {"coupling.corrections", "coupling.tolerance"},
    {"coupling.corrections", "coupling.scheme"},
]
WRONG = {
    "rotor.mass": -1.0,
    "rotor.stiffness[3]": 1.0,
    "rotor.mas": 1.0,
    "weights.count": 2.5,
    "weights.angles": [0.0],
    "operation.speed": None,
    "coupling.order": 2,
    "run.initial": 3,
    "nothing.at_all": 1.0,
}

change = st.sampled_from(sorted(RIGHT)).flatmap(
    lambda path: RIGHT[path].map(lambda value: (path, value))
)
law = settings(database=None, max_examples=60)


def read(scene, path):
    """The value at a path, by attributes and elements."""
    value = scene.balancer[0] if path.startswith("weights") else scene
    keys = path.removeprefix("weights.")
    for key, number in re.findall(r"([a-z_]+)(?:\[(\d+)\])?", keys):
        value = getattr(value, key)
        value = value[int(number) - 1] if number else value
    return value


def settled(path, value):
    """What a value becomes: lists are tuples, and an absent one its default."""
    defaults = {"weights.speeds": (0.0, 0.0)}
    return defaults.get(path) if value is None else tuple(value) if type(value) is list else value


@law
@given(change)
def test_a_scene_made_from_its_tables_or_objects_takes_changes_like_that_of_a_file(item):
    tables, changed = SCENE.document, SCENE.replace(dict([item])).model_dump()
    objects = {key: getattr(SCENE, key) for key in tables}
    for made in (Scene(**tables), Scene(**objects)):
        assert made.model_dump() == SCENE.model_dump()
        assert made.replace(dict([item])).model_dump() == changed


@law
@given(change)
def test_what_is_put_in_is_read_back(item):
    path, value = item
    assert read(SCENE.replace({path: value}), path) == settled(path, value)


@law
@given(st.data(), st.sampled_from(sorted(RIGHT)))
def test_the_last_of_two_values_wins(data, path):
    first, last = data.draw(RIGHT[path]), data.draw(RIGHT[path])
    assume(first not in UNCORRECTED)  # it takes corrections with it
    assert SCENE.replace({path: first}).replace({path: last}) == SCENE.replace({path: last})


@law
@given(change)
def test_a_value_put_back_gives_the_same_scene(item):
    path, value = item
    before = SCENE.replace({"coupling.steps_per_rev": 25, "coupling.corrections": 2})
    # what it has taken the place of: giving that takes it back
    taken = {
        "coupling.tolerance": ["coupling.steps_per_rev", "coupling.corrections"],
        "coupling.scheme": ["coupling.scheme", "coupling.corrections"],
    }
    back = {key: read(before, key) for key in taken.get(path, [path])}
    again = before.replace({path: value}).replace(back)
    assert again.model_dump() == before.model_dump()


@law
@given(change, change)
def test_changes_of_different_values_do_not_depend_on_their_order(one, other):
    assume(one[0] != other[0] and {one[0], other[0]} not in RIVALS)
    together = SCENE.replace(dict([one, other]))
    assert together == SCENE.replace(dict([other, one]))
    assert together == SCENE.replace(dict([one])).replace(dict([other]))


@law
@given(change, st.sampled_from(sorted(WRONG)))
def test_a_refused_change_leaves_the_scene_as_it_was(item, wrong):
    path, value = item
    scene = SCENE.replace({path: value})
    before = copy.deepcopy(scene)
    with pytest.raises(SceneError):
        scene.replace({path: value, wrong: WRONG[wrong]})
    assert scene == before
    assert scene.replace({}) == before


@pytest.mark.parametrize("scheme", ["jacobi", "gauss-seidel", "compensated"])
def test_a_scheme_of_one_pass_takes_the_place_of_corrections(scheme):
    assert SCENE.coupling.corrections == 1
    assert SCENE.replace({"coupling.scheme": scheme}).coupling.corrections is None
    given = {"coupling.corrections": 2, "coupling.scheme": scheme}
    for changes in (given, dict(reversed(given.items()))):
        with pytest.raises(SceneError, match=f'corrections = 2: scheme = "{scheme}" takes one'):
            SCENE.replace(changes)
    assert SCENE.replace({"coupling.scheme": "auto"}).coupling.corrections == 1


def test_a_tolerance_takes_the_place_of_steps_and_corrections_unless_they_are_given_with_it():
    coupling = SCENE.replace({"coupling.tolerance": 1e-3}).coupling
    assert (coupling.steps_per_rev, coupling.corrections) == (None, None)
    with pytest.raises(SceneError, match=r"corrections = 2: with tolerance = 0\.001"):
        SCENE.replace({"coupling.tolerance": 1e-3, "coupling.corrections": 2})
    for rival in ({"coupling.steps_per_rev": 20}, {"coupling.tolerance": 1e-3}):
        both = {**rival, "coupling.tolerance": 1e-3, "coupling.steps_per_rev": 20}
        with pytest.raises(SceneError, match="give either steps_per_rev or tolerance"):
            SCENE.replace(both)


@pytest.mark.parametrize("axis", [1, 2])
def test_an_entry_of_one_number_for_both_axes_is_put_where_it_belongs(axis):
    scene = load_scene("two_balls").replace(
        {"rotor.stiffness": 5.0, f"rotor.stiffness[{axis}]": 7.0}
    )
    assert scene.rotor.stiffness == ((7.0, 5.0) if axis == 1 else (5.0, 7.0))


@pytest.mark.parametrize("path", ["tub.feet[2].stiffness[y]", "body[1].feet[2].stiffness[2]"])
def test_values_of_a_body_have_its_name_or_its_number(path):
    scene = load_scene("washing_machine_tub")
    changed = scene.replace({path: "6 kN/m"})
    assert changed.rotor.bodies[0].feet[1].stiffness == (4e3, 6e3)
    assert scene.unit_of(path) == "N/m"


def test_an_unknown_beginning_names_bodies_too():
    with pytest.raises(SceneError, match=r"did you mean \"tub\".*front, tub"):
        load_scene("washing_machine_tub").replace({"tubb.mass": 3.0})
