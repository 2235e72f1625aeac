"""The rooms of `harness` and `models` as a building: each imports those below it alone."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

import autobalancer.models

ROOT = Path(autobalancer.models.__file__).parents[1]
PACKAGE = "autobalancer"
# from the ground up; rooms of one floor do not import each other
HARNESS = (
    ("errors",),
    ("units", "input_files"),
    ("measurements", "output"),
    ("vibration", "scene"),
    ("master",),
    ("result", "capture", "drag", "film"),
    ("stability",),
    ("motions",),
    ("design", "rotor", "balancing", "fit", "scatter", "show", "accuracy"),
    ("checks", "export", "report"),
    ("api",),
    ("manual", "pytest_plugin"),
    ("commands",),
    ("__main__",),
)
# files beside the rooms of `models` are named; the others say what a machine is
MODELS = (
    ("",),
    ("steps", "papers"),
    ("linear",),
    ("capture", "proof", "reference"),
    ("stability", "monolith", "lobes"),
    ("boundaries",),
    ("criteria",),
)
# a program by hand, `python -m`, that describes the whole program's commands
PROGRAMS = {
    f"{PACKAGE}.harness.manual.reference imports {PACKAGE}.harness.__main__",
}


def _name(path: Path) -> str:
    """Of a file as a module: `harness/api` is the package itself."""
    parts = [PACKAGE, *path.relative_to(ROOT).with_suffix("").parts]
    parts = parts[:1] + parts[3:] if parts[1:3] == ["harness", "api"] else parts
    return ".".join(parts).removesuffix(".__init__")


@cache
def _files(*tops: str) -> dict[str, Path]:
    return {_name(path): path for top in tops for path in sorted((ROOT / top).rglob("*.py"))}


def _imports(path: Path, known: dict[str, Path], text: str, types: bool) -> Iterator[str]:
    """Modules that a file imports, at once or when a function is called.

    Args:
        types: also those imported for type checkers alone.
    """
    name = _name(path)
    package = name if path.name == "__init__.py" else name.rpartition(".")[0]
    tree = ast.parse(text)
    guarded = [n for n in ast.walk(tree) if isinstance(n, ast.If) and _id(n) == "TYPE_CHECKING"]
    left_out = {id(n) for one in guarded for part in one.body for n in ast.walk(part)}
    for node in ast.walk(tree):
        if id(node) in left_out and not types:
            continue
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in known)
        if isinstance(node, ast.ImportFrom):
            above = package.split(".")[: len(package.split(".")) - node.level + 1]
            home = ".".join([*(above if node.level else ()), *filter(None, [node.module])])
            for alias in node.names:
                found = f"{home}.{alias.name}"
                yield from (each for each in (found if found in known else home,) if each in known)


def _id(node: ast.If) -> str:
    return node.test.id if isinstance(node.test, ast.Name) else ""


def _graph(files: dict[str, Path], types: bool = False, **changed: str) -> dict[str, set[str]]:
    """By module what it imports; `changed` are texts of files by their stem."""
    texts = {n: changed.get(p.stem, "") or p.read_text("utf-8") for n, p in files.items()}
    return {n: {*_imports(p, files, texts[n], types)} - {n} for n, p in files.items()}


def _room(name: str, top: str, rooms: tuple[tuple[str, ...], ...]) -> str:
    path = _files(top)[name].relative_to(ROOT / top)
    first = path.parts[0].removesuffix(".py")
    return first if any(first in floor for floor in rooms) else ""


def _wrong(graph: dict[str, set[str]], top: str, floors: tuple[tuple[str, ...], ...]) -> list[str]:
    """Imports that lead up, or to another room of the same floor."""
    heights = {room: height for height, floor in enumerate(floors) for room in floor}
    rooms = {name: _room(name, top, floors) for name in graph}
    return sorted(
        f"{name} imports {other}"
        for name, others in graph.items()
        for other in others
        if rooms[name] != rooms[other] and heights[rooms[name]] <= heights[rooms[other]]
    )


@pytest.mark.parametrize(("top", "floors"), [("harness", HARNESS), ("models", MODELS)])
def test_no_room_imports_one_above_it(top, floors):
    graph = _graph(_files(top), types=True)
    graph.pop(f"{PACKAGE}.{top}")  # hands names on
    assert len(graph) > 50
    wrong = [line for line in _wrong(graph, top, floors) if line not in PROGRAMS]
    assert wrong == []


def test_every_room_has_a_floor():
    for top, floors in (("harness", HARNESS), ("models", MODELS)):
        rooms = {p.parent.name for p in (ROOT / top).glob("*/*.py")} - {"scenes"}
        assert rooms <= {room for floor in floors for room in floor}


@pytest.mark.parametrize("top", ["harness", "models"])
def test_no_files_import_each_other_in_a_circle(top):
    TopologicalSorter(_graph(_files(top))).prepare()  # raises CycleError, which names the circle


def test_an_import_within_a_function_counts():
    files = _files("harness")
    late = "def load():\n    from ..stability.speeds import Speeds\n"
    upwards = _wrong(_graph(files, feeds=late), "harness", HARNESS)
    assert f"{PACKAGE}.harness.scene.feeds imports {PACKAGE}.harness.stability.speeds" in upwards
    late = "def load():\n    from .balancer import Liquid\n"
    with pytest.raises(CycleError, match=r"scene\.feeds"):
        TopologicalSorter(_graph(files, feeds=late)).prepare()


def test_the_description_of_a_machine_imports_no_feature_and_no_witness():
    files = _files("harness", "models")
    graph = _graph(files, types=True)
    reached: set[str] = set()
    waiting = [name for name in files if name.startswith(f"{PACKAGE}.harness.scene.")]
    while waiting:
        name = waiting.pop()
        reached.add(name)
        waiting += graph[name] - reached
    rooms = {name.removeprefix(f"{PACKAGE}.harness.").partition(".")[0] for name in reached}
    assert not {"master", "result", "stability", "design", "api"} & rooms
    assert not [name for name in reached if name.startswith(f"{PACKAGE}.models.reference.")]


def test_no_module_of_the_public_package_imports_beyond_it():
    for path in (ROOT / "harness/api").glob("*.py"):  # what is ../ there is no module at all
        levels = [n.level for n in ast.walk(ast.parse(path.read_text())) if hasattr(n, "level")]
        assert max(levels, default=0) <= 1, path.name
