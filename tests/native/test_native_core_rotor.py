"""The rotor's step matrices in C against the exponential of its generator, random rotors."""

from __future__ import annotations

import math
from ctypes import byref
from dataclasses import replace

import numpy as np
import pytest

from autobalancer.models.rotor import LinearRotor
from autobalancer.models.steps.propagator import exponential, generator, step_matrix

KINDS = ("planar", "two_support", "flexible")
STIFFEST = 1e14  # N/m


def _log(random, low, high, size=None):
    return 10.0 ** random.uniform(math.log10(low), math.log10(high), size)


class Draw:
    """A random rotor of a kind, with masses at its planes.

    Attributes:
        python: the description; `native`, the same matrices in C.
    """

    def __init__(self, core, kind, seed, stations=None, planes=None):
        self.core, self.random = core, np.random.default_rng(seed)
        self.isotropic, self.zero_damping = bool(seed % 2), seed % 5 == 0
        self.planes = planes or int(self.random.integers(1, 4))
        bare = getattr(self, kind)(stations)
        added = self.random.uniform(0.0, 2.0, self.planes) * (self.random.random() < 0.7)
        self.python = bare.with_added_mass(added)
        native, mass = core.rotor_of(bare), np.zeros(bare.stations**2)
        self.native = core("linear_rotor_with_added_mass", byref(native), added, mass)
        self.native.memory = native.memory, mass

    def _supports(self, softest):
        """Stiffness and damping per support and axis, (2, 2) each."""
        values = (
            _log(self.random, softest, STIFFEST, (2, 2)),
            _log(self.random, 0.1, 1e3, (2, 2)),
        )
        if self.isotropic:
            values = tuple(np.repeat(value[:, :1], 2, axis=1) for value in values)
        return values[0], values[1] * (not self.zero_damping)

    def planar(self, _stations):
        r, (k, c) = self.random, self._supports(1.0)
        unbalance = {"unbalance": _log(r, 1e-6, 1.0), "unbalance_angle": r.uniform(-9.0, 9.0)}
        inner = float(r.choice([0.0, 7.0]))
        rotor = LinearRotor.planar(_log(r, 0.1, 1e3), k[0], c[0], inner, **unbalance)
        return replace(rotor, planes=np.ones((self.planes, 1)))

    def two_support(self, _stations):
        r, (k, c) = self.random, self._supports(1e3)
        span, inertia = r.uniform(0.1, 2.0), _log(r, 0.01, 10.0)
        return LinearRotor.two_support(
            mass=_log(r, 1.0, 100.0), inertia=inertia, polar_inertia=r.uniform(0.0, 2.0) * inertia,
            span=span, com=r.uniform(-0.2, 1.2) * span, stiffness=k, damping=c,
            planes=r.uniform(-0.2, 1.2, self.planes) * span, unbalances=[(0.3 * span, 1e-3, 2.0)],
        )  # fmt: skip

    def flexible(self, stations):
        r, (k, c) = self.random, self._supports(1e3)
        n = stations or int(r.integers(2, 8))
        z = np.cumsum(r.uniform(0.05, 0.3, n))
        rotor = LinearRotor.flexible(
            stations=z, masses=_log(r, 0.1, 50.0, n), support_stiffness=k, support_damping=c,
            supports=(r.choice(n, 2, replace=False) + 1).tolist(),
            internal_damping=float(r.choice([0.0, 3.0])) if n > 2 else 0.0,
            unbalances=[(z[0], 1e-3, 0.5), (z[-1], 1e-4, -3.0)],
            bending_stiffness=_log(r, 1e2, STIFFEST**0.5),
        )  # fmt: skip
        return replace(rotor, planes=rotor.planes[r.integers(0, n, self.planes)])


def _scaled_difference(found, expected):
    """Largest difference over the largest element of the same row."""
    scale = np.abs(expected).max(axis=1, keepdims=True)
    return (np.abs(found - expected) / np.where(scale == 0.0, 1.0, scale)).max()


def _under_quintic_forces(rotor, speed, step, turning):
    """The step matrix with two more derivatives of the forces, and one of the planes' jerk."""
    z, axes = generator(rotor, speed, turning), 1 if rotor.isotropic else 2
    dof, f = axes * rotor.stations, axes * rotor.plane_count
    begin, end = 2 * dof, len(z) - axes
    longer = np.zeros((len(z) + 2 * f,) * 2, z.dtype)
    kept = [*range(end), *range(len(longer) - axes, len(longer))]
    longer[np.ix_(kept, kept)] = z
    for first in range(begin + 3 * f, begin + 6 * f, f):  # f_k' = i w f_k + f_{k+1}
        here = slice(first, first + f)
        longer[here, here] = z[begin : begin + f, begin : begin + f]
        if first < begin + 5 * f:
            longer[here, first + f : first + 2 * f] = np.eye(f)
    moved = exponential(longer * step) if step else np.eye(len(longer), dtype=z.dtype)
    rows = [np.kron(np.eye(axes), rotor.planes) @ moved[dof : 2 * dof] @ longer]
    rows += [rows[0] @ longer, rows[0] @ longer @ longer]
    return np.vstack([moved[: 2 * dof], *rows])


CASES = [(kind, {}, order, range(40)) for kind in KINDS for order in (3, 5)]
CASES += [("flexible", {"stations": 20, "planes": planes}, 3, range(2)) for planes in (20, 2)]


@pytest.mark.parametrize("turning", [True, False])
@pytest.mark.parametrize(("kind", "sizes", "order", "seeds"), CASES)
def test_step_matrices_are_exponentials_of_the_generator(core, kind, sizes, order, seeds, turning):
    compute = step_matrix if order == 3 else _under_quintic_forces
    worst = 0.0
    for seed in seeds:
        draw = Draw(core, kind, seed, **sizes)
        speed = float(draw.random.choice([0.0, draw.random.uniform(-900.0, 900.0)]))
        step = float(draw.random.choice([0.0, _log(draw.random, 1e-8, 1e-2)]))
        expected = compute(draw.python, speed, step, turning)
        found = core.step_matrix(draw.native, speed, step, turning, order)
        assert (found.shape, found.dtype) == (expected.shape, expected.dtype)
        worst = max(worst, _scaled_difference(found, expected))
    assert worst < 1e-11, worst


def test_exponential_keeps_a_soft_axis_beside_one_of_1e14(core):
    rotor = LinearRotor.planar(2.0, (1e14, 1.0), (0.0, 0.0))
    found = core.step_matrix(core.rotor_of(rotor), 0.0, 1e-3, True)
    frequency = math.sqrt(0.5)
    assert found[1, 1] == pytest.approx(math.cos(frequency * 1e-3), rel=1e-15)
    assert found[1, 3] == pytest.approx(math.sin(frequency * 1e-3) / frequency, rel=1e-14)


def test_a_matrix_that_is_not_finite_is_refused(core):
    rotor = LinearRotor.planar(1.0, 1e300, 1.0)
    with pytest.raises(core.Refused) as refused:
        core.step_matrix(core.rotor_of(rotor), 1.0, 1e300, True)
    assert refused.value.code == core.codes["FAILURE_MATRICES"]
