"""FMUs of pythonfmu in this interpreter, which loads their modules by names that can coincide.

Two FMUs may both have a module `slave`; the second would get the class of the first.  What an FMU
has imported from its folder is therefore forgotten before another is made, and its folder leaves
the interpreter's path when it is freed.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path
from types import ModuleType

from ....fmus.python.host import keep, settle_at_exit
from ..library import MODULE_FILE


def before_making(folder: Path) -> None:
    """Forget modules of other folders whose names this FMU has as well."""
    resources = folder / "resources"
    own = {path.stem for path in resources.glob("*.py")}
    own |= {path.parent.name for path in resources.glob("*/__init__.py")}
    for name, module in list(sys.modules.items()):
        root = name.partition(".")[0]
        if root in own and _is_guest(module) and not _is_under(module, resources):
            del sys.modules[name]


def after_making(folder: Path) -> None:
    """Undo what the loader of pythonfmu does to its host, see `fmus.python.host`."""
    settle_at_exit(str(folder))
    name = (folder / "resources" / MODULE_FILE).read_text("utf-8").strip()
    if module := sys.modules.get(name):
        keep(module.__dict__)


def after_freeing(folder: Path) -> None:
    """Take the folder from the interpreter's path, and its modules from the loaded ones."""
    resources = folder / "resources"
    for entry in [e for e in sys.path if e and Path(e) == resources]:
        sys.path.remove(entry)
        sys.path_importer_cache.pop(entry, None)
    for name, module in list(sys.modules.items()):
        if _is_under(module, resources):
            del sys.modules[name]


def _is_guest(module: ModuleType) -> bool:
    """Whether a module was loaded from an unpacked FMU."""
    parts = Path(getattr(module, "__file__", None) or "").parts
    return any(part.startswith("autobalancer-unit") for part in parts)


def _is_under(module: ModuleType, folder: Path) -> bool:
    file = getattr(module, "__file__", None)  # thousands are asked: no paths are made of them
    return bool(file) and str(file).startswith(f"{folder}{os.sep}")
