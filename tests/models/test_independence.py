"""The references know the machine's description and nothing of how units compute its motion."""

from __future__ import annotations

from pathlib import Path

import autobalancer.models
from autobalancer.fmus.python.package import imports

ROOT = Path(autobalancer.models.__file__).parents[1]
# what the machine is: parameters, matrices of the rotor, static masses, numbers
DESCRIPTION = {
    f"models.{name}"
    for name in (
        *(
            "arrays",
            "assembly",
            "constants",
            "liquid",
            "motor",
            "race",
            "restraints",
            "ring",
            "rotor",
        ),
        *(
            "rotor_kinds",
            "rotor_matrices",
            "rotor_tilting",
            "shaft",
            "supports",
            "tilting",
            "weights",
        ),
    )
}
# the fastest vibration, which limits the steps of an integration, and the error of an eigenvalue
SCALES = {"models.linear.modes", "models.linear.growth"}


def reached(*modules: str) -> set[str]:
    """These modules and all of the project that they import, at once or later."""
    found: set[str] = set()
    waiting = list(modules)
    while waiting:
        name = waiting.pop()
        path = ROOT / f"{name.replace('.', '/')}.py"
        if name not in found and path.is_file():
            found.add(name)
            waiting += imports(name, path.read_text())
    return found


REFERENCES = {f"models.reference.{path.stem}" for path in (ROOT / "models/reference").glob("*.py")}


def test_references_import_the_description_of_the_machine_alone():
    found = reached("models.monolith", *REFERENCES)
    assert found > REFERENCES
    assert found - REFERENCES - {"models.monolith"} - SCALES == DESCRIPTION


def test_units_in_python_share_no_more_than_the_description_with_the_references():
    slaves = [f"fmus.{path.parent.name}.slave" for path in ROOT.glob("fmus/*/slave.py")]
    units = reached(*slaves)
    assert "models.steps.weights" in units
    assert units & reached("models.monolith", *REFERENCES) <= DESCRIPTION


def test_the_description_computes_no_motion():
    assert not {name for name in reached(*DESCRIPTION) if name not in DESCRIPTION}
