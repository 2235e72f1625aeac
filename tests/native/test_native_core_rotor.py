"""The rotor's step matrices in C against the exponential of its generator, random rotors."""

from __future__ import annotations

import math
from ctypes import byref
from dataclasses import replace

import numpy as np
import pytest

from autobalancer.harness import Scene
from autobalancer.models.rotor import LinearRotor
from autobalancer.models.steps.propagator import step_matrix
from tests.studies.truth.draw import draw

KINDS = ("planar", "two_support", "flexible")
STIFFER = 1e4  # at most, than the rotors that are drawn: up to 1e14 N/m


def _log(random, low, high):
    return 10.0 ** random.uniform(math.log10(low), math.log10(high))


class Draw:
    """A random rotor of a kind as of `tests.studies.truth`, with masses at its planes.

    Attributes:
        python: the description; `native`, the same matrices in C.
    """

    def __init__(self, core, kind, seed, stations=None, planes=None):
        self.random = random = np.random.default_rng(seed)
        document = draw(kind, 1, seed)
        table = document["rotor"]
        if kind == "planar":
            table["internal_damping"] = 7.0 * (seed % 3 == 0)
        if stations:
            table["stations"] = np.linspace(0.0, table["stations"][-1], stations).tolist()
            table |= {"masses": table["masses"][:1] * stations, "supports": [1, stations]}
            table["unbalances"][0]["position"] = 0.0
        rotor = Scene.from_document({**document, "balancer": []}).rotor.build()
        planes = planes or int(random.integers(1, 4))
        bare = replace(rotor, planes=rotor.planes[random.integers(0, rotor.plane_count, planes)])
        stiffer = _log(random, 1.0, STIFFER)
        bare = replace(
            bare,
            elastic=stiffer * bare.elastic,
            supports=tuple(replace(s, stiffness=stiffer * s.stiffness) for s in bare.supports),
        )
        if seed % 2:  # isotropic: a complex system of half the size
            bare = replace(bare, supports=tuple(_alike(s) for s in bare.supports))
        elif seed % 4:  # cross terms
            twist = random.uniform(-1.0, 1.0, (2, 2))[..., None, None]
            bare = replace(
                bare,
                supports=tuple(
                    replace(s, stiffness=s.stiffness + twist * s.stiffness[0, 0],
                            damping=s.damping + twist * s.damping[0, 0])
                    for s in bare.supports
                ),
            )  # fmt: skip
        added = random.uniform(0.0, 2.0, planes) * (random.random() < 0.7)
        self.python = bare.with_added_mass(added)
        native, mass = core.rotor_of(bare), np.zeros(bare.stations**2)
        self.native = core("linear_rotor_with_added_mass", byref(native), added, mass)
        self.native.memory = native.memory, mass


def _alike(support):
    """The support with that of x along both axes."""
    same = np.eye(2)[..., None, None]
    return replace(
        support, stiffness=same * support.stiffness[0, 0], damping=same * support.damping[0, 0]
    )


def _scaled_difference(found, expected):
    """Largest difference over the largest element of the same row."""
    scale = np.abs(expected).max(axis=1, keepdims=True)
    return (np.abs(found - expected) / np.where(scale == 0.0, 1.0, scale)).max()


CASES = [(kind, {}, range(40)) for kind in KINDS]
CASES += [("flexible", {"stations": 20, "planes": planes}, range(2)) for planes in (20, 2)]


@pytest.mark.parametrize("turning", [True, False])
@pytest.mark.parametrize(("kind", "sizes", "seeds"), CASES)
def test_step_matrices_are_exponentials_of_the_generator(core, kind, sizes, seeds, turning):
    worst = 0.0
    for seed in seeds:
        one = Draw(core, kind, seed, **sizes)
        speed = float(one.random.choice([0.0, one.random.uniform(-900.0, 900.0)]))
        step = float(one.random.choice([0.0, _log(one.random, 1e-8, 1e-2)]))
        expected = step_matrix(one.python, speed, step, turning)
        found = core.step_matrix(one.native, speed, step, turning)
        assert (found.shape, found.dtype) == (expected.shape, expected.dtype)
        worst = max(worst, _scaled_difference(found, expected))
    assert worst < 1e-11, worst


def test_exponential_keeps_a_soft_axis_beside_one_of_1e14(core):
    rotor = LinearRotor.planar(2.0, (1e14, 1.0), (0.0, 0.0))
    found = core.step_matrix(core.rotor_of(rotor), 0.0, 1e-3, True)
    frequency = math.sqrt(0.5)
    assert found[1, 1] == pytest.approx(math.cos(frequency * 1e-3), rel=1e-15)
    assert found[1, 3] == pytest.approx(math.sin(frequency * 1e-3) / frequency, rel=1e-14)
