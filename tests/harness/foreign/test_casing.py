"""A casing as an FMU beside the rotor, against integrations of both in one piece by SciPy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import autobalancer as ab

CASING = {"m": 0.5, "K": 2.0, "C": 0.2, "k": 1.5, "c": 0.1}


def joined(scene, fmu, place, start=CASING, **changes):
    """The scene with a casing at a place of its rotor, such as `rotor.support[1].`."""
    wires = [(f"{place}{name}", f"casing.{name}") for name in ("x", "y", "vx", "vy")]
    wires += [(f"casing.F{axis}", f"{place}F_{axis}") for axis in "xy"]
    document = scene.replace(changes).document | {
        "unit": [{"name": "casing", "fmu": str(fmu), "start": dict(start)}],
        "connection": [{"from": source, "to": target} for source, target in wires],
    }
    return ab.Scene.from_document(document)


def shown(state):
    return state.real, state.imag


def two_balls_in_one_piece(time):
    """Displacement of rotor and casing: two pendulums on a disc, which a spring joins to a mass."""
    mass, stiffness, damping, unbalance, speed = 0.95, (1.0, 49.0), (0.5, 1.0), 0.025, 3.0
    weight, radius, drag = 0.025, 1.0, 0.0125
    own = CASING

    def slopes(t, s):
        q, v, p, u = s[0] + 1j * s[1], s[2] + 1j * s[3], s[4] + 1j * s[5], s[6] + 1j * s[7]
        angle, turning = s[8:10], s[10:12]
        joint = own["k"] * (q - p) + own["c"] * (v - u)
        support = complex(stiffness[0] * s[0] + damping[0] * s[2],
                          stiffness[1] * s[1] + damping[1] * s[3])  # fmt: skip
        # unknown: acceleration of the disc (2) and of the weights (2)
        a, b = np.zeros((4, 4)), np.zeros(4)
        a[0, 0] = a[1, 1] = mass + 2 * weight
        force = -support - joint + unbalance * speed**2 * np.exp(1j * speed * t)
        force += (weight * radius * turning**2 * np.exp(1j * angle)).sum()
        b[:2] = force.real, force.imag
        for k, (phi, rate) in enumerate(zip(angle, turning, strict=True)):
            a[0, 2 + k], a[1, 2 + k] = -weight * radius * np.sin(phi), weight * radius * np.cos(phi)
            a[2 + k, :2] = -weight * np.sin(phi), weight * np.cos(phi)
            a[2 + k, 2 + k] = weight * radius
            b[2 + k] = -drag * radius * (rate - speed)
        found = np.linalg.solve(a, b)
        pulled = (joint - own["K"] * p - own["C"] * u) / own["m"]
        return [*shown(v), *found[:2], *shown(u), *shown(pulled), *turning, *found[2:]]

    start = [0.0] * 8 + [0.3, 1.0, speed, speed]
    solved = solve_ivp(slopes, (0.0, time[-1]), start, "DOP853", time, rtol=1e-10, atol=1e-12)
    return {"rotor.x": solved.y[0], "rotor.y": solved.y[1], "casing.qx": solved.y[4]}


def error(result, exact):
    found = exact(result.time)
    return max(np.abs(result[n] - e).max() / np.abs(e).max() for n, e in found.items())


NAMES = ["rotor.x", "rotor.y", "casing.qx"]


def test_a_casing_pushes_on_the_rotor_along_fixed_axes(guest):
    scene = ab.load("two_balls")
    coarse, fine = (
        error(
            joined(scene, guest("casing"), "rotor.", **{
                "coupling.steps_per_rev": n, "run.revolutions": 3}).run(record=NAMES),
            two_balls_in_one_piece,
        )
        for n in (40, 160)
    )  # fmt: skip
    assert coarse < 1e-2
    assert fine < coarse / 12.0  # 16 by order 2


def test_a_casing_beside_the_rotor_keeps_a_tolerance(guest):
    scene = joined(ab.load("two_balls"), guest("casing"), "rotor.", **{
        "coupling.tolerance": 1e-3, "run.revolutions": 2})  # fmt: skip
    result = scene.run(record=NAMES)
    assert error(result, two_balls_in_one_piece) < 3.0 * result.estimated_error
    assert result.estimated_error < 1e-3


BODY = {
    "mass": 12.0, "inertia": 0.7, "polar_inertia": 0.3, "span": 0.6, "com": 0.25,
    "stiffness": [2e4, 2e4], "damping": [15.0, 15.0], "planes": [0.1],
    "unbalances": [{"position": 0.5, "amount": 1e-3, "angle": 0.4}],
}  # fmt: skip
STIFF = {"m": 5.0, "K": 2000.0, "C": 10.0, "k": 500.0, "c": 5.0}
SPEED = 60.0


def body_in_one_piece(time):
    """A rigid rotor on two supports with gyroscopic moments; a casing at its second support."""
    own, com, span = STIFF, BODY["com"], BODY["span"]
    places = np.array([0.0, span]) - com

    def slopes(t, s):
        centre, tilt, casing, v, turn, u = s
        q, w = centre + tilt * places, v + turn * places
        joint = own["k"] * (q[1] - casing) + own["c"] * (w[1] - u)
        forces = -2e4 * q - 15.0 * w - np.array([0.0, joint])
        heavy = 1e-3 * SPEED**2 * np.exp(1j * (SPEED * t + 0.4))
        moment = forces @ places + heavy * (0.5 - com)
        return [
            v, turn, u,
            (forces.sum() + heavy) / BODY["mass"],
            (moment + 1j * BODY["polar_inertia"] * SPEED * turn) / BODY["inertia"],
            (joint - own["K"] * casing - own["C"] * u) / own["m"],
        ]  # fmt: skip

    solved = solve_ivp(slopes, (0.0, time[-1]), [0j] * 6, "DOP853", time, rtol=1e-10, atol=1e-14)
    centre, tilt = solved.y[:2]
    ends = [centre + tilt * place for place in places]
    names = {f"rotor.station[{k}].{axis}": part for k in (1, 2)
             for axis, part in zip("xy", shown(ends[k - 1]), strict=True)}  # fmt: skip
    return {**names, "casing.qx": solved.y[2].real}


def test_a_force_acts_at_a_support_without_a_plane_of_its_own(guest):
    scene = ab.Scene(
        rotor={"kind": "two_support", **BODY}, operation={"speed": SPEED}, run={"revolutions": 1}
    )
    places = [f"rotor.station[{k}].{axis}" for k in (1, 2) for axis in "xy"]

    def ran(place, steps):
        steps = {"coupling.steps_per_rev": steps}
        return joined(scene, guest("casing"), place, STIFF, **steps).run(
            record=[*places, "casing.qx"]
        )

    fine = ran("rotor.support[2].", 160)
    assert error(fine, body_in_one_piece) < 1e-3
    coarse = error(ran("rotor.support[2].", 40), body_in_one_piece)
    assert error(fine, body_in_one_piece) < coarse / 12.0  # 16 by order 2
    same = ran("rotor.station[2].", 160)
    np.testing.assert_array_equal(same["rotor.station[2].x"], fine["rotor.station[2].x"])


def test_places_that_the_rotor_does_not_have_are_refused_with_what_there_is(guest):
    scene = ab.load("two_balls")
    with pytest.raises(ab.SceneError, match=r"the rotor has 1 supports; forces act at rotor\.F_x"):
        joined(scene, guest("casing"), "rotor.support[2].")


def test_two_forces_on_one_place_need_a_sum(guest):
    document = joined(ab.load("two_balls"), guest("casing"), "rotor.").document
    more = {"from": "casing.Fx", "to": "rotor.support[1].F_x"}
    document = {**document, "connection": [*document["connection"], more]}
    with pytest.raises(ab.UnitError, match=r"acts where rotor\.F_x does.*give add = true"):
        ab.Scene.from_document(document).run()
