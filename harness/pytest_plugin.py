"""pytest fixture `cosim`: run a scene, and let its result assert itself."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:  # nothing heavy is loaded for tests that do not use the fixture
    from .result.result import Result
    from .scene import Scene
    from .scene.system import System


@pytest.fixture
def cosim(request: pytest.FixtureRequest) -> Callable[..., Result]:
    """Run a scene by co-simulation: `cosim("scene.toml", **{"rotor.unbalance": 0.1})`.

    So run systems of FMUs: a file without a rotor, an SSP, one FMU, or a `System`.

    A relative path is looked for beside the test's file first, then from the current directory,
    then among the bundled scenes.

    Raises:
        UserError: the scene or an override is wrong.
        SimulationError: the run cannot be completed correctly.
    """

    def run(
        source: Scene | System | str | Path,
        *,
        record: Iterable[str] | None = None,
        fmus: str | Path | None = None,
        separate: bool = False,
        one_file: bool | None = None,
        **overrides: Any,
    ) -> Result:
        __tracebackhide__ = True  # of a refusal pytest shows the test's line and the message
        from autobalancer.scene import load
        from autobalancer.system import load_system

        from .errors import SimulationError, UserError
        from .result.run import cosimulate
        from .scene import Scene
        from .scene.file import names_system
        from .scene.system import System

        try:
            asked: Scene | System
            if isinstance(source, (Scene, System)):
                asked = source
            else:
                beside = request.path.parent / source
                found = beside if beside.is_file() else source
                asked = load_system(found) if names_system(found) else load(found)
            if isinstance(asked, System):
                from .result.system import run_system

                return run_system(asked.replace(overrides), record=record)
            scene = asked
            if overrides:
                scene = scene.replace(overrides)
            return cosimulate(scene, record=record, fmus=fmus, separate=separate, one_file=one_file)
        except (UserError, SimulationError) as refusal:
            raise refusal.with_traceback(None) from None

    return run
