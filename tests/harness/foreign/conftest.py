"""FMUs of others: built once by pythonfmu, and altered copies of them."""

from __future__ import annotations

import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

GUESTS = Path(__file__).parents[2] / "guests"


@pytest.fixture(scope="session")
def guest(tmp_path_factory) -> Callable[..., Path]:
    """The FMU of a module of `tests/guests`; `state` whether it can be rolled back."""
    from pythonfmu.builder import FmuBuilder

    made: dict[tuple[str, bool], Path] = {}

    def build(name: str, state: bool = True) -> Path:
        if (name, state) not in made:
            folder = tmp_path_factory.mktemp(f"{name}-{state}")
            options = {"canGetAndSetFMUstate": True} if state else {}
            made[name, state] = Path(
                FmuBuilder.build_FMU(GUESTS / f"{name}.py", dest=folder, **options)
            )
        return made[name, state]

    return build


@pytest.fixture
def altered(tmp_path) -> Callable[..., Path]:
    """A copy of an FMU with its model description edited, and files left out or added."""

    def alter(
        path: Path,
        edit: Callable[[str], str] = lambda text: text,
        without: str = "\0",
        added: dict[str, bytes] | None = None,
        name: str = "altered.fmu",
    ) -> Path:
        with zipfile.ZipFile(path) as source, zipfile.ZipFile(tmp_path / name, "w") as copy:
            for info in source.infolist():
                if info.filename.startswith(without):
                    continue
                data = source.read(info)
                if info.filename == "modelDescription.xml":
                    data = edit(data.decode()).encode()
                copy.writestr(info.filename, data)
            for file, data in (added or {}).items():
                copy.writestr(file, data, zipfile.ZIP_DEFLATED)
        return tmp_path / name

    return alter
