"""The motor of limited power as a unit: declared in `variables`, computed in `slave`."""

from typing import TYPE_CHECKING

from ..lazy import lazy_names

if TYPE_CHECKING:
    from .slave import Motor

__all__ = ["Motor"]
__getattr__, __dir__ = lazy_names(__name__, {"Motor": ".slave"})
