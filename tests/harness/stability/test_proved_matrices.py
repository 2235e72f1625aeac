"""Stability proved of a rotor that is known by its matrices."""

from __future__ import annotations

import numpy as np
import pytest

import autobalancer as ab

pytest.importorskip("flint")


def test_a_shaft_by_its_matrices_is_proved_like_the_shaft():
    shaft = ab.load("three_mass_shaft")
    rotor, document = shaft.assembly().rotor, shaft.document
    springs, dampers = (np.hstack(np.hstack(each)) for each in (rotor.springs, rotor.dampers))
    document["rotor"] = {
        "kind": "matrices",
        "mass_matrix": rotor.mass.tolist(),
        "stiffness_matrix": (springs + np.kron(np.eye(2), rotor.elastic)).tolist(),
        "damping_matrix": dampers.tolist(),
        "planes": document["rotor"]["stations"],
        "stations": document["rotor"]["stations"],
        "supports": document["rotor"]["supports"],
        "unbalances": document["rotor"]["unbalances"],
    }
    document.pop("check", None)
    by_matrices = ab.Scene.from_document(document)
    found, right = (
        each.speeds(3.0, 4.5, "proved", narrowest=0.01).proof.bands for each in (by_matrices, shaft)
    )
    assert [band.state for band in found] == ["unstable", "undecided", "stable"]
    assert [band.low for band in found] == pytest.approx([band.low for band in right], abs=0.01)
