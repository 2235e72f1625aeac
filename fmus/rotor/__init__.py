"""The rotor on its supports as a unit: declared in `variables`, computed in `slave`."""

from typing import TYPE_CHECKING

from ..lazy import loaded_from

if TYPE_CHECKING:
    from .slave import RotorOnSupports

__all__ = ["RotorOnSupports"]
__getattr__ = loaded_from(__name__, {"RotorOnSupports": ".slave"})
