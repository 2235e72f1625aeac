"""What every [[balancer]] table of a scene has."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from pydantic import Field

from ...models.rotor import LinearRotor
from .feeds import Feeds, Start, fed
from .patterns import NAME
from .quantities import Flag, Table, Text, Whole
from .unit import FmuPath


class Balancer(Table):
    """What every balancer has: a name (default: its kind) and a plane, counted from 1.

    Attributes:
        model: the unit that steps it.
        driven: whether the unit is told the rotor's speed and acceleration.
        follows: inputs for the position of its plane, which only its clearance needs.
        records: outputs that a run records where nothing else is asked for.
        exchanges_force: whether it sends force; else its whole effect is its added mass.
        can_meet, can_stick: whether its force can jump, as weights collide, or stick and slip.
    """

    model: ClassVar[str]
    driven: ClassVar[bool] = False
    follows: ClassVar[tuple[str, ...]] = ()

    kind: str
    if TYPE_CHECKING:  # of one kind a property, of another a fact

        @property
        def records(self) -> tuple[str, ...]: ...
        @property
        def exchanges_force(self) -> bool: ...
        @property
        def can_meet(self) -> bool: ...
        @property
        def can_stick(self) -> bool: ...

    name: Annotated[
        Text,
        Field(pattern=NAME),
    ] = ""
    """Names its signals and its FMU: a letter first, then letters, digits, _ and -, at most 32;
    unique; default: the kind.  In FMUs a name with - is quoted: `'left-ring'.drag`."""
    at: Annotated[Whole, Field(ge=1)] = 1
    """Number of the rotor's plane or station it sits on."""
    fmu: FmuPath = None
    """FMU that steps it instead of ours, from the folder of the scene file; it has
    [our ports](units.md); default: ours."""
    inertia_as_force: Annotated[Flag, Feeds()] = False
    """The added mass is sent inside the force, for rotors without that port."""

    @property
    def label(self) -> str:
        """The name by which signals and overrides know this balancer."""
        return self.name or self.kind

    def sizes(self) -> dict[str, Any]:
        """What the unit is built for."""
        return {}

    def start(self, loaded_rotor: LinearRotor) -> Start:
        """Parameters and start values of the unit, on a rotor that carries its balancers."""
        return fed(self)
