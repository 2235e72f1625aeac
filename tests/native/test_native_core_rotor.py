"""The rotor's matrices and steps in C against those of the Python unit and SciPy, random rotors."""

from __future__ import annotations

import ctypes
import math
from ctypes import POINTER, byref, c_double
from dataclasses import replace

import mpmath
import numpy as np
import pytest
from numpy.polynomial import Polynomial
from scipy.integrate import solve_ivp

from autobalancer.models.rotor import LinearRotor
from autobalancer.models.steps.propagator import exponential, generator, step_matrix
from autobalancer.models.steps.variable_speed import Drive, VariableSpeedStep
from tests.native.equations import STEADY

KINDS = ("planar", "two_support", "flexible")


def _log(random, low, high, size=None):
    return 10.0 ** random.uniform(math.log10(low), math.log10(high), size)


def _pair(random, isotropic, low, high, zero=False):
    """Values per support and axis, (2, 2)."""
    values = np.zeros((2, 2)) if zero else _log(random, low, high, (2, 2))
    return np.repeat(values[:, :1], 2, axis=1) if isotropic else values


def _unbalances(random, places, count):
    return [
        (float(random.choice(places)), *_log(random, 1e-6, 1e-1, 1).tolist(), random.uniform(-7, 7))
        for _ in range(count)
    ]


def _flat(values):
    return np.ascontiguousarray(values, float).ravel()


class Draw:
    """A random rotor of a kind, in Python and in C."""

    def __init__(
        self, core, module, kind, seed, stations=None, planes=None, compliance=False, stiffest=1e14
    ):
        self.stiffest = stiffest
        self.core, self.c, self.random = core, module, np.random.default_rng(seed)
        self.isotropic = bool(seed % 2)
        self.zero_damping = seed % 5 == 0
        self.planes = planes or int(self.random.integers(1, 4))
        self.stations = stations
        self.compliance = compliance
        self.python, self.native = getattr(self, kind)()

    def _c(self, values):
        return (ctypes.c_double * len(values))(*values)

    def _pointer(self, values):
        self.kept = [*getattr(self, "kept", []), _flat(values)]
        return self.kept[-1].ctypes.data_as(ctypes.POINTER(ctypes.c_double))

    def planar(self):
        r = self.random
        (k, _), (c, _) = (
            _pair(r, self.isotropic, *of, zero)
            for of, zero in (((1.0, self.stiffest), False), ((1e-3, 1e4), self.zero_damping))
        )
        values = {"mass": _log(r, 0.1, 1e3), "stiffness": k, "damping": c}
        values |= {"internal_damping": float(r.choice([0.0, 7.0])), "unbalance": _log(r, 1e-6, 1.0)}
        values |= {"unbalance_angle": r.uniform(-9.0, 9.0)}
        python = LinearRotor.planar(**values)
        object.__setattr__(python, "planes", np.ones((self.planes, 1)))
        values |= {"stiffness": self._c(k), "damping": self._c(c)}
        return python, self.core.rotor("planar", 1, self.planes, self.c.Planar(**values))

    def two_support(self):
        r = self.random
        span = r.uniform(0.1, 2.0)
        inertia = _log(r, 0.01, 10.0)
        values = {"mass": _log(r, 1.0, 100.0), "inertia": inertia, "span": span}
        values |= {
            "polar_inertia": r.uniform(0.0, 2.0) * inertia,
            "com": r.uniform(-0.2, 1.2) * span,
        }
        k = _pair(r, self.isotropic, 1e3, self.stiffest)
        c = _pair(r, self.isotropic, 0.1, 1e3, self.zero_damping)
        places = r.uniform(-0.2, 1.2, self.planes) * span
        unbalances = _unbalances(r, places, int(r.integers(0, 4)))
        python = LinearRotor.two_support(
            **values, stiffness=k, damping=c, planes=places, unbalances=unbalances
        )
        native = self.c.TwoSupport(
            **values,
            stiffness=self._c(_flat(k)),
            damping=self._c(_flat(c)),
            planes=self._pointer(places),
            unbalance_count=len(unbalances),
            unbalances=self._pointer(unbalances),
        )
        return python, self.core.rotor("two_support", 2, self.planes, native)

    def flexible(self):
        r = self.random
        n = self.stations or int(r.integers(2, 8))
        z = np.cumsum(r.uniform(0.05, 0.3, n))
        masses = _log(r, 0.1, 50.0, n)
        supports = (r.choice(n, 2, replace=False) + 1).tolist()
        k = _pair(r, self.isotropic, 1e3, self.stiffest)
        c = _pair(r, self.isotropic, 0.1, 1e3, self.zero_damping)
        places = z if self.compliance else [*z, *r.uniform(z[0], z[-1], n)]
        unbalances = _unbalances(r, places, int(r.integers(0, 4)))
        internal = float(r.choice([0.0, 3.0])) if n > 2 else 0.0
        shaft = {"bending_stiffness": _log(r, 1e2, self.stiffest**0.5)}
        if self.compliance:
            root = r.normal(size=(n - 2, n - 2))
            shaft = {"compliance": 1e-6 * (root @ root.T + np.eye(n - 2))}
        python = LinearRotor.flexible(
            stations=z,
            masses=masses,
            supports=supports,
            support_stiffness=k,
            support_damping=c,
            internal_damping=internal,
            unbalances=unbalances,
            **shaft,
        )
        ports = r.integers(0, n, self.planes)
        object.__setattr__(python, "planes", python.planes[ports])
        native = self.c.Flexible(
            stations=self._pointer(z),
            masses=self._pointer(masses),
            supports=(ctypes.c_int * 2)(*supports),
            support_stiffness=self._c(_flat(k)),
            support_damping=self._c(_flat(c)),
            internal_damping=internal,
            bending_stiffness=shaft.get("bending_stiffness", math.nan),
            unbalance_count=len(unbalances),
            unbalances=self._pointer(unbalances),
            ports=(ctypes.c_int * self.planes)(*ports.tolist()),
        )
        if self.compliance:
            native.compliance = self._pointer(shaft["compliance"])
        return python, self.core.rotor("flexible", n, self.planes, native)


@pytest.fixture(scope="session")
def drawn(core):
    from functools import partial

    return partial(Draw, core, core.structures)


def _arrays(rotor):
    n, p = rotor.stations, rotor.plane_count
    arrays = [name for name, type_ in rotor._fields_ if type_ is POINTER(c_double)]
    sizes = dict.fromkeys(arrays, (n, n)) | {"planes": (p, n), "unbalance": (2 * n,)}
    sizes["deflection"] = (rotor.deflections, n)
    return {
        name: np.ctypeslib.as_array(getattr(rotor, name), shape).copy()
        for name, shape in sizes.items()
    }


def _largest_difference(found, expected):
    """Over the largest element of a matrix; 0 when both are 0."""
    size = np.abs(expected).max(initial=0.0)
    return np.abs(found - expected).max(initial=0.0) / (size or 1.0)


@pytest.mark.parametrize("kind", KINDS)
def test_matrices_of_every_kind_are_those_of_python(drawn, kind):
    for seed in range(60):
        draw = drawn(kind, seed)
        for name, found in _arrays(draw.native).items():
            expected = getattr(draw.python, name)
            if name == "unbalance":
                found = found.view(complex)
            assert found.shape == expected.shape, name
            # the shaft's stiffness is the inverse of its compliance: conditioned up to 1e3 here
            assert _largest_difference(found, expected) < 1e-12, (name, seed)


def test_matrices_from_a_measured_compliance_are_those_of_python(drawn):
    for seed in range(30):
        draw = drawn("flexible", seed, stations=3 + seed % 5, compliance=True)
        expected = draw.python.stiffness_y
        assert _largest_difference(_arrays(draw.native)["stiffness_y"], expected) < 1e-12


def _added(draw, gravity=0j):
    """Both rotors with the same masses at their planes."""
    added = draw.random.uniform(0.0, 2.0, draw.planes) * (draw.random.random() < 0.7)
    n = draw.native.stations
    mass = np.zeros(n * n)
    # of the same matrices: a shaft's stiffness differs by as much as its condition lets it
    python = replace(draw.python, gravity=gravity)
    native = draw.core.rotor_of(python)
    loaded = draw.core("linear_rotor_with_added_mass", byref(native), added, mass)
    loaded.memory = (native.memory, mass)
    return python.with_added_mass(added), loaded


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


@pytest.mark.parametrize("order", [3, 5])
@pytest.mark.parametrize("turning", [True, False])
@pytest.mark.parametrize("kind", KINDS)
def test_step_matrices_are_those_of_python(drawn, kind, turning, order):
    compute = step_matrix if order == 3 else _under_quintic_forces
    worst = 0.0
    for seed in range(40):
        draw = drawn(kind, seed)
        python, loaded = _added(draw)
        speed = float(draw.random.choice([0.0, draw.random.uniform(-900.0, 900.0)]))
        step = float(draw.random.choice([0.0, _log(draw.random, 1e-8, 1e-2)]))
        expected = compute(python, speed, step, turning)
        found = draw.core.step_matrix(loaded, speed, step, turning, order)
        assert found.shape == expected.shape
        assert found.dtype == expected.dtype
        worst = max(worst, _scaled_difference(found, expected))
    assert worst < 1e-11, worst


@pytest.mark.parametrize(("stations", "planes"), [(20, 20), (20, 2), (12, 5)])
@pytest.mark.parametrize("seed", [0, 1])
def test_step_matrices_of_long_shafts_are_those_of_python(drawn, stations, planes, seed):
    draw = drawn("flexible", seed, stations=stations, planes=planes)
    expected = step_matrix(draw.python, 300.0, 1e-3)
    found = draw.core.step_matrix(draw.core.rotor_of(draw.python), 300.0, 1e-3, True)
    assert _scaled_difference(found, expected) < 1e-11


@pytest.mark.parametrize("seed", range(6))
def test_stiffness_of_long_shafts_is_that_of_python_as_far_as_its_condition_lets_it(drawn, seed):
    draw = drawn("flexible", seed, stations=20)
    expected = draw.python.stiffness_x
    values = np.linalg.eigvalsh(draw.python.stiffness_x)
    condition = values[-1] / values[values > 1e-9 * values[-1]].min()
    assert _largest_difference(_arrays(draw.native)["stiffness_x"], expected) < 1e-15 * condition


def test_exponential_keeps_a_soft_axis_beside_one_of_1e14(core):
    rotor = LinearRotor.planar(2.0, (1e14, 1.0), (0.0, 0.0))
    found = core.step_matrix(core.rotor_of(rotor), 0.0, 1e-3, True)
    frequency = math.sqrt(0.5)
    assert found[1, 1] == pytest.approx(math.cos(frequency * 1e-3), rel=1e-15)
    assert found[1, 3] == pytest.approx(math.sin(frequency * 1e-3) / frequency, rel=1e-14)


@pytest.mark.parametrize("zeros", [0, 3])
def test_exponential_is_that_of_python(core, zeros):
    """In the rows before those that begin with zeros."""
    random = np.random.default_rng(3)
    for dtype, parts in ((float, 1), (complex, 2)):
        for size in (3, 6, 9):
            a = random.normal(size=(size, size)) * _log(random, 1e-6, 1e2)
            a = a + (1j * random.normal(size=a.shape) if parts == 2 else 0.0)
            upper = max(3, size - zeros)
            a[upper:, :upper] = 0.0
            native = np.array(a, dtype)
            scratch, kept = np.empty(3 * parts * size**2), core.doublings(parts * size**2)
            core.demand("exponential", parts, size, upper, native, scratch, byref(kept))
            expected = exponential(np.array(a, dtype))
            assert _largest_difference(native[:upper], expected[:upper]) < 1e-12


def test_what_a_step_is_doubled_from_changes_no_bit(core):
    """Of five families, up and down: some are written over, and some are too long to begin from."""
    kept = core.doublings(14 * 14)
    rotor = core.rotor_of(LinearRotor.planar(1.0, (1e4, 4e4), (3.0, 40.0)))
    for power in (5, 3, 0, -2, 1, 4, -4):
        for family in (1.0, 0.84, 0.7, 0.6, 0.55, 1.0):
            step = 1e-3 * family * 2.0**-power
            found = core.step_matrix(rotor, 250.0, step, True, kept=kept)
            assert found.tobytes() == core.step_matrix(rotor, 250.0, step, True).tobytes()


def test_a_matrix_that_is_not_finite_is_refused(core):
    rotor = LinearRotor.planar(1.0, 1e300, 1.0)
    with pytest.raises(core.Refused) as refused:
        core.step_matrix(core.rotor_of(rotor), 1.0, 1e300, True)
    assert refused.value.code == core.codes["FAILURE_MATRICES"]
    with pytest.raises(OverflowError), np.errstate(over="ignore"):
        step_matrix(rotor, 1.0, 1e300)


def _variable(draw, rotor, turning):
    """The C step of a rotor at varying speed, as functions like those of `VariableSpeedStep`.

    `rates`: derivatives of the angular acceleration of order 1 to 3.
    """
    core, axes = draw.core, 1 if draw.isotropic else 2
    sizes = rotor.stations, rotor.plane_count, axes
    made = core.structures.VariableSpeedStep()
    memory = np.empty(core("variable_speed_size", *sizes))
    scratch = np.full(core("variable_speed_scratch", *sizes), math.nan)
    core.demand("variable_speed_step", byref(rotor), int(turning), memory, scratch, byref(made))
    kept = memory, scratch

    def told(drive, rates):
        return drive.angle, drive.speed, np.array([drive.angular_acceleration, *rates])

    def advance(state, drive, step, parts=None, rates=STEADY):
        state = state.copy()
        name, rest = "variable_speed_advance", [*told(drive, rates), step]
        if parts is not None:
            name = "variable_speed_parts"
            rest.append(parts)
        core.demand(name, byref(made), state, drive.forces, *rest, kept[1])
        return state

    def plane_motion(state, drive, t, rates=STEADY):
        acceleration, jerk = (np.empty(axes * rotor.plane_count, state.dtype) for _ in range(2))
        core(
            "variable_speed_plane_motion", byref(made), state, drive.forces,
            *told(drive, rates), t, acceleration, jerk, scratch,
        )  # fmt: skip
        return acceleration, jerk

    return advance, plane_motion


def _variable_case(draw, turning):
    """Both steps of a random rotor, and a random state and drive."""
    random = draw.random
    python, loaded = _added(draw, (2.0 - 9.0j) * turning)
    method = VariableSpeedStep(python, turning)
    state = random.normal(size=2 * method.dof)
    if draw.isotropic:
        state = state + 1j * random.normal(size=state.shape)
    forces = random.normal(size=(4, draw.planes)) + 1j * random.normal(size=(4, draw.planes))
    drive = random.uniform(-9, 9), random.uniform(0, 900), random.uniform(-500, 500)
    rates = (*(random.normal(size=3) * [1e4, 1e6, 1e8]),)  # of the acceleration, where C has them
    step, both = float(_log(random, 1e-7, 1e-2)), _variable(draw, loaded, turning)
    return python, method, both, (state, Drive(forces, *drive)), step, rates


@pytest.mark.parametrize("turning", [True, False])
@pytest.mark.parametrize("kind", KINDS)
def test_steps_at_varying_speed_are_those_of_python(drawn, kind, turning):
    worst = np.zeros(3)
    for seed in range(40):
        draw = drawn(kind, seed, stiffest=1e6)
        _, method, (advance, plane_motion), case, step, _ = _variable_case(draw, turning)
        expected = method.advance(*case, step)
        case_end = (expected, *case[1:], step)
        pairs = [
            (advance(*case, step), expected),
            *zip(plane_motion(*case_end), method.plane_motion(*case_end), strict=True),
        ]
        worst = np.maximum(worst, [_largest_difference(*pair) for pair in pairs])
    assert (worst < 1e-12).all(), worst


@pytest.mark.parametrize("kind", KINDS)
def test_steps_at_changing_acceleration_are_those_of_scipy(drawn, kind):
    """State, acceleration and jerk under a cubic w', against the equation as it is written."""
    for seed in range(4):
        draw = drawn(kind, seed, stiffest=1e5)
        case, h = _variable_case(draw, True), 2e-3
        rotor, method, (advance, plane_motion), (state, drive), _, rates = case
        spin = [drive.speed, drive.angular_acceleration, *rates]
        speed = Polynomial(np.array(spin) / [1, 1, 2, 6, 24])
        cubics = [Polynomial(f / [1, 1, 2, 6]) for f in drive.forces.T]
        inverse = np.linalg.inv(rotor.coefficients(0.0)[0])

        def acceleration(t, y, rotor=rotor, drive=drive, speed=speed, cubics=cubics, m=inverse):
            w, w1 = speed(t), speed.deriv()(t)
            turn = np.exp(1j * (drive.angle + speed.integ()(t)))
            push = rotor.planes.T @ [f(t) for f in cubics] + rotor.unbalance * (w * w - 1j * w1)
            push = push * turn
            if not rotor.isotropic:
                push = np.concatenate([push.real, push.imag])
            _, damping, stiffness = rotor.coefficients(w)
            q, v = np.split(y, 2)
            # gravity acts on every mass alike
            return m @ (push - damping @ v - stiffness @ q) + rotor.falling

        def rhs(t, y, acceleration=acceleration):
            return np.concatenate([np.split(y, 2)[1], acceleration(t, y)])

        d = 1e-7
        times = [h - d, h, h + d]
        found = solve_ivp(rhs, (0, times[-1]), state, "DOP853", times, rtol=1e-12, atol=1e-14)
        before, here, after = found.y.T
        reached = advance(state, drive, h, rates=rates)
        assert _largest_difference(reached, here) < 1e-8
        lateral = np.kron(np.eye(method.axes), rotor.planes)
        jerk = (acceleration(h + d, after) - acceleration(h - d, before)) / (2.0 * d)
        seen = plane_motion(reached, drive, h, rates=rates)
        assert _largest_difference(seen[0], lateral @ acceleration(h, reached)) < 1e-10
        assert _largest_difference(seen[1], lateral @ jerk) < 1e-4


def _exact_step(rotor, case, step):
    """Radau IIA of three stages with 60 digits, from the equation of motion as it is written.

    M z'' + C z' + K z = S^T F e^{i beta} + u (w^2 - i w') e^{i beta}, z = x + i y; with two axes
    real and imaginary part of the right-hand side are those of x and y.
    """
    state, (forces, angle, speed, spin_up) = case
    real = mpmath.mpf
    exact = np.vectorize(mpmath.mpmathify, otypes=[object])
    root = mpmath.sqrt(6)
    nodes = [(4 - root) / 10, (4 + root) / 10, real(1)]
    # the collocation polynomial through the nodes integrates t^0, t^1, t^2 exactly
    powers = mpmath.matrix([[c**k for c in nodes] for k in range(3)])
    moments = mpmath.matrix([[c ** (k + 1) / (k + 1) for c in nodes] for k in range(3)])
    weights = np.array((powers**-1 * moments).T.tolist(), object)
    dof, size = len(state) // 2, len(state)
    system, right = mpmath.eye(3 * size), mpmath.matrix(3 * size, 1)
    for i, node in enumerate(nodes):
        t = node * real(step)
        w = real(speed) + real(spin_up) * t
        # exact in w: its coefficients are linear in it
        at_0, at_1 = rotor.coefficients(0.0), rotor.coefficients(1.0)
        mass, damping, stiffness = (
            exact(a) + w * (exact(b) - exact(a)) for a, b in zip(at_0, at_1, strict=True)
        )
        turn = mpmath.expj(real(angle) + real(speed) * t + real(spin_up) * t * t / 2)
        f = exact(forces)
        value = f[0] + t * (f[1] + t * (f[2] / 2 + t * f[3] / 6))
        pull = exact(rotor.unbalance) * mpmath.mpc(w * w, -real(spin_up))
        push = (exact(rotor.planes.T) @ value + pull) * turn
        if not rotor.isotropic:
            push = np.array([z.real for z in push] + [z.imag for z in push], object)
        inverse = np.array((mpmath.matrix(mass.tolist()) ** -1).tolist(), object)
        matrix = exact(np.zeros((size, size)))
        matrix[:dof, dof:] = exact(np.eye(dof))
        matrix[dof:] = np.hstack([-inverse @ stiffness, -inverse @ damping])
        rates = matrix @ exact(state)
        rates[dof:] += inverse @ push
        for k in range(size):
            right[i * size + k] = rates[k]
            for j, column in np.ndindex(3, size):
                share = real(step) * weights[i, j]
                system[i * size + k, j * size + column] -= share * matrix[k, column]
    stages = np.array(mpmath.lu_solve(system, right).tolist(), object).reshape(3, size)
    return (exact(state) + real(step) * (weights[2] @ stages)).astype(complex)


@pytest.mark.parametrize("kind", KINDS[:2])
def test_steps_at_varying_speed_on_stiff_supports_are_as_exact_as_those_of_python_within_a_digit(
    drawn, kind
):
    ours = theirs = 0.0
    with mpmath.workdps(60):
        for seed in range(12):
            draw = drawn(kind, seed)
            python, method, (advance, _), (state, drive), step, _ = _variable_case(draw, True)
            case = state, drive
            exact = _exact_step(python, case, step)
            ours = max(ours, _largest_difference(advance(*case, step, parts=1), exact))
            theirs = max(theirs, _largest_difference(method.parts(*case, step, 1), exact))
    assert ours < 10.0 * theirs, (ours, theirs)


def test_a_step_of_a_long_shaft_at_varying_speed_is_that_of_python(drawn):
    draw = drawn("flexible", 2, stations=20, planes=3, stiffest=1e5)
    method = VariableSpeedStep(draw.python)
    advance, _ = _variable(draw, draw.core.rotor_of(draw.python), True)
    state = draw.random.normal(size=2 * method.dof)
    case = state, Drive(np.ones((4, 3), complex), 0.3, 100.0, 50.0), 1e-3
    assert _largest_difference(advance(*case), method.advance(*case)) < 1e-12
