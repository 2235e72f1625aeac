"""The error of a rotor without a loop: exact, but where its supports stick and slide.

A rotor alone is propagated without error from step to step.  Dry friction, stops and cubic springs
are integrated by series from event to event; how much these err depends on the steps.  So the run
is done once more, in steps of half the length.  What the two differ by is the error that is
stated: of order one or more, the first one errs by at most twice that.
"""

from __future__ import annotations

from .compared import compared_motion, largest_difference
from .recorder import Recorder
from .schedule import SLIVER
from .simulation import CoupledRun

PARTS = 2  # of each step, in the second run


def friction_error(simulation: CoupledRun, recorder: Recorder) -> float:
    """Largest error of a run's motion as `largest_difference` has it; 0 of linear supports.

    Args:
        simulation: that ran, without a loop.
        recorder: what it recorded.

    Raises:
        SimulationError: as `Simulation.record`.
    """
    scene = simulation.scene
    if scene.rotor.is_linear:
        return 0.0
    shown = compared_motion(scene, simulation.meets_events)
    times, signals = recorder.columns()
    once_more = Recorder(simulation.units, [], shown.signals)
    simulation.start(parts=PARTS)
    simulation.record(once_more, None)
    points, found = once_more.columns()
    at = points.searchsorted(times * (1.0 - SLIVER))
    known = {name: signals[name] for name in shown.signals}
    compared = {name: each[at] for name, each in found.items()}
    return largest_difference(known, compared, shown.least(recorder))
