"""An FMU file of unknown origin: nothing of it is loaded before all of this has been looked at."""

from __future__ import annotations

import shutil
import stat
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path, PurePosixPath, PureWindowsPath
from tempfile import mkdtemp
from typing import Any
from xml.etree import ElementTree

import fmpy
from fmpy.model_description import ModelDescription

from ...errors import UnitError

LARGEST_CONTENT = 2_000_000_000  # bytes, unpacked
LARGEST_RATIO = 200  # unpacked over packed, of a file that is large
LARGE = 100_000_000  # bytes
MOST_FILES = 100_000
LARGEST_DESCRIPTION = 200_000_000  # bytes of modelDescription.xml
FETCH_AGAIN = "copy, download or export the file again"  # what helps where it is cut off or damaged
_DESCRIPTION = "modelDescription.xml"
_SEPARATORS = "/\\:"  # of a path, on any platform


def read_description(path: Path) -> ModelDescription:
    """What an FMU declares, once it is known to be a co-simulation unit for this machine.

    Raises:
        UnitError: it is none; the message says what it is instead.
    """
    try:
        changed = path.stat().st_mtime_ns
    except FileNotFoundError:
        raise UnitError(f"{path}: no such file; give the path of an FMU") from None
    except OSError as error:
        raise UnitError(f"{path}: cannot be read: {error.strerror or error}") from error
    return _description(path, changed)


@lru_cache(maxsize=64)
def _description(path: Path, _changed: int) -> ModelDescription:
    if path.is_dir():
        raise UnitError(f"{path}: is a directory; give the path of an FMU file")
    try:
        with zipfile.ZipFile(path) as archive:
            refuse_dangerous(path, archive)
            names = archive.namelist()
            if _DESCRIPTION not in names:
                raise UnitError(f"{path}: has no {_DESCRIPTION}: is not an FMU")
            text = archive.read(_DESCRIPTION)
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError) as error:
        why = f"is not a sound FMU, which is a zip archive: {error}"
        raise UnitError(f"{path}: {why}; {FETCH_AGAIN}") from error
    except RuntimeError as error:  # of zipfile: encrypted
        raise UnitError(f"{path}: cannot be unpacked: {error}") from error
    except OSError as error:
        raise UnitError(f"{path}: cannot be read: {error.strerror or error}") from error
    _refuse_version(path, _root(path, text))
    try:
        description = fmpy.read_model_description(str(path))
    except Exception as error:  # of lxml, of fmpy's validation, of wrong indices
        reason = " ".join(str(error).split())
        raise UnitError(f"{path}: {_DESCRIPTION} is not valid: {reason}") from error
    _refuse_no_cosimulation(path, description, names)
    return description


def refuse_dangerous(path: Path, archive: zipfile.ZipFile) -> None:
    """Raise UnitError for what would write outside its folder, or fill the disk."""
    infos = archive.infolist()
    for info in infos:
        posix, windows = PurePosixPath(info.filename), PureWindowsPath(info.filename)
        if posix.is_absolute() or windows.drive or windows.root or ".." in windows.parts:
            raise UnitError(
                f"{path}: holds {info.filename!r}, a path outside the archive: it is not unpacked"
            )
    size, packed = (sum(getattr(i, a) for i in infos) for a in ("file_size", "compress_size"))
    bomb = any(
        i.file_size > LARGE and i.file_size > LARGEST_RATIO * max(1, i.compress_size) for i in infos
    )
    if bomb or size > LARGEST_CONTENT or len(infos) > MOST_FILES:
        raise UnitError(
            f"{path}: would unpack to {size:.3g} bytes in {len(infos)} files from {packed:.3g} "
            f"bytes: it is not unpacked; at most {LARGEST_CONTENT:.3g} bytes, {MOST_FILES} files "
            f"and {LARGEST_RATIO} times the packed size are"
        )


def _root(path: Path, text: bytes) -> Any:
    """Root element of a model description that defines no entities."""
    if len(text) > LARGEST_DESCRIPTION or b"<!DOCTYPE" in text or b"<!ENTITY" in text:
        raise UnitError(
            f"{path}: {_DESCRIPTION} has {len(text)} bytes or defines entities: no FMU needs that"
        )
    try:
        return ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError) as error:
        raise UnitError(f"{path}: {_DESCRIPTION} is not XML: {error}") from error


def _refuse_version(path: Path, root: Any) -> None:
    version = root.get("fmiVersion")
    if version is None:
        raise UnitError(f"{path}: {_DESCRIPTION} states no fmiVersion: is not an FMU")
    if not version.startswith(("2.", "3.")):
        raise UnitError(
            f"{path}: is of FMI {version}; FMI 2.0 and 3.0 are supported: export it again as one"
        )


def _refuse_no_cosimulation(path: Path, description: ModelDescription, names: list[str]) -> None:
    """Raise UnitError where there is nothing that could be stepped here."""
    kind = description.coSimulation
    if kind is None:
        has = "model exchange" if description.modelExchange else "scheduled execution"
        raise UnitError(
            f"{path}: is for {has} only, without a solver of its own; export it for co-simulation"
        )
    if not kind.modelIdentifier or set(kind.modelIdentifier) & set(_SEPARATORS):
        raise UnitError(
            f"{path}: {_DESCRIPTION}: modelIdentifier = {kind.modelIdentifier!r}: must be the name "
            "of a library, without a path: export the FMU again, or correct it"
        )
    folder = _platform(description)
    library = f"binaries/{folder}/{kind.modelIdentifier}{fmpy.sharedLibraryExtension}"
    if library not in names:
        found = {name.split("/")[1] for name in names if name.startswith("binaries/")} - {""}
        has = f"binaries for {', '.join(sorted(found))}" if found else "no binaries"
        raise UnitError(f"{path}: has {has}, none for this machine: {library} is missing")


def _platform(description: ModelDescription) -> str:
    old = description.fmiVersion.startswith("2.")
    return fmpy.platform if old else fmpy.platform_tuple


def _follow_links(path: Path, archive: zipfile.ZipFile, folder: Path) -> None:
    """Put copies in the place of symbolic links, which zipfile writes as their text.

    Raises:
        UnitError: a link points to what the archive does not hold.
    """
    for info in archive.infolist():
        if not stat.S_ISLNK(info.external_attr >> 16):
            continue
        place = folder / info.filename
        target = place.parent / archive.read(info).decode("utf-8", "replace")
        if not target.resolve().is_relative_to(folder.resolve()) or not target.is_file():
            raise UnitError(
                f"{path}: {info.filename} is a link to {str(target.relative_to(place.parent))!r}, "
                "which is no file of the archive: pack the file itself"
            )
        place.unlink()
        shutil.copyfile(target, place)


@contextmanager
def new_folder(prefix: str) -> Iterator[Path]:
    """A new folder for temporary files, which is removed again where the block fails."""
    folder = Path(mkdtemp(prefix=prefix))
    try:
        yield folder
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise


def unpacked(path: Path) -> Path:
    """A new folder with what is in an FMU that `read_description` has let pass.

    Raises:
        UnitError: it cannot be unpacked; nothing stays behind.
    """
    with new_folder("autobalancer-unit-") as folder:
        try:
            with zipfile.ZipFile(path) as archive:
                archive.extractall(folder)
                _follow_links(path, archive, folder)
        except (zipfile.BadZipFile, zlib.error, EOFError, RuntimeError) as error:
            raise UnitError(f"{path}: is damaged: {error}; {FETCH_AGAIN}") from error
        except OSError as error:
            why = f"cannot be unpacked into {folder}: {error.strerror or error}"
            raise UnitError(f"{path}: {why}; free some room, or set TMPDIR") from error
        return folder
