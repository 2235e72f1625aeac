"""Scenes and assignments, mangled: values, keys, tables of other scenes, lines, bytes."""

from __future__ import annotations

import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

from pydantic import BaseModel
from tomli_w import dumps

from autobalancer.harness import Scene, bundled_scenes, load_scene
from autobalancer.harness.scene.file import tomllib
from autobalancer.harness.scene.messages import choose_table, tables_in
from autobalancer.harness.scene.quantities import fields_of

WRONG = [
    *["0", "-1", "1e-300", "1e300", "nan", "inf", "true", '""', '"\\u001b[31m"', "[]", "{}"],
    *["99999999999999999999", "1979-05-27", "[1.0, 2.0, 3.0]", "[[1.0]]", "1_0", "1e14"],
    *['"<script>"', '"$x_{\\\\"', "[[]]", "[{}]", '["rotor.x", "rotor.x"]', "-0.0"],
]
BROKEN = ["'", "=", "[", '"""', "", "\x00"]
RIGHT: dict[str, list[str]] = {
    "motor": [
        "{stall_torque = 20.0, no_load_speed = 200.0, inertia = 0.5}",
        "{table = [[0.0, 9.0], [50.0, 5.0], [300.0, -1.0]], inertia = 2.0, from = 40.0}",
    ],
    "run_up": ["{from = 0.0, to = 90.0, seconds = 0.5}", "{from = 5.0, to = 1.0, seconds = 1.0}"],
    "friction": ["[{limit = 0.5}]", "[{limit = [0.1, 2.0], stiffness = 1e4}, {limit = 0.1}]"],
    "record": ['["rotor.x"]', '["rotor.plane[1].x", "motor.speed"]', "[]"],
    "initial": ["{x = 1e-3}", "{vy = 0.1, angle = 3.0}"],
    "unbalances": ["[{position = 0.1, amount = 1e-3}]"],
    "set": ["{}", '{"rotor.mass" = 2.0}'],
}
NUMBERS = ["1", "2", "3", "5", "1.0", "0.5", "0.01", "9.81", "40.0", "200", "[0.1, 0.2]", "1e-4"]
_TABLES = ["rotor", "operation", "coupling", "run", "balancer", "check", ""]
_DRIVES = {"speed", "run_up", "motor"}
Table = dict[str, Any]


def keys_of(table: str, holder: Table | None = None) -> dict[str, list[str]]:
    """Keys of a table of scenes, of the kind that `holder` is, else of all; and a key's words."""
    if not table:
        classes: list[type[BaseModel]] = [Scene]
    elif table in fields_of(Scene):
        classes = tables_in(fields_of(Scene)[table].annotation)
    else:
        return {}
    own = holder and choose_table(classes, holder)
    found: dict[str, list[str]] = {}
    for one in [own] if own else classes:
        for key, field in fields_of(one).items():
            found.setdefault(key, []).extend(_words(field.annotation))
    return found


def _words(annotation: Any) -> Iterator[str]:
    if get_origin(annotation) is Literal:
        yield from (f'"{w}"' if isinstance(w, str) else str(w) for w in get_args(annotation))
    else:
        for part in get_args(annotation):
            yield from _words(part)


def value(draw: random.Random, key: str, words: list[str], before: Any = None) -> str:
    """As TOML writes it: right for the key more often than not."""
    right = [*words, *RIGHT.get(key, ())]
    if isinstance(before, float) and draw.random() < 0.7:
        return repr(before * draw.choice([0.5, 0.9, 1.1, 2.0, 10.0, 100.0, 1e-3, 1e6, -1.0, 0.0]))
    if right and draw.random() < 0.8:
        return draw.choice(right)
    return draw.choice(NUMBERS if draw.random() < 0.6 else WRONG)


def assignment(draw: random.Random) -> str:
    """For `--set`."""
    if draw.random() < 0.1:
        return draw.choice(
            [*BROKEN, "=1", "a=b=c", "a.b.c=1", "rotor=1", "run.record=[", "\udcff=1"]
        )
    table = draw.choice(["rotor", "operation", "coupling", "run", "balancing", "balancer"])
    keys = keys_of(table)
    key = draw.choice(list(keys))
    index = draw.choice(["", "", "", "[1]", "[2]", "[0]", ".x", "[1].angle"])
    name = draw.choice(["weights", "balls", "liquid"]) if table == "balancer" else table
    return f"{name}.{key}{index}={value(draw, key, keys[key])}"


def scene(draw: random.Random, path: Path) -> None:
    """Write one to `path`: of what a scene says, of its lines, or of its bytes some are changed."""
    kind, text = draw.random(), _text(draw)
    if kind < 0.65:
        text = _of_other_words(draw, tomllib.loads(text))
    if kind > 0.6:
        text = _of_other_lines(draw, text)
    data = text.encode("utf-8", "surrogateescape")
    if kind > 0.95:
        place = draw.randrange(len(data) + 1)
        data = (
            data[:place] + bytes(draw.choices(range(256), k=draw.randint(0, 4))) + data[place + 2 :]
        )
    path.write_bytes(data)


def _text(draw: random.Random) -> str:
    return load_scene(draw.choice(bundled_scenes())).path.read_text("utf-8")


def _of_other_words(draw: random.Random, document: Table) -> str:
    for _ in range(draw.choice([1, 1, 1, 2, 3])):
        name = draw.choice([*_TABLES, *document])
        if draw.random() < 0.1:  # a table of another scene
            document[name or "title"] = tomllib.loads(_text(draw)).get(name, {})
            continue
        holder = _holder(draw, document, name)
        keys = keys_of(name, holder if draw.random() < 0.9 else None)
        key = draw.choice([*keys, *(holder if holder is not document else ())] or ["key"])
        if draw.random() < 0.15:
            holder.pop(key, None)
            continue
        changed = value(draw, key, keys.get(key, []), holder.get(key))
        if key in _DRIVES:
            for drive in _DRIVES:
                holder.pop(drive, None)
        holder[key] = tomllib.loads(f"v = {changed}")["v"]
    return dumps(document)


def _holder(draw: random.Random, document: Table, name: str) -> Table:
    """The table of that name, or one of them; `document` itself for ""."""
    if not name:
        return document
    found = document.setdefault(name, {})
    if isinstance(found, list) and found:
        found = draw.choice(found)
    return found if isinstance(found, dict) else document


def _of_other_lines(draw: random.Random, text: str) -> str:
    lines = text.splitlines()
    for _ in range(draw.randint(1, 3)):
        place, kind = draw.randrange(len(lines)), draw.random()
        if kind < 0.6 and "=" in lines[place]:
            lines[place] = f"{lines[place].partition('=')[0]}= {draw.choice(WRONG + BROKEN)}"
        elif kind < 0.8:
            lines[place] = lines[place][: draw.randint(0, len(lines[place]))]
        else:
            lines.insert(place, draw.choice(lines))
    return "\n".join(lines)
