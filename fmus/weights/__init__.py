"""Balls, rollers or pendulums as a unit: declared in `variables`, computed in `slave`."""

from typing import TYPE_CHECKING

from ..lazy import loaded_from

if TYPE_CHECKING:
    from .slave import BallBalancer

__all__ = ["BallBalancer"]
__getattr__ = loaded_from(__name__, {"BallBalancer": ".slave"})
