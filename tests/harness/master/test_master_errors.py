"""FMUs that are missing, broken, of another build or fail in mid-run: messages worth reading."""

from __future__ import annotations

import math
import re
import zipfile

import pytest

from autobalancer.fmus.present import options_of
from autobalancer.harness import SimulationError, UnitError, build, cosimulate, load_scene
from autobalancer.harness.master import cosimulation
from autobalancer.harness.master.cosimulation import CoSimulation
from autobalancer.harness.master.fmu import Fmu
from autobalancer.harness.master.recorder import Recorder

DESCRIPTION = "modelDescription.xml"


@pytest.fixture
def scene():
    return load_scene("two_balls").replace({"run.revolutions": 2})


@pytest.fixture
def fmus(tmp_path):
    """A directory with the units of the two-ball scene."""
    build("RotorOnSupports", tmp_path)
    build("BallBalancer", tmp_path, weights=2)
    return tmp_path


def described(change):
    """Change the model description only."""

    def members(name, content):
        return name, change(content.decode()).encode() if name == DESCRIPTION else content

    return members


def test_ready_made_fmus_give_what_built_ones_give(scene, fmus):
    ours, theirs = cosimulate(scene, separate=True), cosimulate(scene, fmus=fmus)
    assert (ours["rotor.x"] == theirs["rotor.x"]).all()


def test_a_missing_fmu_is_named_with_what_was_expected(scene, fmus):
    (fmus / "BallBalancer.fmu").unlink()
    with pytest.raises(UnitError, match=r"'weights'.*weights\.fmu.*build") as error:
        cosimulate(scene, fmus=fmus)
    assert str(fmus) in str(error.value)


@pytest.mark.parametrize(
    "damaged",
    [
        lambda whole: b"",
        lambda whole: b"this is no archive",
        lambda whole: b"PK\x03\x04" + bytes(200),
        lambda whole: whole[: len(whole) // 2],
    ],
    ids=["empty", "text", "head alone", "cut short"],
)
def test_a_corrupt_archive_is_no_fmu(scene, fmus, damaged):
    path = fmus / "BallBalancer.fmu"
    path.write_bytes(damaged(path.read_bytes()))
    with pytest.raises(UnitError, match=re.escape(str(path))):
        cosimulate(scene, fmus=fmus)


def test_a_description_that_is_not_xml_is_said_to_be_wrong(scene, fmus, rewritten, tmp_path):
    path = fmus / "BallBalancer.fmu"
    broken = rewritten(path, tmp_path / "broken.fmu", described(lambda text: text[:300]))
    broken.replace(path)
    with pytest.raises(UnitError, match=r"BallBalancer\.fmu: not an FMU"):
        cosimulate(scene, fmus=fmus)


@pytest.mark.parametrize(
    ("unit", "options", "different"),
    [
        ("BallBalancer", {"weights": 3}, r"weights = 3 instead of 2"),
        ("BallBalancer", {"weights": 2, "frame": "fixed"}, "frame = fixed instead of rotor"),
        ("RotorOnSupports", {"frame": "fixed"}, "frame = fixed instead of rotor"),
        ("RotorOnSupports", {}, "unit = RotorOnSupports instead of BallBalancer"),
    ],
)
def test_an_fmu_of_another_build_is_refused_with_what_differs(
    scene, fmus, unit, options, different
):
    name = unit if options else "BallBalancer"
    build(unit, fmus / f"{name}.fmu", **options)
    with pytest.raises(UnitError, match=rf"{name}\.fmu: is of a different build.*{different}"):
        cosimulate(scene, fmus=fmus)


def half_of_the_reaction(name: str, content: bytes) -> tuple[str, bytes]:
    """A Python ball balancer of other equations."""
    if name.endswith("fmus/weights/slave.py"):
        assert b"(f.real, f.imag)" in content
        content = content.replace(b"(f.real, f.imag)", b"(0.5 * f.real, f.imag)")
    return name, content


def another_library(name: str, content: bytes) -> tuple[str, bytes]:
    """A native ball balancer whose libraries are not those of its sources."""
    return name, content + bytes(8) if name.startswith("binaries/") else content


@pytest.mark.parametrize(
    ("backend", "change"), [("python", half_of_the_reaction), ("native", another_library)]
)
def test_an_fmu_of_the_same_sizes_and_other_content_runs_and_is_named(
    scene, fmus, rewritten, tmp_path, backend, change
):
    path = build("BallBalancer", fmus, weights=2, backend=backend)
    assert cosimulate(scene, fmus=fmus, record=[]).steps > 0
    rewritten(path, tmp_path / "other.fmu", change).replace(path)
    said = " ".join(cosimulate(scene, fmus=fmus, record=[]).events)
    assert re.search(r"BallBalancer\.fmu is not of this installation \((changed|its content)", said)


def failing_late(name: str, content: bytes) -> tuple[str, bytes]:
    """A ball balancer, under module names of its own, that breaks after half a second."""
    renamed = re.sub(r"_([0-9a-f]{16})\b", lambda m: "_" + m[1][::-1], name)
    if name.endswith((".py", ".txt", ".xml", ".json")):
        text = content.decode()
        text = re.sub(r"_([0-9a-f]{16})\b", lambda m: "_" + m[1][::-1], text)
        if name.endswith("fmus/weights/slave.py"):
            start = "    def step(self, step: float) -> None:\n"
            assert text.count(start) == 1
            trap = "        if self.time > 0.5:\n            raise ArithmeticError('it broke')\n"
            text = text.replace(start, start + trap)
        content = text.encode()
    return renamed, content


def test_a_unit_that_fails_in_mid_run_is_named_with_time_and_reason(
    scene, fmus, rewritten, tmp_path, monkeypatch
):
    whole = build("BallBalancer", fmus, weights=2, backend="python")
    files = [fmus / "RotorOnSupports.fmu", rewritten(whole, tmp_path / "late.fmu", failing_late)]
    monkeypatch.setattr(cosimulation, "find_or_build", lambda *_arguments: files)
    with pytest.raises(SimulationError) as error:
        cosimulate(scene, separate=True)
    message = str(error.value)
    time = float(re.search(r"weights at t = ([\d.]+) s", message)[1])
    assert 0.5 < time <= 0.5 + 2 * 0.105  # steps of 0.105 s
    assert "it broke" in message
    assert "loop gain" in message


def test_a_failure_leaves_no_directory_behind(scene, fmus, tmp_path, monkeypatch):
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(scratch))
    (fmus / "BallBalancer.fmu").write_bytes(b"broken")
    with pytest.raises(UnitError):
        CoSimulation(scene, fmus=fmus)
    assert list(scratch.iterdir()) == []


def test_a_parameter_the_unit_refuses_is_named(scene):
    with CoSimulation(scene) as cosim, pytest.raises(SimulationError, match=r"weights.*mass"):
        cosim.start({"weights": {"mass": -1.0}})


def test_sticking_is_named_where_a_loop_that_must_converge_does_not():
    changes = {"coupling.corrections": None, "coupling.steps_per_rev": 40, "run.revolutions": 20}
    scene = load_scene("finite_weights").replace({**changes, "balls.rolling_resistance": 0.01})
    with CoSimulation(scene) as cosim:
        cosim.start()
        why = "balls can touch.*corrector passes need not agree.*corrections"
        with pytest.raises(SimulationError, match=why):
            cosim.record(Recorder(cosim.units, []), None)
    # what it says to do helps: such steps are counted and said, and the run goes on
    fixed = {"coupling.tolerance": None, "coupling.steps_per_rev": 40, "coupling.corrections": 4}
    done = cosimulate(scene.replace(fixed), record=[], separate=True)
    assert done.steps == 800
    assert bool(done.unconverged) == any("left a residual" in event for event in done.events)


# -- saved states ---------------------------------------------------------------------------------


@pytest.fixture
def held(monkeypatch):
    """States that units have saved and not yet freed."""
    states: list[int] = []
    save, free = Fmu.save, Fmu.free

    def saving(unit, state):
        before = state.value
        save(unit, state)
        if state.value != before:
            states.append(state.value)

    def freeing(unit, state):
        if state:
            states.remove(state.value)
        free(unit, state)

    monkeypatch.setattr(Fmu, "save", saving)
    monkeypatch.setattr(Fmu, "free", freeing)
    return states


@pytest.mark.parametrize(
    "coupling", [{}, {"coupling.tolerance": 1e-4}, {"coupling.corrections": 2}]
)
def test_the_memory_of_saved_states_serves_every_step_and_is_given_back(held, coupling):
    with CoSimulation(load_scene("liquid_heavy_force").replace(coupling)) as cosim:
        for _ in range(2):
            cosim.start()
            assert not held
        for _ in range(3):
            cosim.step(1e-3)
        assert cosim.units["rotor"].calls["save"] >= 3
        assert len(held) == len(cosim.system.members)
        cosim.system.forces.now[0, 0] = math.nan
        with pytest.raises(SimulationError, match="F_xi"):
            cosim.step(1e-3)
        assert len(held) == len(cosim.system.members)
    assert held == []


def test_states_saved_before_one_that_cannot_be_are_freed(held, monkeypatch):
    with CoSimulation(load_scene("two_balls")) as cosim:
        cosim.start()
        last, save = cosim.system.members[-1], Fmu.save

        def refusing(unit, state):
            if unit is last:
                raise SimulationError("no memory")
            save(unit, state)

        monkeypatch.setattr(Fmu, "save", refusing)
        with pytest.raises(SimulationError, match="no memory"):
            cosim.step(0.1)
    assert held == []


def test_an_archive_that_unpacks_to_more_than_any_fmu_is_refused_unread(tmp_path):
    path = tmp_path / "large.fmu"
    deflated = zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1)
    with deflated as archive, archive.open("resources/zeros", "w") as stream:
        for _ in range(257):
            stream.write(bytes(1_000_000))
    assert path.stat().st_size < 5_000_000
    refused = r"large\.fmu: not .*unpacks to 257000000 bytes; at most 256000000"
    with pytest.raises(ValueError, match=refused):
        options_of(path)
