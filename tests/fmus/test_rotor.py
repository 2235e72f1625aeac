"""The rotor unit of every kind: against independent integration, alone and coupled."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from scipy.integrate import solve_ivp

from autobalancer.fmus.variables import derivative
from autobalancer.harness import Scene, SceneError, cosimulate, load_scene
from autobalancer.harness.master.plan import plan
from autobalancer.harness.stability.main_motion import MainMotion
from autobalancer.models.boundaries import balancing_boundaries
from autobalancer.models.linear.critical import critical_speeds as rotor_critical_speeds
from autobalancer.models.monolith import reference
from autobalancer.models.stability import growth_rates
from tests.fmus.conftest import BACKENDS

pytestmark = pytest.mark.slow


BODY = {
    "kind": "two_support", "mass": 12.0, "inertia": 0.7, "polar_inertia": 0.9, "span": 0.8,
    "com": 0.3, "stiffness": [[2e5, 3e5], [1.5e5, 2.5e5]],
    "damping": [[150.0, 60.0], [90.0, 120.0]], "planes": [-0.1, 0.95],
    "unbalances": [
        {"position": 0.1, "amount": 3e-3, "angle": 0.4},
        {"position": 0.9, "amount": 2e-3, "angle": 2.0},
    ],
}  # fmt: skip
SHAFT = {
    "kind": "flexible", "stations": [0.0, 0.12, 0.3, 0.45], "masses": [1.0, 2.0, 1.5, 0.8],
    "supports": [3, 1], "support_stiffness": [[3e5, 3e5], [2e5, 2e5]],
    "support_damping": [[80.0, 80.0], [60.0, 60.0]], "internal_damping": 5.0,
    "unbalances": [{"position": 0.45, "amount": 1e-3, "angle": 0.7}],
}  # fmt: skip
DISC = {
    "kind": "planar", "mass": 2.0, "stiffness": [8e4, 5e4], "damping": [40.0, 70.0],
    "internal_damping": 10.0, "unbalance": 2e-4, "unbalance_angle": 0.6,
}  # fmt: skip
UNIFORM = {**SHAFT, "bending_stiffness": 2e3}
ROTORS = {
    "planar": DISC,
    "two_support": BODY,
    "shaft": UNIFORM,
    "compliance": {**SHAFT, "compliance": [[4e-6, -2e-6], [-2e-6, 5e-6]]},
    "unbalance between discs": {
        **UNIFORM, "unbalances": [{"position": 0.2, "amount": 1e-3, "angle": 0.7}],
    },
}  # fmt: skip


def case(table):
    """Sizes and parameters of the unit with two planes, the same rotor, and rows of the planes."""
    table = Scene.from_document({"rotor": table, "operation": {"speed": 260.0}}).rotor
    used = {"planar": (1, 1), "two_support": (1, 2), "flexible": (4, 2)}[table.kind]
    rotor = table.build()
    rows = rotor.planes[[number - 1 for number in used]]
    return {**table.sizes(used), "planes": 2}, table.start(used), rotor, rows


@pytest.fixture
def unit_of(probe, native_probe, backend):
    """A unit of either kind, its parameters set but not yet checked."""

    def make(sizes, values, frame="rotor"):
        options = {"frame": frame, **sizes}
        if backend == "python":
            return probe("RotorOnSupports", values, begin=False, **options)
        unit = native_probe("RotorOnSupports", **options)
        for name, value in values.items():
            unit.put(name, value)
        return unit

    return make


FORCES = np.array([[30.0 - 12.0j, 8.0 + 5.0j], [900.0j, -400.0], [3e4, 2e4j], [-4e6, 1e6j]])


def integrated(rotor, rows, spin, gravity, added, frame, duration, state):
    """Displacements and velocities (4 n,) by DOP853 in real x and y, from the matrices alone.

    Also the planes' acceleration and its derivative.
    """
    mass = rotor.mass + rows.T @ np.diag(added) @ rows
    inverse, n = np.linalg.inv(mass), rotor.stations

    def rhs(t, s):
        x, y, vx, vy = s.reshape(4, n)
        w, spin_up = spin(t), spin.deriv()(t)
        turn = np.exp(1j * (0.3 + spin.integ()(t)))
        force = FORCES[0] + t * (FORCES[1] + t * (FORCES[2] / 2 + t * FORCES[3] / 6))
        pull = rows.T @ (force * (turn if frame == "rotor" else 1.0))
        pull = pull + rotor.unbalance * (w * w - 1j * spin_up) * turn
        inner, gyro = rotor.internal_damping, rotor.gyroscopic
        ax = pull.real - rotor.stiffness_x @ x - (rotor.damping_x + inner) @ vx
        ay = pull.imag - rotor.stiffness_y @ y - (rotor.damping_y + inner) @ vy
        ax = ax - w * (inner @ y) - w * (gyro @ vy)
        ay = ay + w * (inner @ x) + w * (gyro @ vx)
        # gravity acts on every mass alike
        return np.concatenate([vx, vy, inverse @ ax + gravity.real, inverse @ ay + gravity.imag])

    def planes_at(t, s):
        slopes = rhs(t, s)[2 * n :].reshape(2, n)
        return rows @ (slopes[0] + 1j * slopes[1])

    times = duration + np.array([-1e-7, 0.0, 1e-7])
    solved = solve_ivp(rhs, (0.0, times[-1]), state, "DOP853", times, rtol=1e-12, atol=1e-15)
    before, a, after = map(planes_at, times, solved.y.T)
    return solved.y[:, 1], a, (after - before) / 2e-7


@pytest.mark.parametrize("frame", ["rotor", "fixed"])
@pytest.mark.parametrize(
    ("backend", "rates", "tolerance"),
    [
        *((backend, *case) for backend in BACKENDS for case in (((0.0,), 1e-9), ((400.0,), 1e-7))),
        ("native", (400.0, 1e4, -1e6, 1e8), 1e-9),
    ],
    indirect=["backend"],
)
@pytest.mark.parametrize("kind", ROTORS)
def test_a_step_is_the_solution_of_the_equations(kind, rates, tolerance, frame, unit_of):
    """A cubic force on two planes, added mass, unbalances, every kind of damping.

    With a cubic acceleration of the speed, which Python units do not have, gravity, too.
    """
    sizes, values, rotor, rows = case(ROTORS[kind])
    n, step, speed, added = rotor.stations, 2e-3, 260.0, (0.3, 0.5)
    spin = Polynomial([x / math.factorial(k) for k, x in enumerate((speed, *rates))])
    gravity = 2.0 - 9.0j if len(rates) > 1 else 0j
    stations = [f"station[{j}]." for j in range(1, n + 1)] if n > 1 else [""]
    rng = np.random.default_rng(3)
    start = np.concatenate([rng.normal(0, 1e-4, 2 * n), rng.normal(0, 1e-2, 2 * n)])
    own = {"angle0": 0.3, "speed": speed, "gravity_x": gravity.real, "gravity_y": gravity.imag}
    own |= {derivative("acceleration", k): rate for k, rate in enumerate(rates)}
    unit = unit_of(sizes, {**values, **own}, frame)
    for name, row in zip(("x", "y", "vx", "vy"), start.reshape(4, n), strict=True):
        for station, value in zip(stations, row, strict=True):
            unit.put(f"{station}{name}0", value)
    axes = ("xi", "eta") if frame == "rotor" else ("x", "y")
    for i, mass in enumerate(added, 1):
        unit.put(f"plane[{i}].added_mass", mass)
        for k, axis in enumerate(axes):
            for order, value in enumerate(FORCES[:, i - 1]):
                name = derivative(f"plane[{i}].F_{axis}", order)
                unit.put(name, (value.real, value.imag)[k])
    unit.exit_initialization_mode()
    h = step / 64 if rates == (400.0,) else step  # Radau IIA has an error, the others have none
    assert unit.do_step(0.0, h)
    end, acceleration, jerk = integrated(rotor, rows, spin, gravity, added, frame, h, start)

    acceleration = acceleration - gravity  # what weights on the plane feel

    def demand(found, expected, tolerance):
        allowed = tolerance * np.abs(expected).max()
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=allowed)

    found = np.array(
        [unit.look(*(f"{place}{name}" for place in stations)) for name in ("x", "y", "vx", "vy")]
    )
    demand(found[:2].ravel(), end[: 2 * n], tolerance)
    demand(found[2:].ravel(), end[2 * n :], tolerance)
    if frame == "rotor":
        turn = np.exp(-1j * unit.look("angle")[0])
        jerk = (jerk - 1j * spin(h) * acceleration) * turn
        acceleration = acceleration * turn
    signals = [[f"plane[{i}].a_{axis}" for axis in axes] for i in (1, 2)]
    demand([complex(*unit.look(*pair)) for pair in signals], acceleration, 1e-6)
    slopes = [complex(*unit.look(*(derivative(name, 1) for name in pair))) for pair in signals]
    demand(slopes, jerk, 1e-4)
    demand([unit.look(f"plane[{i}].x")[0] for i in (1, 2)], rows @ end[:n], tolerance)


@pytest.mark.parametrize(
    ("kind", "changes", "message"),
    [
        ("two_support", {"polar_inertia": 1.5}, r"polar_inertia = 1.5 .* 0 to 2 inertia"),
        (
            "shaft",
            {"plane[2].position": 0.2},
            r"plane\[2\].position = 0.2 m: .* of a station",
        ),
        (
            "shaft",
            {"support[2].position": 0.3},
            r"supports = \[3, 3\]: must be two different",
        ),
        ("shaft", {"station[2].z": 0.5}, r"stations = .* each beyond the last"),
        ("shaft", {"unbalance[1].position": 0.5}, r"position = 0.5 m: must be a disc's"),
        ("compliance", {"unbalance[1].position": 0.1}, r"or between them on a uniform shaft"),
        ("compliance", {"compliance[1,1]": -4e-6}, r"compliance = .* must be positive definite"),
    ],
)
def test_impossible_rotors_are_refused_with_the_reason(kind, changes, message, unit_of):
    sizes, values, _, _ = case(ROTORS[kind])
    unit = unit_of(sizes, {**values, **changes})
    with pytest.raises(RuntimeError, match=message):
        unit.exit_initialization_mode()


def test_bending_is_the_deflection_from_the_line_through_the_supports(unit_of):
    """A disc at mid-span under a static force bends by l^3/(48 E I)."""
    places, stiff = [0.0, 0.5, 1.0], 1e9
    values = {
        **{f"station[{j}].z": z for j, z in enumerate(places, 1)},
        **{f"station[{j}].mass": 1.0 for j in (1, 2, 3)},
        "support[1].position": 0.0,
        "support[2].position": 1.0,
        **{f"support[{s}].stiffness_{a}": stiff for s in (1, 2) for a in "xy"},
        "bending_stiffness": 2e3,
        "internal_damping": 2e3,
        "plane[1].position": 0.5,
        "unbalance[1].amount": 0.0,
        "speed": 1e-9,
        "plane[1].F_xi": 100.0,
    }
    unit = unit_of({"kind": "flexible", "stations": 3, "planes": 1}, values)
    unit.exit_initialization_mode()
    for k in range(2000):
        assert unit.do_step(k * 1e-2, 1e-2)
    assert unit.look("bending")[0] == pytest.approx(100.0 / (48.0 * 2e3), rel=1e-9)


def test_only_stations_with_balancers_are_ports():
    """Ten stations, three balancers on two of them: two planes, in the order of the stations."""
    scene = Scene.from_document(long_shaft([balls("a", 8), balls("b", 3), balls("c", 8)]))
    unit = plan(scene).units[0]
    assert unit.sizes["planes"] == 2
    assert list(plan(scene).planes.values()) == [2, 1, 2]
    assert unit.start["plane[1].position"] == pytest.approx(0.2)
    assert unit.start["plane[2].position"] == pytest.approx(0.7)


def balls(name, at, **changes):
    return {
        "name": name, "kind": "balls", "count": 2, "mass": 0.01, "track_radius": 1.0,
        "drag": 0.1, "angles": [0.3, 1.0], "at": at, **changes,
    }  # fmt: skip


def long_shaft(balancers, discs=10, axes=(1.0, 1.0)):
    return {
        "rotor": {
            "kind": "flexible",
            "stations": [0.1 * j for j in range(discs)],
            "masses": [1.0 / discs] * discs,
            "supports": [1, discs],
            "support_stiffness": [list(axes), list(axes)],
            "support_damping": [0.1, 0.1],
            "bending_stiffness": 3e-4,
            "internal_damping": 0.01,
            "unbalances": [{"position": 0.4, "amount": 0.01, "angle": 0.0}],
        },
        "balancer": balancers,
        "operation": {"speed": 3.0},
        "coupling": {"scheme": "iterated", "corrections": 1},
    }


def test_liquid_and_balls_share_a_flexible_shaft():
    """Two planes with one balancer each and one plane with both."""
    document = load_scene("three_mass_shaft").model_dump(by_alias=True, exclude_none=True)
    document = {k: v for k, v in document.items() if k in {"rotor", "operation"}}
    liquid = {"chamber_radius": 0.12, "float_radius": 0.06, "height": 1e-3, "density": 1e3}
    document["balancer"] = [
        balls("left", 1),
        {"name": "middle", "kind": "liquid", "at": 2, **liquid},
        {"name": "right", "kind": "liquid", "at": 3, "inertia_as_force": True, **liquid},
        balls("rollers", 3, kind="rollers", count=3, angles=[0.0, 2.0, 4.0]),
    ]
    scene = Scene.from_document({**document, "run": {"revolutions": 5}})
    names = [f"rotor.station[{j}].{a}" for j in (1, 2, 3) for a in "xy"]
    result = cosimulate(scene, record=names)
    exact, _ = reference(scene.assembly(), scene.profile(), result.time, signals=names)
    largest = max(np.abs(exact[signal]).max() for signal in names)
    for signal in names:
        np.testing.assert_allclose(result[signal], exact[signal], rtol=0.0, atol=1e-5 * largest)


@pytest.mark.parametrize(
    ("name", "changes", "limits", "above"),
    [
        ("three_mass_shaft", {}, (0.3, 8.0), ["stable", "unstable", "stable"]),
        ("drum", {}, (5.0, 200.0), ["stable"]),
        ("two_plane_rodrigues", {}, (0.3, 8.0), ["stable"]),
        ("two_plane_rodrigues", {"rotor.unbalances[1].amount": 0.02}, (0.3, 8.0), ["stable"]),
    ],
    ids=["shaft", "drum", "rodrigues", "rodrigues, twice the unbalance"],
)
def test_critical_speeds_of_the_units_are_those_of_floquet(name, changes, limits, above):
    """The largest multiplier of the coupled units crosses 1 within 1e-3 of Floquet's speed."""
    scene = load_scene(name).replace(changes)
    crossings = balancing_boundaries(scene.assembly(), *limits)
    assert [crossing.above for crossing in crossings] == above
    with MainMotion(scene) as motion:
        for crossing in crossings:
            low, high = (motion.growth(crossing.speed * factor) for factor in (0.999, 1.001))
            assert low * high < 0.0
            assert (low > 0.0) == (crossing.above == "stable")


@pytest.mark.parametrize(
    ("unbalance", "stable"), [(0.0, True), (0.02, True), (0.03, False), (0.035, True)]
)
def test_rodrigues_balanced_state_is_lost_where_the_pairs_stand_square(unbalance, stable):
    """At 5 rad/s: mean e^{2 i theta} of a pair at +-alpha passes 0 at alpha = 45 degrees.

    The moments needed are then 2 sqrt(2) m R = 0.0283 in all; co-simulation and Floquet agree.
    """
    scene = load_scene("two_plane_rodrigues").replace({"rotor.unbalances[1].amount": unbalance})
    exact = growth_rates(scene.assembly(), [5.0])[0]
    with MainMotion(scene) as motion:
        found = motion.growth(5.0)
    assert found == pytest.approx(exact, rel=1e-3)
    assert (found < 0.0) == stable


def test_rodrigues_rotor_has_critical_speeds_1_and_1_81():
    """Rodrigues et al. 2008: sqrt(k11/M) = 1 and sqrt(k22/(Jt - Jp)) = 1.81."""
    rotor = load_scene("two_plane_rodrigues").assembly().rotor
    assert rotor_critical_speeds(rotor) == pytest.approx([1.0, math.sqrt(9.0 / 2.75)], rel=1e-12)
    assert round(math.sqrt(9.0 / 2.75), 2) == 1.81
    modal = np.array([[1.0, 1.0], [-3.0, 3.0]])  # translation of, and tilt about the centre
    assert modal @ rotor.stiffness_x @ modal.T == pytest.approx(np.diag([1.0, 9.0]))
    assert modal @ rotor.damping_x @ modal.T == pytest.approx(0.02 * np.diag([1.0, 9.0]))
    assert modal @ rotor.mass @ modal.T == pytest.approx(np.diag([1.0, 3.25]))
    assert modal @ rotor.gyroscopic @ modal.T == pytest.approx(np.diag([0.0, 0.5]))


@pytest.mark.parametrize("axes", [(1.0, 1.0), (1.0, 2.0)], ids=["isotropic", "anisotropic"])
def test_ten_discs_exchange_no_more_than_a_planar_rotor(axes):
    """Two balancers each: as many steps and FMI calls, as the stations between are nobody's."""
    disc = {"kind": "planar", "mass": 1.0, "stiffness": list(axes), "damping": 0.1,
            "unbalance": 0.01}  # fmt: skip
    planar = {**long_shaft([balls("a", 1), balls("b", 1)]), "rotor": disc}
    long = long_shaft([balls("a", 3), balls("b", 8)], axes=axes)
    later = []  # what the second revolution takes: the start is another one for each
    for document in (planar, long):
        scenes = [Scene.from_document({**document, "run": {"revolutions": k}}) for k in (1, 2)]
        runs = [cosimulate(scene, record=[], separate=True) for scene in scenes]
        assert runs[1].steps - runs[0].steps == 40
        later.append({call: n - runs[0].calls[call] for call, n in runs[1].calls.items()})
    assert later[0] == later[1]


def test_balancing_is_lost_where_the_rest_resonates_with_the_balancers_held():
    """The middle disc on the shaft between held ends: w = 1/sqrt(delta_22 M_2) = sqrt(5)."""
    crossings = balancing_boundaries(load_scene("three_mass_shaft").assembly(), 2.1, 2.4)
    assert [c.above for c in crossings] == ["unstable"]
    assert crossings[0].speed == pytest.approx(math.sqrt(5.0), rel=1e-6)


def test_single_unbalances_can_be_replaced_by_path():
    scene = load_scene("three_mass_shaft")
    changed = scene.replace({"rotor.unbalances[2].amount": 0.004})
    assert [u.amount for u in changed.rotor.unbalances] == [0.010, 0.004]
    assert [u.amount for u in scene.rotor.unbalances] == [0.010, 0.008]
    for path, message in (
        ("rotor.unbalances[3].amount", r"unbalances has 2 entries, counted from 1"),
        ("rotor.unbalances[1].amont", r'did you mean "amount"'),
        ("rotor.unbalances.amount", r"unbalances has no keys of its own"),
    ):
        with pytest.raises(SceneError, match=message):
            scene.replace({path: 1.0})
    with pytest.raises(SceneError, match=r"amount = -1.0 kg m: must be 0 or more"):
        scene.replace({"rotor.unbalances[1].amount": -1.0})


def test_supports_without_stiffness_carry_no_weight(probe):
    values = {"gravity_y": -9.81, "stiffness_x": 0.0, "stiffness_y": 0.0}
    with pytest.raises(RuntimeError, match="supports without stiffness cannot carry"):
        probe("RotorOnSupports", values)


@pytest.mark.parametrize("limit", [0.5, 50.0])
def test_torque_of_an_unbalance_is_that_of_its_acceleration_with_friction_too(host_of, limit):
    """-Im(u* a) and its slope, a the disc's acceleration in the rotor frame; slipping and stuck."""
    u, angle = 3e-3, 0.7
    host = host_of("RotorOnSupports", sliders=2).begin(
        {"unbalance": u, "unbalance_angle": angle, "speed": 200.0, "acceleration": 30.0,
         "slider[1].limit_x": limit, "slider[1].limit_y": 0.3, "slider[2].limit_x": 0.2,
         "slider[2].stiffness_x": 3e4, "vx0": 0.02}
    )  # fmt: skip
    seen = []
    for k in range(40):
        host.set({"speed": 200.0 + 0.03 * k, "plane[1].F_xi": 0.2 * k})
        for _ in range(2):  # before the step, of the inputs just set, and after it
            for torque, a in (("torque", "{}"), ("der(torque)", "der({})")):
                found, xi, eta = host.get(
                    torque, a.format("plane[1].a_xi"), a.format("plane[1].a_eta")
                )
                expected = -(u * np.exp(-1j * angle) * complex(xi, eta)).imag
                seen.append((found, expected))
            if len(seen) % 4:
                host.slave.doStep(k * 1e-3, 1e-3)
    found, expected = np.array(seen).T.reshape(2, -1, 2)
    size = np.abs(expected).max(axis=0)
    assert (np.abs(found - expected).max(axis=0) <= 1e-12 * size).all()
    host.free()
