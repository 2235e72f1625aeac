"""FMUs, damaged: bytes changed, a part gone, a part twice."""

from __future__ import annotations

import io
import random
import zipfile
from functools import cache

from autobalancer.harness.master.plan import plan
from autobalancer.harness.master.unit_files import find_or_build
from autobalancer.harness.scene import load_scene

SCENES = ["two_balls", "balls_and_liquid", "sommerfeld", "three_mass_shaft", "bristol_friction"]


@cache
def of_scene(name: str) -> dict[str, bytes]:
    """The FMUs of a scene by their files' names."""
    paths = find_or_build(plan(load_scene(name)).units)
    return {path.name: path.read_bytes() for path in paths}


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
