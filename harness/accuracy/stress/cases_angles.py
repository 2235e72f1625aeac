"""Stress cases of angles that have grown large: ten million revolutions."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from functools import partial

import numpy as np

from ....models.reference.oscillator import forced_motion
from ...master.cosimulation import CoSimulation
from ...result.run import cosimulate
from ...scene import load_scene
from .case import ROTOR_AND_MOMENT, Case, Outcome, deviation, planar_scene

TURN = Fraction("6.283185307179586476925286766559005768394338798750211641949889")
REVOLUTIONS = 10_000_000
LONG_STEPS = 10_000  # exact steps of a thousand revolutions and a quarter each
PHASE = 1e-8  # rad: ten thousand products w h, each rounded to 5e-13 rad
AFTER_TURNS = 1e-6  # of the range: a weight's angle is kept to 7e-9 rad there, rounded every step


def cases() -> Iterator[Case]:
    """The rotor's own angle, and weights and rotor that start with as many turns behind them."""
    started = f"as without the turns, within {AFTER_TURNS:g} of the range"
    right = f"phase of the response within {PHASE:g} rad of exact arithmetic"
    yield Case("angle after 1e7 revolutions in steps of a thousand", right, _long_run)
    yield Case("rotor that starts 1e7 revolutions on", started, partial(_turned, "rotor"))
    yield Case("weights that start 1e7 revolutions on", started, partial(_turned, "weights"))


def _long_run() -> Outcome:
    mass, damping, stiffness, pull = 1.0, 4.0, 2500.0, 1e-3
    w = 100.0
    machine = {"mass": mass, "stiffness": stiffness, "damping": damping, "unbalance": pull}
    step = float(1000.25 * TURN) / w
    with CoSimulation(planar_scene(machine, speed=w)) as run:
        run.start(step=step)
        for _ in range(LONG_STEPS):
            run.step(step)
        rotor = run.units["rotor"]
        x, y = rotor.get(rotor.group(["x", "y"]))
    angle = float(Fraction(step) * Fraction(w) * LONG_STEPS % TURN)
    late = 40.0 / damping * mass  # the start has decayed to e^-20 by then
    steady = complex(forced_motion(mass, damping, stiffness, pull * w * w, w, [late])[0])
    steady *= np.exp(-1j * w * late)
    ratio = complex(x, y) / (steady * np.exp(1j * angle))
    error = abs(ratio - 1.0)
    return Outcome(f"response differs by {error:.1e} of itself", error <= PHASE)


def _turned(what: str) -> Outcome:
    """The two-pendulum scene with 1e7 turns added to a start angle, and with their remainder."""
    plain = load_scene("two_balls").replace({"run.revolutions": 5})
    turns = [float(0.3 + REVOLUTIONS * TURN), float(1 + REVOLUTIONS * TURN)]
    rest = [float(Fraction(angle) % TURN) for angle in turns]
    key = "run.initial" if what == "rotor" else "weights.angles"
    runs = [
        cosimulate(
            plain.replace({key: {"angle": angles[0]} if what == "rotor" else angles}),
            record=ROTOR_AND_MOMENT,
        )
        for angles in (turns, rest)
    ]
    error = deviation(runs[0], {name: runs[1][name] for name in ROTOR_AND_MOMENT})
    return Outcome(f"differs by {error:.1e} of the range", error <= AFTER_TURNS)
