"""FMUs and states, damaged: bytes changed, a part gone, a part twice."""

from __future__ import annotations

import io
import random
import zipfile
from functools import cache
from pathlib import Path

import fmpy
from fmpy import fmi2, fmi3
from fmpy.fmi1 import FMICallException

from autobalancer.fmus.build import build
from autobalancer.harness.master.one_file import build_one_file
from autobalancer.harness.master.plan import plan
from autobalancer.harness.master.unit_files import find_or_build
from autobalancer.harness.scene import load_scene

SCENES = ["two_balls", "balls_and_liquid", "sommerfeld", "three_mass_shaft", "bristol_friction"]
_HERE = [fmpy.platform_tuple]


@cache
def of_scene(name: str) -> dict[str, bytes]:
    """The FMUs of a scene by their files' names."""
    paths = find_or_build(plan(load_scene(name)).units)
    return {path.name: path.read_bytes() for path in paths}


@cache
def stateful(folder: Path) -> list[Path]:
    """FMUs whose states are saved, of both versions of FMI, and the composite."""
    made = [
        build(unit, folder / f"{unit}{fmi}{order}.fmu", fmi=fmi, order=order, platforms=_HERE)
        for unit in ("RotorOnSupports", "BallBalancer", "LiquidBalancer", "Motor")
        for fmi, order in ((2, 3), (3, 3), (2, 5))
        if (unit, order) != ("Motor", 5)
    ]
    return [*made, build_one_file(load_scene("two_balls"), folder / "one.fmu", platforms=_HERE)]


def flipped(draw: random.Random, data: bytes) -> bytes:
    """Damaged in some way."""
    changed, kind = bytearray(data), draw.random()
    first, last = sorted(draw.sample(range(len(data)), 2))
    if kind < 0.6:
        for _ in range(draw.choice((1, 1, 10))):
            changed[draw.randrange(len(data))] = draw.randrange(256)
    elif kind < 0.8:
        del changed[first : last if draw.random() < 0.5 else None]
    else:
        changed[first:first] = data[first:last]
    return bytes(changed)


def damaged(draw: random.Random, fmu: bytes) -> bytes:
    """The archive, or a file in an archive that is sound."""
    if draw.random() < 0.5:
        return flipped(draw, fmu)
    with zipfile.ZipFile(io.BytesIO(fmu)) as archive:
        files = {one: archive.read(one) for one in archive.namelist()}
    one = draw.choice([one for one in files if files[one][1:]])
    files[one] = flipped(draw, files[one])
    whole = io.BytesIO()
    with zipfile.ZipFile(whole, "w") as archive:
        for one, data in files.items():
            archive.writestr(one, data)
    return whole.getvalue()


def step_from_damaged_state(draw: random.Random, path: Path, folder: Path) -> None:
    """A damaged state is refused, and the unit goes on; or it steps on from it, or refuses to."""
    description = fmpy.read_model_description(str(path))
    of_fmi2 = description.fmiVersion == "2.0"
    unit = (fmi2.FMU2Slave if of_fmi2 else fmi3.FMU3Slave)(
        guid=description.guid,
        unzipDirectory=fmpy.extract(str(path), str(folder)),
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="unit",
    )
    unit.instantiate()
    if of_fmi2:
        unit.setupExperiment()
        save, restore = unit.getFMUstate, unit.setFMUstate
        write, read = unit.serializeFMUstate, unit.deSerializeFMUstate
    else:
        save, restore = unit.getFMUState, unit.setFMUState
        write, read = unit.serializeFMUState, unit.deserializeFMUState
    unit.enterInitializationMode()
    unit.exitInitializationMode()
    unit.doStep(0.0, 1e-3)
    state = save()
    try:
        restore(read(flipped(draw, write(state))))
        unit.doStep(1e-3, 1e-3)
    except FMICallException:
        restore(state)
        unit.doStep(1e-3, 1e-3)
    unit.freeInstance()
