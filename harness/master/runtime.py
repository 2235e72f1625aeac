"""Which units couple a scene: native ones, or those that run Python."""

from __future__ import annotations

from functools import cache
from typing import Literal, NamedTuple

from ...fmus.native.build.compile import NotCompiled, libraries
from ...fmus.native.build.targets import present_platform

Backend = Literal["native", "python"]


class Runtime(NamedTuple):
    """What the units of a run are.

    Attributes:
        backend: they are built for.
        note: what to say where these are not the units asked for.
    """

    backend: Backend
    note: str = ""


@cache
def runtime(wanted: Backend) -> Runtime:
    """The units that can be had: without a library for this machine the Python units serve."""
    if wanted == "native":
        try:
            libraries([present_platform()])
        except (NotCompiled, ValueError) as error:
            return Runtime("python", f"units that run Python serve instead of native ones: {error}")
    return Runtime(wanted)
