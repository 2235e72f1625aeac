"""Checks of a scene against theory, a measurement or a closed form."""

from typing import TYPE_CHECKING

from ...fmus.lazy import lazy_names

if TYPE_CHECKING:
    from .registry import run_checks

__all__ = ["run_checks"]
__getattr__, __dir__ = lazy_names(__name__, {"run_checks": ".registry"})
