"""Sentences about weights that are left behind."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ...models.capture.capture import SHARE_OF_CAPACITY, STRONG_DAMPING
from ...models.readable import brief
from ..units import in_both

if TYPE_CHECKING:
    from .captured import Captured

_EARLY = 1.0  # of 2 Om sqrt(A_u/(kappa R))/(Om - w): the unbalance can catch weights earlier

HELD = 3.0  # times the rate at which lobes hold weights: beyond, they feel the mean
FAR = 100.0  # times the rotor's speed: a release beyond it is no speed of this machine


def sentence(data: Captured) -> str:
    """Whether weights can be left behind at the rotor's speed, and from which drag on not."""
    found, called = data.found, data.called
    at = in_both(data.speed, "rad/s")
    if found.unstable:
        return (
            f"Closed form: not judged at {at}: the rotor itself is unstable, by internal damping "
            "or its bearings, or nothing holds it."
        )
    if found.undamped:
        return (
            f"Closed form: cannot tell at {at}: the natural frequency "
            f"{in_both(found.undamped, 'rad/s')} has no damping, "
            "where the closed form does not hold. Give the damping of the supports."
        )
    if found.all_pass is None:
        return _cannot_tell(data)
    if not found.natural:
        why = "no natural frequency below that speed brakes them"
        return f"Closed form: no {called} can be left behind at {at}: {why}."
    if found.all_pass:
        known = math.isfinite(found.release_speed)
        let_go = in_both(found.release_speed, "rad/s") if known else ""
        by = f"; a slow run-up lets all go by {let_go}" if known else ""
        below = "left behind only below drag"
        if found.drag_ratio >= 1.0:  # a window of drags above the present one
            below = "at some other drags they can be, never from drag"
        return f"Closed form: no {called} can be left behind at {at}{by}{_drag(data, below)}."
    natural, motion = max(found.motions, key=lambda pair: (pair[1].weights, pair[1].drag_ratio))
    several = f"{motion.weights} of {found.count}"
    size = data.amplitude(motion)
    sizes = (brief(1e3 * size), brief(1e3 * (size + data.unbalance_amplitude)))
    largest = f"{' to '.join(dict.fromkeys(sizes))} mm"
    until = ", not let go at higher speeds"
    if FAR * data.speed < motion.release_speed < math.inf:
        until = f", not let go below {FAR:g} times that speed"
    elif math.isfinite(motion.release_speed):
        until = f", let go at {in_both(motion.release_speed, 'rad/s')}"
    elif math.isnan(motion.release_speed):
        until = ""
    return (
        f"Closed form: {several} {called} can be left behind at {at}: they then turn at "
        f"{in_both(motion.frequency, 'rad/s')} beside the natural frequency "
        f"{in_both(natural.frequency, 'rad/s')}, vibration {largest}{until}"
        f"{_drag(data, 'never from drag')}. How often: `autobalancer motions`."
    )


def _cannot_tell(data: Captured) -> str:
    """Weights that neither turn with the rotor nor are left behind."""
    found = data.found
    if found.lone_lag:
        at = in_both(data.speed, "rad/s")
        return f"Closed form: cannot tell at {at}. {_lone(data)} Count it: `autobalancer motions`."
    return (
        f"Closed form: cannot tell at {in_both(data.speed, 'rad/s')}, which lies below a natural "
        f"frequency: bunched {data.called} can slip there, by up to "
        f"{brief(100.0 * found.slip / found.speed)} % of the speed. Count what happens: "
        "`autobalancer motions`."
    )


def _lone(data: Captured) -> str:
    """One weight that lags beyond all natural frequencies."""
    share = brief(100.0 * data.found.lone_lag / data.speed)
    one = "The weight" if data.found.count == 1 else f"One of the {data.called} alone"
    return (
        f"{one} can turn {share} % slower than the rotor, beside no natural frequency: the damping "
        "of the supports brakes it where the unbalance does not hold it."
    )


def _drag(data: Captured, words: str) -> str:
    limits = {name: f"{value:.3g}" for name, value in data.drag.items()}
    if len(set(limits.values())) == 1:
        value = f"{next(iter(limits.values()))} N s/m"
    else:
        value = ", ".join(f"{v} N s/m of {name}" for name, v in limits.items())
    ratio = data.found.drag_ratio
    digits = 3 if 0.9 < ratio < 1.1 else 2  # not "1 times"
    times = f" ({brief(ratio, digits)} times the present one)" if data.drag_given else ""
    if not ratio:
        return ""
    return f"; {words} {value}{times}{' on' if 'never' in words else ''}"


def _lobes(data: Captured) -> str:
    """What lobes of the race do to weights that are left behind: they turn past them."""
    passes = data.found.speed - max((n.frequency for n in data.found.natural), default=0.0)
    said = (
        "Lobes of the race are left out: weights that are left behind feel their mean; lobes can "
        f"hold weights that pass them at less than {in_both(data.held_by_lobes, 'rad/s')}"
    )
    if 0.0 < passes < HELD * data.held_by_lobes:
        return f"{said}, and here they would pass at {in_both(passes, 'rad/s')}: not known."
    return f"{said}."


def limits(data: Captured) -> list[str]:
    """What the closed form does not cover here."""
    found, said = data.found, []
    strongest = max((n.damping_ratio for n in found.natural), default=0.0)
    if strongest >= STRONG_DAMPING:
        said.append(
            f"The largest damping ratio is {strongest:.2g}: in trials with {STRONG_DAMPING:g} "
            "weights were let go at 0.95 to 1.03 times the release speed."
        )
    if found.motions and found.lone_lag:
        said.append(_lone(data))
    if found.motions and not data.scene.assembly().rotor.isotropic:
        said.append(
            "The supports are not alike along x and y: the closed form is an average there. In "
            "trials weights were let go from about half of that drag on: none are left behind "
            "beyond it, but whether they are below it `autobalancer motions` has to count."
        )
    if found.unbalance_share >= SHARE_OF_CAPACITY:
        said.append(
            f"Unbalance is {100.0 * found.unbalance_share:.0f} % of the capacity: from "
            f"{100.0 * SHARE_OF_CAPACITY:.0f} % on weights can be let go earlier than the release "
            "speed says."
        )
    if _catches_early(data):
        said.append(
            "The unbalance can catch the weights near resonance: they may be let go earlier than "
            "the release speed says."
        )
    for _, motion in found.motions:
        if data.amplitude(motion) > min(data.radii):
            said.append(
                f"The vibration of weights left behind, {brief(1e3 * data.amplitude(motion))} mm, "
                "exceeds a track radius: stops or nonlinear supports will limit it."
            )
            break
    if data.held_by_lobes:
        said.append(_lobes(data))
    if data.gravity:
        said.append("Gravity is left out: it swings the weights in every revolution.")
    if data.can_stick:
        said.append("Rolling resistance is left out: it pulls the weights along as drag does.")
    if data.scene.operation.motor:
        said.append("A motor must be able to turn on against the torque of the weights.")
    if data.scene.operation.unbalance_changes:
        said.append("The unbalance is that of the start.")
    if not data.drag_given:
        said.append("No drag is given: limits are those of equal drag of all weights.")
    return said


def _catches_early(data: Captured) -> bool:
    """2 Om sqrt(A_u/(kappa R))/(Om - w) of about 1 or more, over the motions that are possible."""
    kappas = [mounted.device.kappa for mounted in data.scene.assembly().weights]  # type: ignore[union-attr]
    size = float(np.max(data.found.unbalance_amplitude)) / min(
        kappa * radius for kappa, radius in zip(kappas, data.radii, strict=True)
    )
    if not math.isfinite(size):
        return True
    return any(
        2.0 * data.speed * math.sqrt(size) >= _EARLY * (data.speed - motion.frequency)
        for _, motion in data.found.motions
    )
