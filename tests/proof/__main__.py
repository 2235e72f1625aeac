"""Proofs against Floquet multipliers on random machines.

    python -m tests.proof [COUNT] [SEED]

Prints contradictions, the share of a range left undecided, and times.
"""

from __future__ import annotations

import sys
import time

import numpy as np

from autobalancer.harness import Scene
from autobalancer.harness.stability.proved import Proof, prove
from autobalancer.models.proof.rotors import Unproved
from autobalancer.models.stability import growth_rates

SPEEDS = 400  # of a range, at which Floquet is asked
SURE = 1e-9  # of the speed: a smaller growth rate of Floquet decides nothing


def machine(random: np.random.Generator) -> Scene:
    """A planar or rigid rotor, isotropic or not, with 2 to 6 weights in each plane."""
    rigid = random.random() < 0.5
    supports = 2 if rigid else 1
    equal = random.random() < 0.4
    stiffness = 10.0 ** random.uniform(0.0, 1.5, (supports, 2))
    damping = 10.0 ** random.uniform(-1.5, 0.5, (supports, 2))
    if equal:
        stiffness[:, 1], damping[:, 1] = stiffness[:, 0], damping[:, 0]
    rotor: dict[str, object] = {"mass": 1.0}
    if rigid:
        rotor |= {"kind": "two_support", "span": 1.0, "com": random.uniform(0.3, 0.7)}
        rotor |= {"inertia": 10.0 ** random.uniform(-1.5, -0.5), "planes": [0.1, 0.9]}
        rotor |= {"stiffness": stiffness.tolist(), "damping": damping.tolist()}
        rotor["polar_inertia"] = rotor["inertia"] * random.uniform(0.0, 1.5)  # type: ignore[operator]
    else:
        rotor |= {"kind": "planar", "stiffness": stiffness[0].tolist()}
        rotor |= {"damping": damping[0].tolist()}
    balancers = []
    total = 10.0 ** random.uniform(-3.0, -1.0)
    for plane in range(1, supports + 1):
        count = int(random.choice([2, 2, 3, 4, 6]))
        balancers.append(
            {
                "name": f"ring{plane}",
                "kind": str(random.choice(["balls", "rollers", "pendulums"])),
                "count": count,
                "mass": total / count,
                "track_radius": 0.2,
                "at": plane,
                "drag": total / count * 10.0 ** random.uniform(-1.0, 1.0),
                "angles": np.sort(random.uniform(0.0, 6.28, count)).tolist(),
            }
        )
    amount = 0.2 * total * random.uniform(0.05, 0.8)
    if rigid:
        rotor["unbalances"] = [{"position": random.uniform(0.3, 0.7), "amount": amount}]
    else:
        rotor["unbalance"] = amount
    return Scene(rotor=rotor, balancer=balancers, operation={"speed": 1.0})


def contradictions(name: str, scene: Scene, proof: Proof, random: np.random.Generator) -> int:
    """How often Floquet's growth rate at a random speed contradicts a band; each is printed."""
    wrong = 0
    places = random.uniform(proof.bands[0].low, proof.bands[-1].high, SPEEDS)
    for speed, rate in zip(places, growth_rates(scene.assembly(), places), strict=True):
        (state, *_) = (b.state for b in proof.bands if b.low <= speed <= b.high)
        if abs(rate) > SURE * speed and state == ("stable" if rate > 0.0 else "unstable"):
            wrong += 1
            print(f"{name}: {state} at {speed:.9g} rad/s, Floquet's rate {rate:.3g} 1/s")
    return wrong


def main(count: int, seed: int) -> int:
    """The number of contradictions."""
    random = np.random.default_rng(seed)
    wrong, refused, shares, seconds = 0, 0, [], []
    for number in range(count):
        scene = machine(random)
        low, high = 0.5, 12.0
        begun = time.perf_counter()
        try:
            proof = prove(scene, low, high)
        except Unproved as error:
            refused += 1
            print(f"{number}: refused: {error}")
            continue
        seconds.append(time.perf_counter() - begun)
        print(f"{number}: {seconds[-1]:.3g} s, {proof.certificates} certificates", flush=True)
        shares.append(proof.undecided)
        wrong += contradictions(str(number), scene, proof, random)
        if proof.undecided > 0.01:
            print(f"{number}: {proof.undecided:.3g} undecided: {scene.document}")
    print(
        f"{count} machines, {refused} refused, {wrong} contradictions; undecided: mean "
        f"{np.mean(shares):.3g}, largest {max(shares):.3g}; range: median {np.median(seconds):.2g}"
        f" s, longest {max(seconds):.3g} s"
    )
    return wrong


if __name__ == "__main__":
    numbers = [int(text) for text in sys.argv[1:]]
    sys.exit(main(*(numbers + [500, 1][len(numbers) :])) > 0)
