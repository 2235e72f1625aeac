"""Scenes, co-simulation, checks and reports; `import autobalancer` has these names and more.

`__init__.pyi` names everything that is here; a name is loaded when it is first used.
"""

from pathlib import Path

from ..fmus.lazy import lazy_names, names_in

_names = names_in(Path(__file__).with_suffix(".pyi"))
__all__ = sorted(_names)
__getattr__, __dir__ = lazy_names(__name__, _names)
