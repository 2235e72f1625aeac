"""Scenes to start from: commented, sourced, and balanced above their critical speeds."""

import pytest

from autobalancer.harness import cosimulate, load_scene
from autobalancer.harness.commands.new import MACHINES
from autobalancer.models.linear.critical import critical_speeds

LONGER = {"drum": 219, "grinder": 42}  # revolutions; the bundled runs show the beginning


@pytest.mark.parametrize("name", MACHINES)
def test_a_new_scene_is_commented_and_balances_above_its_critical_speeds(name, invoke, tmp_path):
    path = tmp_path / "new.toml"
    outcome = invoke("new", name, "-o", path)
    assert outcome.exit_code == 0, outcome.output
    text = path.read_text(encoding="utf-8")
    assert text.count("#") > 8
    scene = load_scene(path)
    assert scene.source
    assert not scene.checks
    assert not scene.on_request
    speed = scene.profile().end
    near = critical_speeds(scene.assembly().loaded_rotor)[: 2 * len(scene.rotor.supports)]
    assert speed > (near.max() if name != "grinder" else near.min())  # it bends at 878 Hz
    found = cosimulate(scene.replace({"run.revolutions": LONGER[name]} if name in LONGER else {}))
    assert found.summary().balanced, str(found.summary())


def test_new_never_writes_over_a_file_and_names_its_kinds(invoke, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert "my_fan.toml" in invoke("new", "fan").output
    again = invoke("new", "fan")
    assert again.exit_code == 2
    assert "my_fan.toml: exists; name another file with -o" in again.stderr
    assert "did you mean" in invoke("new", "centrifug").stderr
