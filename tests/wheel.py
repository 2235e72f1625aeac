"""The package as users have it: a wheel, installed with nothing but what it requires."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import venv
from importlib.metadata import Distribution, version
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from autobalancer.harness.manual import site

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="session")
def checkout(tmp_path_factory) -> Path:
    """A checkout with its libraries: packaging writes into the folder."""
    from autobalancer.fmus.native.build.compile import libraries

    pytest.importorskip("ziglang", reason="no compiler: ziglang is not installed")
    if int(version("setuptools").split(".")[0]) < 77:
        pytest.skip("the backend needs setuptools 77 or newer")
    libraries()
    root = tmp_path_factory.mktemp("checkout")
    for name in ("fmus", "models", "harness"):
        shutil.copytree(ROOT / name, root / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", *site.TOP):
        shutil.copy(ROOT / name, root)
    return root


def build_backend(checkout: Path, call: str) -> str:
    """Last word of a call of the build backend, as pip makes it."""
    folder = "fmus/native/build"
    code = f"import sys; sys.path.insert(0, {folder!r}); import backend; print(backend.{call})"
    return _run(sys.executable, "-c", code, cwd=checkout).splitlines()[-1]


@pytest.fixture(scope="session")
def wheel(checkout, tmp_path_factory) -> Path:
    """The wheel of this checkout."""
    folder = tmp_path_factory.mktemp("wheel")
    return folder / build_backend(checkout, f"build_wheel({str(folder)!r})")


@pytest.fixture(scope="session")
def installed(wheel, tmp_path_factory) -> Path:
    """Python of a fresh environment with the wheel, pytest, and what they require.

    The requirements are links to those of this environment: nothing is downloaded, and what the
    tests need besides is not there.
    """
    home = tmp_path_factory.mktemp("installed")
    venv.create(home, with_pip=False)
    python = home / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    site = Path(_run(python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))")[:-1])
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-index"]
    _run(*pip, "--target", site, wheel)
    (package,) = Distribution.discover(name="autobalancer", path=[str(site)])
    found: dict[str, Distribution] = {"pytest": Distribution.from_name("pytest")}
    _require(found["pytest"], found)
    _require(package, found)
    for each in found.values():
        for name in {file.parts[0] for file in each.files or ()} - {"..", "bin", "__pycache__"}:
            if not (site / name).exists():
                (site / name).symlink_to(Path(str(each.locate_file(name))))
    return python


def _require(package: Distribution, found: dict[str, Distribution]) -> None:
    """Add what a package requires, and what that requires."""
    for requirement in map(Requirement, package.requires or ()):
        needed = requirement.marker is None or requirement.marker.evaluate({"extra": ""})
        if needed and requirement.name not in found:
            found[requirement.name] = Distribution.from_name(requirement.name)
            _require(found[requirement.name], found)


def _run(*command: object, cwd: Path | None = None) -> str:
    words = [str(word) for word in command]
    return subprocess.run(words, cwd=cwd, check=True, capture_output=True, text=True).stdout
