"""Stiff and extreme cases: each right, or clearly refused."""

from typing import TYPE_CHECKING

from ....fmus.lazy import lazy_names

if TYPE_CHECKING:
    from .run import stress

__all__ = ["stress"]
__getattr__, __dir__ = lazy_names(__name__, {"stress": ".run"})
