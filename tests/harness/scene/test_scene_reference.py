"""The reference of scene keys is what the scene's types say."""

import pytest

from autobalancer.harness import Scene
from autobalancer.harness.scene.messages import tables_in
from autobalancer.harness.scene.quantities import fields_of, unit_of
from autobalancer.harness.scene.reference import meanings, reference


def tables():
    """Every table a scene can hold."""
    found, waiting = [], [Scene]
    while waiting:
        table = waiting.pop()
        if table not in found:
            found.append(table)
            waiting += [t for f in table.model_fields.values() for t in tables_in(f.annotation)]
    return found


@pytest.mark.parametrize("table", tables(), ids=lambda table: table.__name__)
def test_every_key_stands_there_with_its_unit_and_meaning(table):
    text, said = reference(), meanings(table)
    nested = {name for name, field in Scene.model_fields.items() if tables_in(field.annotation)}
    for name, (key, field) in zip(table.model_fields, fields_of(table).items(), strict=True):
        if name == "kind" or (table is Scene and name in nested):
            continue
        unit = unit_of(field)
        row = f"{key}` | {unit} |" if unit else f"{key}` | |"
        assert row in text, f"{table.__name__}.{name}"
        assert said[name]
