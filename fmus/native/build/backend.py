"""Build backend (PEP 517, 660): setuptools, with the native libraries compiled before a wheel.

The compiler is asked for only when the libraries were not made from the present sources.  Every
other call is setuptools' own.
"""

from __future__ import annotations

import sys
from pathlib import Path
from types import ModuleType

from setuptools import build_meta
from setuptools.build_meta import *  # noqa: F403
from setuptools.command.build_py import build_py
from setuptools.command.sdist import sdist

_ROOT = Path(__file__).resolve().parents[3]
SHOWN = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "LICENSE", "CITATION.cff")

# the checkout's folders import as autobalancer.*, as they do once installed
_package = ModuleType("autobalancer")
_package.__path__ = [str(_ROOT)]
sys.modules["autobalancer"] = _package

from autobalancer.fmus.native.build import compile as native  # noqa: E402


def get_requires_for_build_wheel(config_settings=None) -> list[str]:
    return build_meta.get_requires_for_build_wheel(config_settings) + _needed()


def get_requires_for_build_editable(config_settings=None) -> list[str]:
    return build_meta.get_requires_for_build_editable(config_settings) + _needed()


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None) -> str:
    native.compiled()
    return build_meta.build_wheel(wheel_directory, config_settings, metadata_directory)


def build_editable(wheel_directory, config_settings=None, metadata_directory=None) -> str:
    native.compiled()
    return build_meta.build_editable(wheel_directory, config_settings, metadata_directory)


def _needed() -> list[str]:
    return [f"ziglang=={native.COMPILER}"] if native.stale() else []


class Modules(build_py):
    """The packages, and in the manual the files at the top of a checkout, which it shows."""

    def run(self) -> None:
        super().run()
        if not self.editable_mode:
            folder = Path(self.build_lib, "autobalancer", "harness", "manual", "project")
            self.mkpath(str(folder))
            for name in SHOWN:
                self.copy_file(str(_ROOT / name), str(folder / name))


class Sources(sdist):
    """A source distribution without the libraries: a wheel made from it compiles its own."""

    def make_distribution(self) -> None:
        self.filelist.prune(native.BINARIES.relative_to(_ROOT).as_posix())
        self.filelist.extend(SHOWN)
        super().make_distribution()
