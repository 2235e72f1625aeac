"""The liquid balancer as a unit: declared in `variables`, computed in `slave`."""

from typing import TYPE_CHECKING

from ..lazy import loaded_from

if TYPE_CHECKING:
    from .slave import LiquidBalancer

__all__ = ["LiquidBalancer"]
__getattr__ = loaded_from(__name__, {"LiquidBalancer": ".slave"})
