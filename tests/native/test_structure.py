"""The C files as a building: each stands above what it uses, under a name of its own."""

from __future__ import annotations

import re
from graphlib import TopologicalSorter

import pytest

from autobalancer.fmus.native.build.compile import fast_of, parts_of_library, texts
from autobalancer.fmus.native.build.targets import FAST_COMPILE, PLATFORMS

from .core import STRUCTURES

_COMMENT = re.compile(r'/\*.*?\*/|"(?:\\.|[^"\\\n])*"', re.S)
_DEFINED = re.compile(r"^(?!static|typedef)[A-Za-z_][\w *]*?\b(\w+)\([^;{]*\)\n\{", re.M)
_TABLE = re.compile(r"^const Equations (\w+)", re.M)


def _uses(files: dict[str, str]) -> dict[str, set[str]]:
    """For each file the others that it includes, or whose functions it names."""
    plain = {name: _COMMENT.sub("", text) for name, text in files.items()}
    sources = [name for name in files if name.endswith(".c")]
    homes = {
        function: name
        for name in sources
        for function in (*_DEFINED.findall(plain[name]), *_TABLE.findall(plain[name]))
    }
    included = {n: set(re.findall(r'^#include "(.+)"$', text, re.M)) for n, text in files.items()}
    named = {
        n: {homes[word] for word in re.findall(r"\w+", plain[n]) if word in homes} for n in sources
    }
    return {name: (included[name] | named.get(name, set())) - {name} for name in files}


def test_no_files_use_each_other_in_a_circle():
    files = {name: text for name, text in texts().items() if name.endswith((".c", ".h"))}
    uses = _uses(files)
    assert "coupling/one_piece_step.c" in uses["coupling/course.c"]  # by a call alone
    assert "base/matrix.h" in uses["rotor/propagator.c"]
    TopologicalSorter(uses).prepare()  # raises CycleError, which names the circle
    files["base/matrix.c"] += "\nint matrix_circle(void)\n{\n    return propagator_terms();\n}\n"
    files["rotor/propagator.c"] += "\nint propagator_terms(void)\n{\n    return 0;\n}\n"
    with pytest.raises(ValueError, match="base/matrix"):
        TopologicalSorter(_uses(files)).prepare()


def test_every_file_has_a_name_of_its_own():
    stems = {name.rpartition(".")[0] for name in texts()}
    names = [stem.rpartition("/")[2] for stem in stems]
    assert len(names) > 40
    assert {name for name in names if names.count(name) > 1} == set()


def _members(name: str) -> list[str]:
    """Of a structure, as its header has them."""
    headers = "".join(text for file, text in texts().items() if file.endswith(".h"))
    body = re.search(rf"typedef struct {{([^}}]*)}} {name};", _COMMENT.sub("", headers))
    assert body, name
    listed = [re.sub(r"\[.*?\]", "", part) for part in body[1].split(";") if part.strip()]
    return [re.findall(r"\w+", one)[-1] for part in listed for one in part.split(",")]


@pytest.mark.parametrize("structure", STRUCTURES, ids=lambda structure: structure.__name__)
def test_structures_of_the_tests_are_those_of_the_headers(structure):
    assert [field[0] for field in structure._fields_] == _members(structure.__name__)


def test_a_fast_file_that_is_renamed_does_not_lose_its_options_unsaid():
    sources = [name for name in texts() if name.endswith(".c")]
    fast = fast_of(sources)
    begins = ("coupling/one_piece_s", "coupling/smooth_alone")
    steps = [name for name in sources if name.startswith(begins)]
    machine = [name for name in sources if name.startswith("machine/")]
    assert fast == ["base/elementary.c", *steps, *machine]
    assert len(steps) == 8
    renamed = [name.replace("one_piece_step", "one_piece_pace") for name in sources]
    with pytest.raises(ValueError, match=r"FAST.*no file of coupling/one_piece_step\.c"):
        fast_of(renamed)


@pytest.mark.parametrize("platform", PLATFORMS.values(), ids=PLATFORMS)
def test_fast_files_alone_are_compiled_with_the_options_of_fast_ones(platform):
    parts = parts_of_library(platform)
    sources = [n for n in texts() if n.endswith(".c") and n.startswith(("machine/", "coupling/"))]
    fast = {*fast_of(["base/elementary.c", *sources])}
    for name in sources:
        text, options = parts["series" if name in fast else "autobalancer"]
        assert f'#line 1 "{name}"' in text
        assert (name in fast) == (options[-len(FAST_COMPILE) :] == FAST_COMPILE)
