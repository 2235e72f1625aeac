"""A host survives hundreds of instances, and every error, without losing memory it still uses."""

from __future__ import annotations

import subprocess
import sys

import pytest

from autobalancer.fmus.build import build

pytestmark = pytest.mark.slow

UNIT = "BallBalancer"  # all Python units share what is tested here

HOST = """
import gc, sys
import fmpy
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave

path, count = sys.argv[1], int(sys.argv[2])
description = fmpy.read_model_description(path)

def unpacked():  # in a folder of its own
    return FMU2Slave(guid=description.guid, unzipDirectory=fmpy.extract(path),
                     modelIdentifier=description.coSimulation.modelIdentifier, instanceName="unit")

slave = unpacked()
entries = list(sys.path)

def start():
    slave.setupExperiment()
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    slave.doStep(0.0, 1e-3)

def free():
    slave.fmi2FreeInstance(slave.component)

def namespace():
    (module,) = [m for n, m in sys.modules.items() if n.startswith(description.modelName + "_")]
    return sys.getrefcount(module.__dict__)
"""

CYCLES = (
    HOST
    + """
counts = []
for k in range(count):
    if k == count // 2:
        slave = unpacked()
    slave.instantiate()
    start()
    slave.terminate()
    free()
    counts.append(namespace())
assert set(counts) == {counts[0]}, (min(counts), max(counts))
assert sys.path == entries
slave.instantiate()
for k in range(count):
    start()
    slave.reset()
free()
gc.collect()
print("alive")
"""
)

ERRORS = (
    HOST
    + """
def fails(call, *values):
    try:
        call(*values)
    except FMICallException:
        return
    raise AssertionError(call)

for k in range(count):
    slave.instantiate(loggingOn=k == 0)
    slave.setupExperiment()
    slave.enterInitializationMode()
    slave.setReal([0], [-1.0])
    fails(slave.exitInitializationMode)
    fails(slave.getReal, [10000])
    fails(slave.setReal, [10000], [0.0])
    fails(slave.getInteger, [0])
    if k % 3 == 0:
        slave.reset()
        start()
    free()
gc.collect()
slave.instantiate()
start()
free()
print("alive")
"""
)


def run(script, path, count, timeout=3000):
    command = [sys.executable, "-X", "faulthandler", "-c", script, str(path), str(count)]
    return subprocess.run(command, capture_output=True, text=True, timeout=timeout, check=False)


def test_hundreds_of_instances_and_resets_leave_the_host_alive(tmp_path):
    done = run(CYCLES, build(UNIT, tmp_path, backend="python"), 200)
    assert (done.returncode, done.stdout) == (0, "alive\n"), done.stderr


def test_errors_are_logged_with_their_reason_and_leave_the_host_alive(tmp_path):
    done = run(ERRORS, build(UNIT, tmp_path, backend="python"), 200)
    assert done.returncode == 0, done.stderr
    assert done.stdout.endswith("alive\n")
    assert "unit at t = 0 s: initialisation failed: mass = -1.0 kg" in done.stdout


VANISHED = (
    HOST
    + """
import shutil
slave.instantiate()
shutil.rmtree(slave.unzipDirectory)
start()
slave.reset()
start()
state = slave.getFMUState()
slave.deserializeFMUState(slave.serializeFMUState(state))
slave.setFMUState(state)
first, slave = slave, unpacked()
slave.instantiate()
start()
slave.freeInstance()
slave = first
free()
print("alive")
"""
)


def test_unpacked_folder_may_vanish_while_the_unit_runs(tmp_path):
    done = run(VANISHED, build(UNIT, tmp_path, backend="python"), 1)
    assert (done.returncode, done.stdout) == (0, "alive\n"), done.stderr
