"""Error against run time: coupling schemes beside integration in one piece."""

from typing import TYPE_CHECKING

from ....fmus.lazy import lazy_names

if TYPE_CHECKING:
    from .measure import precision

__all__ = ["precision"]
__getattr__, __dir__ = lazy_names(__name__, {"precision": ".measure"})
