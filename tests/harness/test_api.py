"""`import autobalancer as ab`: names, scenes as objects, and every example of a docstring."""

from __future__ import annotations

import doctest
import inspect
import subprocess
import sys
from typing import Any

import numpy as np
import pytest

import autobalancer as ab
from autobalancer.harness.manual.python import members
from autobalancer.methods import Methods

ROTORS = {
    "planar": lambda: ab.Planar(mass=8.0, stiffness=(20e3, 30e3), unbalance="20 g m"),
    "two_support": lambda: ab.TwoSupport(
        mass=8.0, inertia=0.1, span=0.4, stiffness=((2e4, 3e4), (2e4, 3e4)), planes=(0.1,)
    ),
    "flexible": lambda: ab.Flexible(
        stations=(0.0, 0.2, 0.4),
        masses=(1.0, 2.0, 1.0),
        supports=(1, 3),
        support_stiffness=(2e4, 2e4),
        bending_stiffness=100.0,
        unbalances=(ab.Unbalance(position=0.2, amount=1e-4),),
    ),
}
BALANCERS = {
    "balls": lambda: ab.Balls(count=3, mass="50 g", track_radius=0.2, drag=0.2),
    "rollers": lambda: ab.Rollers(count=2, mass=0.1, track_radius=0.2, weight_radius="20 mm"),
    "pendulums": lambda: ab.Pendulums(count=2, mass=0.1, track_radius=0.2, angles=(0.0, 1.0)),
    "liquid": lambda: ab.Liquid(chamber_radius=0.2, float_radius=0.15, height=0.1, density=1e3),
}


def _said_by(code: str) -> list[str]:
    """Words that a program in a process of its own prints."""
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return ran.stdout.split()


def test_the_package_loads_nothing_until_a_name_is_used():
    loaded = _said_by("import sys, autobalancer; print(*sys.modules)")
    own = {name for name in loaded if name.startswith("autobalancer")}
    assert own == {"autobalancer", "autobalancer.fmus", "autobalancer.fmus.lazy"}
    assert not {"numpy", "pydantic", "scipy", "importlib.metadata"} & set(loaded)


def test_an_import_leaves_the_garbage_collector_as_it_was():
    code = (
        "import gc, autobalancer as ab; {}; ab.load; print(gc.isenabled(), gc.get_freeze_count())"
    )
    assert _said_by(code.format("gc.enable()")) == ["True", "0"]
    assert _said_by(code.format("gc.disable()")) == ["False", "0"]
    enabled, frozen = _said_by(code.format("gc.freeze()"))
    assert enabled == "True"
    assert int(frozen) > 1000


def test_what_an_import_made_is_not_searched_for_garbage_before_a_full_search():
    code = (
        "import gc, autobalancer as ab; ab.load; gc.disable();"
        "young = {id(o) for k in (0, 1) for o in gc.get_objects(k)};"
        "print(id(ab.Scene.__dict__['__pydantic_fields__']) in young)"
    )
    assert _said_by(code) == ["False"]


def test_a_scene_builds_only_what_reads_its_own_tables():
    code = (
        "import autobalancer as ab; scene = ab.load('two_balls');"
        "tables = ab.Planar, ab.Flexible, ab.Liquid, ab.Unbalance, ab.Motor;"
        "print(*(each.__name__ for each in tables if each.__pydantic_complete__))"
    )
    assert _said_by(code) == ["Planar"]


@pytest.mark.parametrize("name", ab.__all__)
def test_every_name_is_there(name):
    assert getattr(ab, name)
    assert name in dir(ab)


@pytest.mark.parametrize("balancer", BALANCERS)
@pytest.mark.parametrize("rotor", ROTORS)
def test_a_scene_of_objects_is_that_of_its_file(rotor, balancer, tmp_path):
    scene = ab.Scene(
        rotor=ROTORS[rotor](),
        balancer=[BALANCERS[balancer]()],
        operation=ab.Operation(run_up=ab.RunUp(**{"from": 10.0, "to": 90.0, "seconds": 2.0})),
        coupling=ab.Coupling(steps_per_rev=50),
        run=ab.Run(revolutions=3, initial=ab.Initial(x="1 mm")),
    )
    loaded = ab.load(scene.save(tmp_path / "scene.toml"))
    assert loaded == scene
    assert (loaded.rotor.kind, loaded.balancer[0].kind) == (rotor, balancer)
    assert loaded.run.initial.x == 1e-3
    assert scene.replace({"rotor.friction": [ab.Slider(limit=1.0)]}) != scene


@pytest.mark.parametrize("name", ab.bundled_scenes())
def test_a_bundled_scene_is_kept_by_its_file(name, tmp_path):
    scene = ab.load(name)
    changed = scene.replace({"run.revolutions": 7.5})
    for one in (scene, changed):
        assert ab.load(one.save(tmp_path / "scene.toml")) == one
    assert changed != scene


def test_a_table_made_from_an_object_is_in_its_own_words():
    balls = ab.Balls(count=3, mass="50 g", track_radius=0.2)
    scene = ab.Scene(rotor=ROTORS["planar"](), balancer=[balls], speed=150)
    table = {"kind": "balls", "count": 3, "mass": 0.05, "track_radius": 0.2}
    assert scene.document["balancer"] == [table]
    assert scene.replace({"balls.count": 4}).balancer[0].count == 4
    assert scene.document["operation"] == {"speed": 150}


def test_a_wrong_table_says_every_problem():
    with pytest.raises(ab.SceneError) as refusal:
        ab.Planar(mass=-8.0, stifness=1.0)
    assert str(refusal.value).splitlines() == [
        "Planar: mass = -8.0 kg: must be greater than 0",
        "Planar: stiffness: missing; give a value in N/m",
        'Planar: stifness: unknown key (did you mean "stiffness"?); allowed: kind, fmu, bearings, '
        "bodies, on, support_loss_factor, loss_frequency, zone_limits, mass, stiffness, "
        "damping, damping_ratio, friction, cubic_stiffness, cubic, stops, internal_damping, "
        "unbalance, unbalance_angle",
    ]
    with pytest.raises(ab.SceneError, match=r"^RunUp: to = -1.0 rad/s: must be greater than 0$"):
        ab.Operation(run_up=ab.RunUp(**{"from": 0.0, "to": -1.0, "seconds": 1.0}))
    with pytest.raises(ab.SceneError, match=r"^Operation: run_up.to = -1.0 rad/s: must be great"):
        ab.Operation(run_up={"from": 0.0, "to": -1.0, "seconds": 1.0})


def test_axes_of_a_pair_are_x_and_y():
    scene = ab.Scene(rotor=ROTORS["two_support"](), speed=150)
    changed = scene.replace({"rotor.stiffness[2][x]": 5e4, "rotor.friction": [{"limit": 1.0}]})
    assert changed.rotor.stiffness == ((2e4, 3e4), (5e4, 3e4))
    assert changed.replace({"rotor.friction[1].limit[y]": 2.0}).rotor.friction[0].limit == (1, 2)
    assert changed.unit_of("rotor.stiffness[1][y]") == "N/m"
    with pytest.raises(ab.SceneError, match=r"rotor.planes\[x\]"):
        scene.replace({"rotor.planes[x]": 0.2})


def examples() -> list[doctest.DocTest]:
    """Every docstring with examples of what `ab` has, inherited methods included."""
    finder, names = doctest.DocTestFinder(), {"ab": ab, "np": np}
    found = {"ab": ab, **{name: getattr(ab, name) for name in ab.__all__ if name[0] != "_"}}
    for one in list(found.values()):
        for base in getattr(one, "__mro__", ()):
            if base.__module__.startswith("autobalancer"):
                found.setdefault(base.__name__, base)
    tests = [test for name, one in found.items() for test in finder.find(one, name, globs=names)]
    return [test for test in tests if test.examples]


def methods() -> dict[str, Any]:
    """Functions and methods of the reference page, by name."""
    found = {name: getattr(ab, name) for name in ab.__all__ if name[0] != "_"}
    for name, one in list(found.items()):
        found |= {f"{name}.{key}": each for key, each in members(one).items()}
    return {name: one for name, one in found.items() if inspect.isfunction(one)}


@pytest.mark.parametrize("name", methods())
def test_every_method_of_the_reference_has_an_example(name):
    assert ">>> " in inspect.getdoc(methods()[name])


@pytest.mark.parametrize("name", sorted({n for n in dir(Methods) if n[0] != "_"} - {"cite"}))
def test_every_method_of_a_scene_says_what_it_refuses(name):
    assert "Raises:" in inspect.getdoc(getattr(ab.Scene, name))


@pytest.mark.parametrize("example", examples(), ids=lambda example: example.name)
def test_the_examples_of_docstrings_are_true(example, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    said: list[str] = []
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE)
    runner.run(example, out=said.append)
    assert not runner.failures, "".join(said)
