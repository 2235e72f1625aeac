"""The base class of the Python units, at the place where it is imported from."""

from .python.slave import Slave

__all__ = ["Slave"]
