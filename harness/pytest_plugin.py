"""pytest fixture `cosim`: run a scene, and let its result assert itself."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:  # nothing heavy is loaded for tests that do not use the fixture
    from .result.result import Result
    from .scene import Scene


@pytest.fixture
def cosim(request: pytest.FixtureRequest) -> Callable[..., Result]:
    """Run a scene by co-simulation: `cosim("scene.toml", **{"rotor.unbalance": 0.1})`.

    A relative path is looked for beside the test's file first, then from the current directory,
    then among the bundled scenes.

    Raises:
        UserError: the scene or an override is wrong.
        SimulationError: the run cannot be completed correctly.
    """

    def run(
        source: Scene | str | Path,
        *,
        record: Iterable[str] | None = None,
        fmus: Path | None = None,
        separate: bool = False,
        one_file: bool | None = None,
        **overrides: Any,
    ) -> Result:
        __tracebackhide__ = True  # of a refusal pytest shows the test's line and the message
        from autobalancer.scene import load

        from .errors import SimulationError, UserError
        from .result.run import cosimulate
        from .scene import Scene

        try:
            if isinstance(source, Scene):
                scene = source
            else:
                beside = request.path.parent / source
                scene = load(beside if beside.is_file() else source)
            if overrides:
                scene = scene.replace(overrides)
            return cosimulate(scene, record=record, fmus=fmus, separate=separate, one_file=one_file)
        except (UserError, SimulationError) as refusal:
            raise refusal.with_traceback(None) from None

    return run
