"""What a run comes to: facts that are known, what the run shows, an outcome, and the sentence."""

from .judge import judge
from .outcome import Outcome
from .steady import BALANCED, vibration_alone
from .verdict import Passage, Verdict

__all__ = ["BALANCED", "Outcome", "Passage", "Verdict", "judge", "vibration_alone"]
