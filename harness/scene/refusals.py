"""What a scene has that an answer does not cover, refused with the key and what to do instead."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import SceneError
from ..units import LARGEST
from .document import Described

if TYPE_CHECKING:
    from ...models.assembly import Assembly, SpeedProfile
    from .balancer import AnyBalancer
    from .rotor import Rotor
    from .run import Operation
    from .unit import Unit


class Refusals(Described):
    """A scene that refuses what asks of it more than its machine allows.

    The argument `what` begins the reason: "speeds", or "a map of growth rates is that".
    """

    if TYPE_CHECKING:  # keys of the scene
        rotor: Rotor
        balancer: tuple[AnyBalancer, ...]
        operation: Operation
        unit: tuple[Unit, ...]

        def assembly(self) -> Assembly: ...
        def profile(self) -> SpeedProfile: ...

    def speed_or_own(self, speed: float | None) -> float:
        """The speed given, by default that at which the operation ends [rad/s].

        Raises:
            SceneError: it is none at which a rotor turns.

        Example:
            >>> import autobalancer as ab
            >>> ab.load("two_balls").speed_or_own(None)
            3.0
        """
        found = self.profile().end if speed is None else speed
        if not 0.0 < found <= LARGEST:
            raise SceneError(
                f"{self.label}: speed = {found:g} rad/s: must be above 0 and {LARGEST:g} or less: "
                "give another one (--speed)"
            )
        return found

    def refuse_friction(self, what: str) -> None:
        """Raise SceneError, where dry friction holds supports at rest, for what is linear."""
        if self.rotor.slides_at_rest:
            raise SceneError(
                f"{self.label}: rotor.friction: {what} of a linear rotor, and dry "
                "friction is not; run the scene instead, or leave friction out"
            )

    def refuse_lobes(self, what: str) -> None:
        """Raise SceneError where a race has lobes, for what is of round races."""
        for balancer in self.balancer:
            if getattr(balancer, "race", ()):
                raise SceneError(
                    f"{self.label}: {balancer.label}.race: {what} of round races; "
                    "leave the lobes out, or run the scene instead"
                )

    def refuse_restraints(self, what: str) -> None:
        """Raise SceneError, where cubic springs or stops hold the rotor, for what is linear."""
        for key in ("cubic_stiffness", "stops"):
            if getattr(self.rotor, key):
                raise SceneError(
                    f"{self.label}: rotor.{key}: {what} of a linear rotor; run the "
                    f"scene instead, or leave {key} out"
                )

    def refuse_changes(self, what: str) -> None:
        """Raise SceneError where the unbalance changes during the run."""
        if self.operation.unbalance_changes:
            raise SceneError(
                f"{self.label}: operation.unbalance_changes: {what} is that of one unbalance: use "
                "run, or leave the changes out"
            )

    def refuse_unrest(self, what: str) -> None:
        """Raise SceneError where weights never rest: gravity swings them, unbalance changes."""
        self.refuse_changes(what)
        if self.operation.gravity and self.assembly().weights:
            raise SceneError(
                f"{self.label}: operation.gravity = {self.operation.gravity:g} m/s^2: {what} "
                "requires weights at rest in the rotor, and gravity swings them once per "
                "revolution: use run, or map --method cosim-run, or remove gravity"
            )

    def refuse_free(self, what: str) -> None:
        """Raise SceneError where nothing holds the machine, for what judges it by its extent."""
        if self.rotor.is_free:
            raise SceneError(
                f"{self.label}: rotor.on: nothing holds {self.rotor.on!r}, and its "
                f"drift would count as vibration: {what} requires feet; use run or rotor instead"
            )

    @property
    def guests(self) -> list[str]:
        """Parts that are FMUs of any origin, by name and file; none of most scenes."""
        parts = [("rotor", self.rotor.fmu), *((b.label, b.fmu) for b in self.balancer)]
        parts += [(unit.name, unit.fmu) for unit in self.unit]
        return [f"{name} ({Path(fmu).name})" for name, fmu in parts if fmu]

    def refuse_guests(self, what: str) -> None:
        """Raise SceneError, where parts are FMUs of any origin, for what must know their equations.

        Args:
            what: as a sentence begins with it.
        """
        if self.guests:
            raise SceneError(
                f"{self.label}: {', '.join(self.guests)}: {what} requires equations, and those of "
                "an FMU of any origin are not known: `run` takes it"
            )
