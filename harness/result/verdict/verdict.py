"""The verdict on a run as data: one object, whose text is the sentence after a run."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any

from .outcome import Outcome


@dataclass(frozen=True)
class Passage:
    """A change of speed between plateaus.

    Attributes:
        begin, end: [s].
        start, speed: at both ends [rad/s].
        largest: vibration in it [m], and without balancers; None: not known.
    """

    begin: float
    end: float
    start: float
    speed: float
    largest: float
    alone: float | None = None


@dataclass(frozen=True)
class Stopped:
    """What a run makes of a stop.

    Attributes:
        place: what it is, and the support that has it.
        touches: how often the rotor has come to touch it.
        force: largest force of the stop [N].
        touches_before: the same of the run of larger errors that this one was compared with; None:
            there was none.
    """

    place: str
    touches: int
    force: float
    touches_before: int | None = None


@dataclass(frozen=True)
class Verdict:
    """What a run comes to; as text a few sentences.

    Attributes:
        balancers: what they are called: balls, rollers, pendulums, weights, liquid, ring or
            balancers; empty where there are none.
        vibration: largest distance of a station from the middle in the last revolution [m]; under
            gravity from its mean.
        velocity: vibration velocity of the last revolution [m/s rms], the larger of x and y.
        alone: vibration of the rotor without balancers at this speed [m].
        after: time from which on the vibration is less than `BALANCED` of it [s].
        reason: why it is not; why that is not known.
        used: by balancer, share of the capacity that its weights use, and the capacity [kg m].
        left: unbalance that is left at a support [kg m], and the grade that permits it [mm/s].
        outcome: what the run comes to.
        remedy: what to do about it.
        revolutions: length of the run after which the rotor is balanced; None: not known.
        speed: of the rotor that is judged [rad/s].
        synchronous: vibration at the rotor's frequency [m]; None: the run is too short.
        drifts: whether nothing holds the machine: its vibration is that at the rotor's frequency.
        mean: largest distance of a station's mean from the middle, under gravity from the sag [m].
        other: frequency [rad/s] and vibration [m] of the largest part at another frequency.
        other_change: its vibration over that one window before; None: not known.
        left_behind: speed of weights that turn slower than the rotor, and the nearest natural
            frequency [rad/s].
        growth, growth_error: of a small deviation from balance [1/s].
        capacity, needed: of the weights' moment, where it does not suffice [kg m].
        plateaus: verdicts of all plateaus of a profile, begin and end [s].
        passages: changes of speed with their largest vibration.
        on_one_side: vibration by the weights alone, all on one side, of a rotor without unbalance
            [m]; None: it has one.
        left_by_race: vibration in balance on a race that is not round [m]; None: it is, or that is
            not known.
        thinness: largest part of its layer that the wave of a ring of liquid takes away; 1: the
            wall is dry.
        stops: what the run makes of every stop.
    """

    balancers: str
    vibration: float | None = None
    velocity: float | None = None
    alone: float | None = None
    after: float | None = None
    reason: str = ""
    used: tuple[tuple[str, float, float], ...] = ()
    left: tuple[float, float] | None = None
    outcome: Outcome = Outcome.NOT_RECORDED
    remedy: str = ""
    revolutions: int | None = None
    drifts: bool = False
    speed: float | None = None
    synchronous: float | None = None
    mean: float | None = None
    other: tuple[float, float] | None = None
    other_change: float | None = None
    left_behind: tuple[float, float] | None = None
    growth: float | None = None
    growth_error: float | None = None
    on_one_side: float | None = None
    left_by_race: float | None = None
    needed: float | None = None
    capacity: float | None = None
    plateaus: tuple[tuple[float, float, Verdict], ...] = ()
    passages: tuple[Passage, ...] = ()
    thinness: float | None = None
    stops: tuple[Stopped, ...] = ()

    @property
    def balanced(self) -> bool | None:
        """Whether balancers balance the rotor; None where it is not known, there are none, or a
        liquid alone lowers the vibration."""
        return self.outcome.balanced if self.balancers else None

    def __str__(self) -> str:
        from .sentence import sentences

        return " ".join(sentences(self))

    def as_json(self) -> dict[str, Any]:
        """The same as data, SI units; `balanced` and the sentence beside it."""
        fields = asdict(replace(self, plateaus=()))
        plateaus = [
            {"begin": begin, "end": end, **one.as_json()} for begin, end, one in self.plateaus
        ]
        fields |= {"plateaus": plateaus, "outcome": self.outcome.value}
        return {**fields, "balanced": self.balanced, "text": str(self)}
