"""Weights that collide, pack, stick and run off centre: the C equations against Python's.

Collisions make neighbouring motions part, so every step starts from the state Python has reached:
what is compared is one step with all that happens in it.
"""

from __future__ import annotations

import ctypes
import math
from ctypes import byref

import numpy as np
import pytest

from autobalancer.models.contact.contact import Pools, collide, group_factor, pool, pressure_factors
from autobalancer.models.contact.motion import advance, first_contacts, reaction, static_moment
from autobalancer.models.contact.pulse import discharge, hat_half
from autobalancer.models.contact.roots import lowest
from autobalancer.models.contact.track import Track
from autobalancer.models.spin import STEADY
from autobalancer.models.weights import Weights

STEP = 5e-3


class Pair:
    """One track in Python and in C."""

    def __init__(self, core, *values):
        (count, mass, radius, drag, kappa), options = values[:5], values[5:]
        *numbers, offset = options
        self.core, self.count = core, count
        self.python = Track(Weights(count, mass, radius, drag, kappa), *numbers, offset)
        points = core.structures.Weights(count, mass, radius, drag, kappa)
        pair = core.structures.Complex(offset.real, offset.imag)
        self.native = core.structures.Track(points, *numbers, pair)
        core.demand("track_prepare", byref(self.native))
        self.scratch = np.full(core("track_scratch", count), math.nan)

    def advance(self, state, signal, *drive, stop=0, rates=STEADY):
        """Angles, speeds and contacts after a step, and the structure `Moved`."""
        state = [np.array(values, float) for values in state]
        ends = [np.empty(self.count) for _ in range(3)]
        moved = self.core.structures.Moved(
            *(values.ctypes.data_as(ctypes.POINTER(ctypes.c_double)) for values in ends)
        )
        self.core.demand(
            "track_advance", byref(self.native), *state, np.array(signal, complex), drive[0],
            np.array([drive[1], *rates], float), drive[2], stop, byref(moved), self.scratch,
        )  # fmt: skip
        return ends, moved

    def reaction(self, state, a, slope, *drive):
        state = [np.array(values, float) for values in state]
        force, force_slope = self.core.structures.Complex(), self.core.structures.Complex()
        self.core.demand(
            "track_reaction", byref(self.native), *state, a, slope, *drive, 0.0, byref(force),
            byref(force_slope), self.scratch,
        )  # fmt: skip
        return complex(force.re, force.im), complex(force_slope.re, force_slope.im)

    def reaction_change(self, state, drive, by):
        """Changes of force and slope; `drive` and `by` are a, slope, speed and w'."""
        c = self.core.structures
        state = [np.array(values, float) for values in state]
        pairs = [c.Complex(z.real, z.imag) for z in by[:2]]
        force, force_slope = c.Complex(), c.Complex()
        self.core.demand(
            "track_reaction_change", byref(self.native), *state, *drive,
            byref(c.Instant(*pairs, by[2])), by[3], 0.0, byref(force), byref(force_slope),
            self.scratch,
        )  # fmt: skip
        return complex(force.re, force.im), complex(force_slope.re, force_slope.im)

    def first_contacts(self, angles, speeds):
        contacts = np.empty(self.count)
        self.core.demand(
            "track_first_contacts", byref(self.native), np.array(angles, float),
            np.array(speeds, float), contacts, self.scratch,
        )  # fmt: skip
        return contacts.tolist()


def _start(random, pair):
    """Weights apart by random gaps, some of which are closed."""
    n, alpha = pair.count, pair.python.alpha
    room = math.tau - 2.0 * n * alpha
    gaps = random.dirichlet(np.ones(n)) * room
    if n > 2 and alpha and random.random() < 0.5:
        gaps[random.integers(n)] += gaps[0]
        gaps[0] = 0.0
    angles = np.cumsum(gaps + 2.0 * alpha) + random.uniform(-20.0, 20.0)
    speeds = np.where(random.random(n) < 0.3, 0.0, random.normal(size=n) * 20.0)
    order = random.permutation(n)
    angles, speeds = angles[order].tolist(), speeds[order].tolist()
    return angles, speeds, first_contacts(pair.python, angles, speeds)


def _signal(random, size):
    rates = size * np.array([1.0, 30.0, 1e3, 3e4])
    return (random.normal(size=(4, 2)) @ [1.0, 1.0j] * rates).tolist()


#: count, radius of the weights over the largest that fit, restitution, rolling resistance, offset
TRACKS = {
    "point": (3, 0.0, 0.0, 0.0, 0j),
    "offset": (3, 0.0, 0.0, 0.0, 2e-5 - 1e-5j),
    "plastic": (4, 0.4, 0.0, 0.0, 0j),
    "bouncing": (4, 0.5, 0.3, 0.0, 1e-5j),
    "elastic": (3, 0.6, 1.0, 0.0, 0j),
    "crowded": (8, 0.95, 0.5, 0.0, 0j),
    "full": (5, 1.0, 0.3, 1e-3, 0j),
    "sticking": (2, 0.0, 0.0, 2e-3, 0j),
    "sticking_alone": (1, 0.3, 0.0, 2e-2, 1e-5 + 0j),
    "sticking_packs": (6, 0.7, 0.4, 2e-3, 1e-5j),
}


#: what must happen in the steps that are compared without drag, or the comparison says little
HAPPENS = {
    "plastic": {"collision", "contact made", "contact opened"},
    "bouncing": {"collision", "contact made", "contact opened"},
    "elastic": {"collision"},
    "crowded": {"collision"},
    "full": {"came to rest", "broke away"},
    "sticking": {"came to rest", "broke away"},
    "sticking_alone": {"came to rest", "broke away"},
    "sticking_packs": {"collision", "came to rest", "broke away"},
}


@pytest.mark.parametrize("drag", [0.0, 0.05, 1e6])
@pytest.mark.parametrize("name", TRACKS)
def test_steps_with_all_that_happens_in_them_are_those_of_python(core, name, drag):
    count, share, restitution, resistance, offset = TRACKS[name]
    random = np.random.default_rng(len(name) + int(drag))
    radius = share * 0.05 * (math.sin(math.pi / count) if count > 1 else 1.0)
    pair = Pair(core, count, 0.01, 0.05, drag, 1.4, radius, restitution, resistance, offset)
    happened = set()
    for _ in range(14):
        state, speed = _start(random, pair), random.uniform(-300.0, 300.0)
        size = 10.0 ** random.uniform(-1.0, 2.5)
        for _ in range(12):
            signal = _signal(random, size)
            spin_up = float(random.choice([0.0, random.uniform(-90.0, 90.0)]))
            expected = advance(pair.python, *state, signal, speed, spin_up, STEP)
            ends, moved = pair.advance(state, signal, speed, spin_up, STEP)
            # every event is located to 1e-12 of a substep, and passes on what that leaves
            rates = max(1.0, *map(abs, expected.speeds), *map(abs, state[1]))
            rates *= 1 + expected.events
            assert moved.events == expected.events
            assert moved.reached == STEP
            assert ends[2].tolist() == expected.contacts
            assert np.abs(ends[0] - expected.angles).max() < 1e-12 * (1 + expected.events)
            assert np.abs(ends[1] - expected.speeds).max() < 1e-11 * rates
            impulse = complex(moved.impulse.re, moved.impulse.im)
            assert abs(impulse - expected.impulse) < 1e-11 * rates * 0.01 * 0.05 * count
            seen = _seen(state, expected[:3], expected.impulse)
            happened |= {kind for kind, has in seen.items() if has}
            state = expected[:3]
            force = pair.reaction(state, *signal[:2], speed, spin_up)
            exact = reaction(pair.python, *state, *signal[:2], speed, spin_up)
            assert force == pytest.approx(exact, rel=1e-12, abs=1e-12)
    assert drag or happened >= HAPPENS.get(name, set())


def _seen(state, expected, impulse):
    """Kinds of event that a step must have had, from the states before and after it."""
    before, after = np.array(state), np.array(expected)
    return {
        "collision": impulse != 0j,
        "contact made": bool((after[2] > before[2]).any()),
        "contact opened": impulse == 0j and bool((after[2] < before[2]).any()),
        "came to rest": bool(((after[1] == 0.0) & (before[1] != 0.0)).any()),
        "broke away": impulse == 0j and bool(((after[1] != 0.0) & (before[1] == 0.0)).any()),
    }


@pytest.mark.parametrize("name", TRACKS)
def test_changes_of_the_force_are_the_differences_of_forces(core, name):
    count, share, restitution, resistance, offset = TRACKS[name]
    random = np.random.default_rng(len(name))
    radius = share * 0.05 * (math.sin(math.pi / count) if count > 1 else 1.0)
    pair = Pair(core, count, 0.01, 0.05, 0.05, 1.4, radius, restitution, resistance, offset)
    for _ in range(40):
        state = _start(random, pair)
        size = 10.0 ** random.uniform(-1.0, 3.0)  # the larger ones load both walls of the race
        drive = np.array([*_signal(random, size)[:2], *random.uniform(-99.0, 99.0, 2)])
        by = np.array([*_signal(random, 1.0)[:2], *random.normal(size=2)])
        # what holds, touches or slides must be the same on both sides: differences that short
        steps = 1e-4, 2e-4

        def force_at(t, state=state, drive=drive, by=by):
            a, slope, speed, spin_up = (drive + t * by).tolist()
            return np.array(reaction(pair.python, *state, a, slope, speed.real, spin_up.real))

        near, far = ((force_at(t) - force_at(-t)) / (2.0 * t) for t in steps)
        exact = (4.0 * near - far) / 3.0  # polynomials of degree 3 at most: no error but rounding
        a, slope, speed, spin_up = drive.tolist()
        change = a, slope, speed.real, spin_up.real
        found = pair.reaction_change(state, change, [*by[:2].tolist(), *by[2:].real.tolist()])
        scale = np.maximum(np.abs(exact), np.abs(force_at(0.0)) * 1e-4 + 1e-6)
        assert (np.abs(np.array(found) - exact) / scale).max() < 1e-6


def test_a_step_may_end_behind_its_first_collision(core):
    pair = Pair(core, 2, 0.01, 0.05, 0.0, 1.4, 0.005, 0.5, 0.0, 0j)
    alpha = pair.python.alpha
    state = [0.0, 2.0 * alpha + 0.01], [3.0, -2.0], [0.0, 0.0]
    quiet = [0j] * 4
    ends, moved = pair.advance(state, quiet, 100.0, 0.0, 1e-2, stop=1)
    # 0.01 rad at 5 rad/s, and with the rotor held half of it back
    assert moved.reached == pytest.approx(0.002, abs=1e-13)
    assert moved.events == 1
    assert ends[0][1] - ends[0][0] == pytest.approx(2.0 * alpha, abs=1e-13)
    assert ends[1].tolist() == pytest.approx([-0.75, 1.75], abs=1e-13)
    whole = advance(pair.python, *state, quiet, 100.0, 0.0, 1e-2)
    rest, _ = pair.advance(ends, quiet, 100.0, 0.0, 1e-2 - moved.reached)
    assert rest[0].tolist() == pytest.approx(whole.angles, abs=1e-12)


def test_first_contacts_and_static_moment_are_those_of_python(core):
    random = np.random.default_rng(9)
    for name in TRACKS:
        count, share, *options = TRACKS[name]
        radius = share * 0.05 * (math.sin(math.pi / count) if count > 1 else 1.0)
        pair = Pair(core, count, 0.01, 0.05, 0.05, 1.4, radius, *options)
        for _ in range(10):
            angles, speeds, contacts = _start(random, pair)
            speeds = [random.choice([0.0, speeds[0]])] * count
            contacts = first_contacts(pair.python, angles, speeds)
            assert pair.first_contacts(angles, speeds) == contacts
            moment = core("track_static_moment", byref(pair.native), np.array(angles), None)
            exact = static_moment(pair.python, angles)
            assert abs(complex(moment.re, moment.im) - exact) < 1e-15 * count * 0.01 * 0.05


def test_tracks_that_python_refuses_are_refused(core):
    good = {
        "weight_radius": 0.005,
        "restitution": 0.0,
        "rolling_resistance": 0.0,
        "offset": 0j,
    }
    for name, value, code in (
        ("weight_radius", -1.0, "FAILURE_NEGATIVE"),
        ("weight_radius", math.inf, "FAILURE_NEGATIVE"),
        ("weight_radius", 0.036, "FAILURE_WEIGHT_RADIUS"),
        ("restitution", 1.1, "FAILURE_RESTITUTION"),
        ("restitution", math.nan, "FAILURE_RESTITUTION"),
        ("rolling_resistance", -1e-9, "FAILURE_NEGATIVE"),
        ("offset", complex(0.0, math.inf), "FAILURE_NOT_FINITE"),
    ):
        values = good | {name: value}
        with pytest.raises(ValueError, match=f"^{name} = "):
            Track(Weights(4, 0.01, 0.05, 0.05, 1.4), *values.values())
        points = core.structures.Weights(4, 0.01, 0.05, 0.05, 1.4)
        *numbers, offset = values.values()
        pair = core.structures.Complex(offset.real, offset.imag)
        native = core.structures.Track(points, *numbers, pair)
        found, failure = core.refusal(core.demand, "track_prepare", byref(native))
        assert (found, failure.name.decode()) == (code, name)


def test_weights_that_overlap_and_steps_that_fail_are_refused_as_in_python(core):
    pair = Pair(core, 2, 0.01, 0.05, 0.05, 1.4, 0.005, 0.0, 1e-3, 0j)
    quiet, zeros = [0j] * 4, [0.0, 0.0]
    overlap = [0.0, 0.1], zeros, zeros
    for call in (
        lambda: pair.advance(overlap, quiet, 100.0, 0.0, STEP),
        lambda: pair.reaction(overlap, 0j, 0j, 100.0, 0.0),
        lambda: pair.first_contacts(*overlap[:2]),
    ):
        code, failure = core.refusal(call)
        assert code == "FAILURE_OVERLAP"
        assert failure.value[:2] == pytest.approx(
            (2.0 * pair.python.alpha - 0.1, 0.200335), rel=1e-5
        )
    apart = [0.0, 3.0], [0.0, 1.0], zeros
    for signal, step, code in (
        ([1e9, 0j, 0j, 0j], 10.0, "FAILURE_SUBSTEPS"),
        ([1.0, 0j, 0j, 1e30], STEP, "FAILURE_SLIDE"),
    ):
        found, failure = core.refusal(pair.advance, apart, signal, 100.0, 0.0, step)
        assert found == code
        with pytest.raises(ArithmeticError) as error:
            advance(pair.python, *apart, [complex(a) for a in signal], 100.0, 0.0, step)
        for value in failure.value:
            assert f"{value:.3g}" in str(error.value) or f"{value:g}" in str(error.value)


def test_a_pulse_owed_is_given_as_in_python(core):
    random = np.random.default_rng(4)
    for _ in range(200):
        owed, pulse, impulse = (complex(*random.normal(size=2)) for _ in range(3))
        if random.random() < 0.2:
            owed = pulse = 0j
        turn, step = random.uniform(-3.0, 3.0), 10.0 ** random.uniform(-5.0, -2.0)
        pair = [core.structures.Complex(z.real, z.imag) for z in (owed, pulse)]
        core("discharge", byref(pair[0]), byref(pair[1]), impulse, turn, step)
        expected = discharge(owed, pulse, impulse, turn, step)
        for found, exact in zip(pair, expected, strict=True):
            assert complex(found.re, found.im) == pytest.approx(exact, rel=1e-12, abs=1e-12)
        half = core("hat_half", turn)
        assert complex(half.re, half.im) == pytest.approx(hat_half(turn), rel=1e-14)


def _pools(core, n):
    class Pools(ctypes.Structure):
        _fields_ = (
            ("count", ctypes.c_int),
            *((name, ctypes.POINTER(ctypes.c_int)) for name in ("first", "size")),
            *((name, ctypes.POINTER(ctypes.c_double)) for name in ("drive", "limit", "value")),
        )

    made = Pools(0, *((ctypes.c_int * n)() for _ in range(2)))
    for name in ("drive", "limit", "value"):
        setattr(made, name, (ctypes.c_double * n)())
    return made


def test_pools_collisions_and_group_factors_are_those_of_python(core):
    random = np.random.default_rng(12)
    for _ in range(300):
        n = int(random.integers(1, 12))
        drives, limits = (
            random.normal(size=n),
            random.uniform(0.0, 1.0, n) * (random.random() < 0.5),
        )
        found = _pools(core, n)
        core("pool", byref(found), drives, limits, n, 1e-12)
        python = Pools(n)
        pool(python, drives.tolist(), limits.tolist(), n, 1e-12)
        assert found.count == python.count
        assert found.first[: found.count] == python.first[: found.count]
        assert found.size[: found.count] == python.size[: found.count]
        values = python.value[: found.count]
        assert found.value[: found.count] == pytest.approx(values, abs=1e-14)
        restitution = float(random.choice([0.0, 0.3, 1.0]))
        rates = random.normal(size=n)
        expected = rates.tolist()
        collide(expected, n, restitution, python)
        core("collide", rates, n, restitution, byref(found))
        assert rates.tolist() == pytest.approx(expected, abs=1e-13)
        alpha = random.uniform(0.0, 0.2)
        assert core("group_factor", n, alpha) == pytest.approx(group_factor(n, alpha), rel=1e-14)
        if n > 1:
            factors = np.empty(2 * n)
            core("pressure_factors", n, alpha, factors)
            exact = np.array(pressure_factors(n, alpha))
            assert np.abs(factors.view(complex)[: n - 1] - exact).max() < 1e-14


def test_the_least_of_a_cubic_is_where_python_finds_it(core):
    random = np.random.default_rng(13)
    found = 0
    for _ in range(500):
        values = (
            random.uniform(0.0, 0.1),
            -random.random(),
            random.uniform(0.0, 0.1),
            random.random(),
        )
        expected = lowest(*values, 1.3)
        assert core("lowest", *values, 1.3) == pytest.approx(expected, abs=1e-13)
        found += expected > 0.0
    assert found > 50
