"""The reference of scene keys in the harness's README is what the scene's types say."""

import pytest

from autobalancer.harness.scene import Scene
from autobalancer.harness.scene.messages import tables_in
from autobalancer.harness.scene.quantities import fields_of, unit_of
from autobalancer.harness.scene.reference import BEGIN, README, main, meanings, reference, replaced


def tables():
    """Every table a scene can hold."""
    found, waiting = [], [Scene]
    while waiting:
        table = waiting.pop()
        if table not in found:
            found.append(table)
            waiting += [t for f in table.model_fields.values() for t in tables_in(f.annotation)]
    return found


def test_readme_is_up_to_date(capsys):
    assert main([]) == 0, capsys.readouterr().out


def test_a_stale_readme_is_said_and_written_anew(tmp_path, monkeypatch, capsys):
    stale = tmp_path / "README.md"
    page = README.read_text(encoding="utf-8")
    stale.write_text(page.replace("| `stations` | m |", "| `stations` | mm |"), encoding="utf-8")
    monkeypatch.setattr("autobalancer.harness.scene.reference.README", stale)
    assert main([]) == 1
    assert "reference --write" in capsys.readouterr().out
    assert main(["--write"]) == 0
    assert stale.read_text(encoding="utf-8") == page
    assert replaced(page) == page


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


def test_section_stands_between_its_markers():
    assert README.read_text(encoding="utf-8").count(BEGIN) == 1
