"""Where and beside what units run: threads, the process's folder, and names of folders."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from autobalancer.fmus.native.build.compile import NotCompiled
from autobalancer.harness import cosimulate, load_scene
from autobalancer.harness.master import runtime

SHORT = {"run.revolutions": 3}


def signals(name: str) -> dict[str, np.ndarray]:
    return cosimulate(load_scene(name).replace(SHORT)).signals


def test_eight_threads_run_to_the_last_bit_as_one_after_another():
    names = ["two_balls", "liquid_disc", "balls_and_liquid", "drum"] * 4
    alone = {name: signals(name) for name in set(names)}
    with ThreadPoolExecutor(8) as threads:
        beside = list(threads.map(signals, names))
    for name, found in zip(names, beside, strict=True):
        assert found.keys() == alone[name].keys()
        assert all((found[k] == alone[name][k]).all() for k in found), name


def test_the_folder_of_the_process_stays_while_units_are_loaded(monkeypatch):
    def change(path):
        raise AssertionError(f"changes the folder of every thread to {path}")

    monkeypatch.setattr(os, "chdir", change)
    signals("two_balls")


def test_threads_may_use_units_that_run_python():
    scene = load_scene("two_balls").replace({**SHORT, "coupling.units": "python"})
    alone = cosimulate(scene).signals
    together = threading.Barrier(4)

    def run(_number: int) -> dict[str, np.ndarray]:
        together.wait()
        return cosimulate(scene).signals

    with ThreadPoolExecutor(4) as threads:
        for found in threads.map(run, range(4)):
            assert all((found[k] == alone[k]).all() for k in alone)


def test_native_units_and_those_that_run_python_are_two_programs_of_the_same_equations():
    scene = load_scene("balls_and_liquid").replace({"run.revolutions": 20.0})
    native, python = (
        cosimulate(scene.replace({"coupling.units": units}), separate=True)
        for units in ("native", "python")
    )
    assert native.signals.keys() == python.signals.keys()
    for name, expected in python.signals.items():
        size = float(np.ptp(expected)) or 1.0
        # the rule of Python's weights errs in these steps, native ones to rounding
        np.testing.assert_allclose(native[name], expected, rtol=0.0, atol=1e-8 * size)


def test_without_a_native_library_python_units_serve_and_the_run_says_so(monkeypatch):
    def absent(platforms):
        raise NotCompiled("no library for this machine")

    scene = load_scene("two_balls").replace(SHORT)
    native = cosimulate(scene)
    expected = cosimulate(scene.replace({"coupling.units": "python"}))
    monkeypatch.setattr(runtime, "libraries", absent)
    runtime.runtime.cache_clear()
    found = cosimulate(scene)
    runtime.runtime.cache_clear()
    words = "units that run Python serve instead of native ones: no library for this machine"
    assert words in found.events
    assert not {words} & {*native.events, *expected.events}
    assert all((found[name] == values).all() for name, values in expected.signals.items())
    assert any((found[name] != values).any() for name, values in native.signals.items())


RUN = """
from autobalancer.harness import cosimulate, load_scene
for units in ("native", "python"):
    scene = load_scene("two_balls").replace({"run.revolutions": 1, "coupling.units": units})
    print(float(cosimulate(scene)["rotor.x"][-1]))
"""


def test_any_name_of_the_temporary_folder_will_do(tmp_path, capsys):
    odd = tmp_path / "ü (1)+b it's [1] 100% %41 a#b?c\"d;e&f"
    odd.mkdir()
    done = subprocess.run(
        [sys.executable, "-c", RUN],
        env={**os.environ, "TMPDIR": str(odd)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    exec(RUN)
    assert done.stdout == capsys.readouterr().out
    assert os.listdir(odd) == []
