"""What a run comes to: facts that are known, what the run shows, an outcome, and the sentence."""

from .judge import judge
from .known import BALANCED, vibration_alone
from .outcome import Outcome
from .verdict import Passage, Verdict

__all__ = ["BALANCED", "Outcome", "Passage", "Verdict", "judge", "vibration_alone"]
