"""Cures of balls that are left behind, tried with random run-ups: `python -m tests.studies.cures`.

Writes the rows of the table in `harness/manual/tutorials/left_behind.md`.
"""

from __future__ import annotations

import re
from pathlib import Path

import autobalancer as ab
from autobalancer.harness.motions.study import find_motions

PAGE = Path(__file__).parents[2] / "harness/manual/tutorials/left_behind.md"
STARTS, SPEED = 40, 150.0
LIGHT = {"balls.count": 8, "balls.mass": 0.0327 / 2, "balls.weight_radius": 0.01 * 0.5 ** (1 / 3)}


def profile(*corners: tuple[float, float]) -> dict[str, object]:
    """Changes to a profile from standstill."""
    points = [[0.0, 0.0], *map(list, corners)]
    return {"operation.run_up": None, "operation.profile": points, "run.duration": None}


CURES: dict[str, dict[str, object]] = {
    "none": {},
    "more drag": {"balls.drag": 0.1},
    "more and lighter balls": {**LIGHT, "balls.angles": None, "balls.speeds": None},
    "more damping of the supports": {"rotor.damping": 240.0},
    "within 3 s": profile((3.0, SPEED)),
    "within 1 s": profile((1.0, SPEED)),
    "within 0.7 s": profile((0.7, SPEED)),
    "a dip": profile((30.0, SPEED), (35.0, SPEED), (39.0, 30.0), (41.0, 30.0), (41.7, SPEED)),
}


def main() -> None:
    """Print what came of every cure."""
    text = re.search(r"```toml slow_drum.toml\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.S)
    assert text is not None
    drum = ab.Scene.from_document(_document(text[1]))
    for name, changes in CURES.items():
        scene = drum.replace(changes)
        (point,) = find_motions(scene, [SPEED], ["run-up"], STARTS).points
        shares = ", ".join(f"{one.count} {one.motion.name}" for one in point.shares)
        print(f"{name}: drag over limit {1.0 / scene.capture().found.drag_ratio:.2f}: {shares}")
    (point,) = find_motions(drum, [SPEED], ["turning"], STARTS).points
    print("turning:", ", ".join(f"{one.count} {one.motion.name}" for one in point.shares))


def _document(text: str) -> dict[str, object]:
    try:
        import tomllib
    except ModuleNotFoundError:  # Python 3.10
        import tomli as tomllib
    return tomllib.loads(text)


if __name__ == "__main__":
    main()
