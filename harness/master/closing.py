"""What holds units and frees them at the end of a `with`."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TypeVar

Holder = TypeVar("Holder", bound="Closing")


class Closing(ABC):
    """A context manager that closes itself."""

    @abstractmethod
    def close(self) -> None:
        """Free what is held."""

    def __enter__(self: Holder) -> Holder:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.close()
