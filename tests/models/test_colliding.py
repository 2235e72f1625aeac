"""Weights that collide, pack and run off centre, integrated in one piece: laws they must keep."""

import math

import numpy as np
import pytest

from autobalancer.models.assembly import Assembly, Mounted, SpeedProfile
from autobalancer.models.monolith import simulate
from autobalancer.models.papers.capacity import packed_alignment, residual_unbalance
from autobalancer.models.reference.colliding import LOWEST, OVERLAP, Colliding
from autobalancer.models.reference.coupled import Monolith, Start
from autobalancer.models.rotor import LinearRotor
from autobalancer.models.weights import Weights, alignment

pytestmark = pytest.mark.slow

MASS, RADIUS, SPEED, STIFFNESS = 0.05, 0.4, 3.0, 4.0
ALPHA = 0.3


def assembly(count=2, restitution=1.0, offset=0j, drag=0.0, unbalance=0.0, damping=0.0, **start):
    rotor = LinearRotor.planar(1.0, STIFFNESS, damping, unbalance=unbalance)
    angles = start.get("angles", (0.4, 2.2, 4.1)[:count])
    speeds = start.get("speeds", (1.6, -1.3, 0.5)[:count])
    weights = Weights(count, MASS, RADIUS, drag)
    return Assembly(
        rotor, (Mounted("weights", weights, 0, angles, speeds, offset, ALPHA, restitution),)
    )


def integral(run, offset):
    """Energy in the rotor frame, T + V less w times the angular momentum (Jacobi), over time."""
    z, v = run["rotor.x"] + 1j * run["rotor.y"], run["rotor.vx"] + 1j * run["rotor.vy"]
    turn = np.exp(1j * run["rotor.angle"])
    energy = 0.5 * np.abs(v) ** 2 + 0.5 * STIFFNESS * np.abs(z) ** 2
    momentum = (z.conj() * v).imag
    for k in range(run.theta["weights"].shape[1]):
        arm = RADIUS * np.exp(1j * run[f"weights.weight[{k + 1}].angle"]) * turn
        place = z + offset * turn + arm
        rate = run[f"weights.weight[{k + 1}].speed"] + SPEED
        velocity = v + 1j * SPEED * offset * turn + 1j * rate * arm
        energy = energy + 0.5 * MASS * np.abs(velocity) ** 2
        momentum = momentum + MASS * (place.conj() * velocity).imag
    return energy - SPEED * momentum, np.abs(energy).max()


def gaps(run):
    order = np.sort(run.theta["weights"] % math.tau, axis=1)
    return np.diff(np.hstack([order, order[:, :1] + math.tau]), axis=1) - 2.0 * ALPHA


@pytest.mark.parametrize("offset", [0j, 0.05 - 0.02j])
def test_elastic_collisions_of_a_pair_keep_the_energy_seen_in_the_rotor(offset):
    times = np.linspace(0.0, 12.0, 800)
    run = simulate(assembly(offset=offset), SpeedProfile.constant(SPEED), times, rtol=1e-11)
    assert sum(np.diff(np.sign(np.diff(gaps(run)[:, 0]))) > 0) > 3  # gaps that close and open
    found, size = integral(run, offset)
    assert np.abs(found - found[0]).max() < 1e-8 * size


def test_a_blow_takes_1_minus_e_squared_of_the_energy_of_approach():
    """Of the pair's own on a rotor that gives way: u^2/(g M^-1 g) with g from the gap's rate."""
    times, e = np.linspace(0.0, 0.35, 3501), 0.6
    start = {"angles": (2.6, 3.4), "speeds": (0.5, -0.5)}
    found = {}
    for restitution in (1.0, e):
        run = simulate(
            assembly(2, restitution, **start), SpeedProfile.constant(SPEED), times, rtol=1e-11
        )
        found[restitution], _ = integral(run, 0j)
    closing = -np.diff(gaps(run)[:, 0]) / np.diff(times)
    hit = int(np.argmax(closing < 0.0))
    before, after = closing[hit - 2], -closing[hit + 1]
    assert after / before == pytest.approx(e, rel=1e-3)
    angles = run.theta["weights"][hit] + run.angle[hit]
    mass = np.diag([1.0 + 2.0 * MASS] * 2 + [MASS * RADIUS**2] * 2)
    for k, angle in enumerate(angles):
        across = MASS * RADIUS * np.array([-math.sin(angle), math.cos(angle)])
        mass[:2, 2 + k] = mass[2 + k, :2] = across
    gap = np.array([0.0, 0.0, -1.0, 1.0])
    energy = 0.5 * before**2 / (gap @ np.linalg.solve(mass, gap))
    assert abs(found[1.0][-1] - found[1.0][0]) < 1e-9 * energy
    lost = found[e][0] - found[e][-1]
    assert lost == pytest.approx((1.0 - e**2) * energy, rel=1e-3)


@pytest.mark.parametrize(("count", "restitution"), [(2, 0.0), (3, 0.0), (3, 0.5)])
def test_an_overloaded_group_packs_and_leaves_what_goncharov_says(count, restitution):
    """U - S opposite to the unbalance (5), every weight touching, and never one in another."""
    unbalance = 0.15
    device = assembly(count).weights[0].device
    run = simulate(
        assembly(count, restitution, drag=0.3, unbalance=unbalance, damping=1.5),
        SpeedProfile.constant(6.0),
        np.linspace(0.0, 15.0, 60),
        rtol=1e-9,
    )
    assert gaps(run).min() > -5.0 * OVERLAP
    left = abs(run.moment("weights")[-1] + unbalance)
    radius = RADIUS * math.sin(ALPHA)
    assert left == pytest.approx(residual_unbalance(device, radius, unbalance), rel=0.02)
    expected = packed_alignment(count, ALPHA)
    assert alignment(run.theta["weights"][-1]) == pytest.approx(expected, rel=1e-6)


def test_a_bounce_that_ends_in_contact_gives_the_rotor_its_momentum():
    """M v + sum m R i phi' e^{i phi} is what it was, and the two move as one."""
    touching = assembly(2, 0.5, angles=(0.4, 0.4 + 2.0 * ALPHA), speeds=(0.0, 0.1 * LOWEST**0.5))
    bodies = Colliding(Monolith(touching, SpeedProfile.constant(SPEED)))
    y = bodies.system.initial(Start(x=0.3, y=0.2))  # which presses the first against the second
    after, joined = bodies.settled(0.0, y, bodies.pairs[:1])

    def momentum(y):
        _, _, vx, vy, *turned = y
        phi, rates = np.split(np.array(turned), 2)
        return (1.0 + 2 * MASS) * (vx + 1j * vy) + MASS * RADIUS * 1j * rates @ np.exp(1j * phi)

    assert joined == bodies.pairs[:1]
    assert after[-1] == after[-2]
    given = (1.0 + 2 * MASS) * abs(after[2] + 1j * after[3] - y[2] - 1j * y[3])
    assert given > 1e-8
    assert abs(momentum(after) - momentum(y)) < 1e-5 * given


@pytest.mark.parametrize(
    ("restitution", "angles", "speeds"),
    [
        (0.02, (0.4, 1.05, 1.7), (3.0, 0.0, -1.0)),
        (0.0, (0.3, 1.25, 2.18, 2.91), (2.8, 0.9, -0.1, -7.0)),
    ],
)
def test_weights_that_collide_ever_faster_do_not_pass_through_each_other(
    restitution, angles, speeds
):
    """Those in a row lose what they approach by to less than any bounce that is followed."""
    row = assembly(len(angles), restitution, angles=angles, speeds=speeds)
    run = simulate(row, SpeedProfile.constant(SPEED), np.linspace(0.0, 0.3, 3001))
    assert gaps(run).min() > -5.0 * OVERLAP


@pytest.mark.parametrize(("angle", "parting"), [(0.9, 7e-4), (0.966, 3e-5)])
def test_weights_that_part_and_are_pressed_together_at_once_do_not_pass_through_each_other(
    angle, parting
):
    """They come back in a tenth of a step or less, and what presses them ends within it."""
    pair = assembly(2, 0.0, angles=(angle, angle + 2.0 * ALPHA), speeds=(0.0, parting))
    times = np.linspace(0.0, 0.1, 101)
    run = simulate(pair, SpeedProfile.constant(SPEED), times, initial=Start(x=0.3))
    assert gaps(run).min() > -5.0 * OVERLAP
    assert gaps(run)[-1].min() > 1e-6  # it opens again


def test_a_track_off_centre_is_an_unbalance_to_weights_that_cannot_move():
    """All but fixed by drag, and evenly spread: they turn with the rotor as N m at the offset."""
    offset, count = 0.03 + 0.01j, 3
    fixed = Weights(count, MASS, RADIUS, 1e6)
    spread = tuple(math.tau * k / count for k in range(count))
    rotor = LinearRotor.planar(1.0, STIFFNESS, 0.3)
    held = Assembly(rotor, (Mounted("weights", fixed, 0, spread, (0.0,) * count, offset),))
    moment = count * MASS * offset
    heavy = LinearRotor.planar(1.0 + count * MASS, STIFFNESS, 0.3, unbalance=moment)
    times = np.linspace(0.0, 5.0, 60)
    profile = SpeedProfile.run_up(0.0, SPEED, 2.0)
    run = simulate(held, profile, times, method="Radau", rtol=1e-9)
    alone = simulate(Assembly(heavy), profile, times, rtol=1e-10)
    for name in ("rotor.x", "rotor.y"):
        assert np.allclose(run[name], alone[name], rtol=0.0, atol=1e-5 * np.ptp(alone[name]))
    assert np.allclose(run["weights.moment_xi"], moment.real, atol=1e-5)


def test_collisions_go_on_across_corners_of_the_speed():
    """A corner on a straight line changes nothing, and one that is none of it does."""
    machine, rise = assembly(unbalance=0.02, drag=0.05), SpeedProfile.run_up(0.0, SPEED, 1.5)
    ends = [
        simulate(machine, profile, [0.0, 1.5], rtol=1e-10).x[-1, 0]
        for profile in (
            rise,
            SpeedProfile((0.0, 0.7, 1.2, 1.5), tuple(map(rise.speed, (0.0, 0.7, 1.2, 1.5)))),
            SpeedProfile((0.0, 0.7, 1.5), (0.0, 0.3 * SPEED, SPEED)),
        )
    ]
    assert ends[1] == pytest.approx(ends[0], rel=1e-6)
    assert abs(ends[2] - ends[0]) > 0.01 * abs(ends[0])
