"""Composites in a host."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from fmpy import platform_tuple

from autobalancer.harness import Scene
from autobalancer.harness.export.one_file import build_one_file


@pytest.fixture
def instance(packaging: Any, tmp_path: Path) -> Any:
    """Makes a host of a scene's composite."""

    def made(scene: Scene) -> Any:
        path = build_one_file(scene, tmp_path / "one.fmu", platforms=[platform_tuple])
        return packaging.Host(path)

    return made


@pytest.fixture
def hosted(instance: Any) -> Any:
    """Begins the composite of a scene in a host."""
    return lambda scene, values=None: instance(scene).begin(values)


@pytest.fixture
def state_is_everything(hosted: Any) -> Any:
    """A composite gives the same bits after going back, in the same instance and another one."""

    def demand(
        scene: Scene, changes: dict[str, float], times: Sequence[float], names: Sequence[str]
    ) -> None:
        host = hosted(scene)
        host.driven(times[:20], names)
        state = host.slave.getFMUState()
        expected = host.driven(times[19:], names).tolist()
        host.slave.setFMUState(state)
        assert host.driven(times[19:], names).tolist() == expected
        foreign = hosted(scene, changes)
        kept = host.slave.serializeFMUState(state)
        foreign.slave.setFMUState(foreign.slave.deserializeFMUState(kept))
        assert foreign.driven(times[19:], names).tolist() == expected

    return demand
