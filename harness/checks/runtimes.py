"""Native units against the units that run Python: two programs of the same equations."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..master.run import cosimulate
from ..master.runtime import runtime
from ..scene import Scene
from .row import Row, Rows

REVOLUTIONS = 20.0  # of the two runs
SIGNAL_ROUNDING = 1e-12  # of a signal's range: sums in another order, over some ten thousand steps
SOURCE = "the same scene on the units in Python"


def check_runtimes(scene: Scene) -> Iterator[Row]:
    """Every recorded signal of a run on native units, over its own range.

    Raises:
        SimulationError: a run cannot be completed.
    """
    rows = Rows(scene.name, "runtimes")
    quantity = f"native and Python units over {REVOLUTIONS:g} revolutions"
    served = runtime("native")
    if served.backend != "native":
        yield rows.statement(quantity, "compared", f"not compared: {served.note}", False, SOURCE)
        return
    short = scene.replace({"run.revolutions": REVOLUTIONS})
    native, python = (
        cosimulate(short.replace({"coupling.units": u}), separate=True)
        for u in ("native", "python")
    )
    worst = 0.0
    for name, expected in python.signals.items():
        size = float(np.ptp(expected)) or float(np.abs(expected).max()) or 1.0
        worst = max(worst, float(np.abs(native[name] - expected).max()) / size)
    label = f"{quantity}: worst of {len(python.signals)} signals, of its range"
    yield rows.number(label, 0.0, worst, SIGNAL_ROUNDING, SOURCE, 1.0)
