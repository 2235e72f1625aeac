"""What a release carries: units, the bundled scenes as one FMU and as SSPs, in one archive."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from ...fmus.xml.archive import write, zipped
from ..errors import SceneError
from ..output.machine import VERSION
from ..output.workers import Progress
from ..scene import bundled_scenes, load_scene
from .build import Built, build_files, check_place, written

CHECKSUMS = "SHA256SUMS"  # as `sha256sum --check` reads them


def build_release(
    folder: Path,
    platforms: list[str] | None = None,
    *,
    scenes: Sequence[str] | None = None,
    progress: Progress | None = None,
) -> Built:
    """Write the archive of a release: the same bytes from the same sources.

    Scenes that cannot be an SSP of separate units are left out there; the result names them.

    Args:
        folder: where it goes.
        platforms: of the FMUs; default: all.
        scenes: names of bundled ones; default: all.

    Raises:
        UserError: a file cannot be built or written.
    """
    path = folder / f"autobalancer-{VERSION}-fmus.zip"
    check_place(path)  # before work of minutes
    names = bundled_scenes() if scenes is None else scenes
    left_out: list[str] = []
    with TemporaryDirectory(prefix="autobalancer-") as name:
        place = Path(name)
        for fmi in (2, 3):
            build_files(None, place / f"fmi{fmi}/units", fmi, platforms)
        for number, scene in enumerate(map(load_scene, names), start=1):
            for fmi in (2, 3):
                build_files(scene, place / f"fmi{fmi}/scenes", fmi, platforms, one_file=True)
            build_files(scene, place / "ssp", 2, platforms, one_file=True, ssp=True)
            try:
                build_files(scene, place / "ssp/separate_units", 2, platforms, ssp=True)
            except SceneError as error:
                left_out.append(str(error))
            if progress:
                progress(number / len(names))
        files = {
            file.relative_to(place).as_posix(): file.read_bytes()
            for file in place.rglob("*")
            if file.is_file()
        }
    sums = [f"{hashlib.sha256(files[path]).hexdigest()}  {path}\n" for path in sorted(files)]
    archive = zipped({**files, CHECKSUMS: "".join(sums).encode()})
    written(path, lambda to: write(to, archive))
    row = (f"{len(files)} with {CHECKSUMS}", hashlib.sha256(archive).hexdigest())
    return Built("Release built", ("files", "SHA-256"), (path,), (row,), tuple(left_out))
