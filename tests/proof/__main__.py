"""Proofs against Floquet: on random machines, or on every bundled scene that can be proved.

    python -m tests.proof [COUNT] [SEED]
    python -m tests.proof scenes
    python -m tests.proof tables

Prints contradictions, the share of a range left undecided, and processor times; `tables` proves
brackets of all boundaries of Filimonikhina's Tables 1 and 2, in units of w_x.
"""

from __future__ import annotations

import sys
import time

import flint
import numpy as np

from autobalancer.harness import Scene, bundled_scenes, load_scene
from autobalancer.harness.checks.filimonikhina import RANGE, TABLES, variant
from autobalancer.harness.stability.exact import system
from autobalancer.harness.stability.proved import PRECISION, Proof, prove
from autobalancer.models.proof.certificate import Certificate
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


def scenes() -> int:
    """A line for each bundled scene from 0.3 to 2 of its speed; the number of contradictions."""
    random, wrong = np.random.default_rng(1), 0
    for name in bundled_scenes():
        scene = load_scene(name)
        speed = scene.profile().end
        begun = time.process_time()
        try:
            proof = prove(scene, 0.3 * speed, 2.0 * speed)
        except Unproved as error:
            print(f"{name:22} refused: {error}")
            continue
        taken = time.process_time() - begun
        with flint.ctx.workprec(PRECISION):
            begun = time.process_time()
            Certificate.of(system(scene), speed, 0).state(speed, speed)
            point = time.process_time() - begun
        wrong += (found := contradictions(name, scene, proof, random))
        states = [sum(b.state == s for b in proof.bands) for s in ("stable", "unstable")]
        print(
            f"{name:22} stable {states[0]}, unstable {states[1]}, undecided {proof.undecided:.1e}; "
            f"point {1e3 * point:.0f} ms, range {taken:.2f} s; contradictions {found}",
            flush=True,
        )
    return wrong


def tables() -> int:
    """A line for each row with its brackets; the number of rows with a wider one than 1e-6."""
    wide = 0
    for row in TABLES:
        scene, w_x = variant(load_scene("filimonikhina_tables"), row)
        bands = prove(scene, RANGE[0] * w_x, RANGE[1] * w_x, narrowest=1e-6 * w_x).boundaries
        brackets = [(band.low / w_x, band.high / w_x) for band, _ in bands]
        wide += max(high - low for low, high in brackets) > 1e-6
        text = ", ".join(f"{low:.8f} to {high:.8f}" for low, high in brackets)
        print(f"Table {row.table}, {row.eps:g} {row.mu_w:g} {row.mu_xi:g} {row.mu_eta:g}: {text}")
    return wide


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
    if sys.argv[1:] in (["scenes"], ["tables"]):
        sys.exit({"scenes": scenes, "tables": tables}[sys.argv[1]]() > 0)
    numbers = [int(text) for text in sys.argv[1:]]
    sys.exit(main(*(numbers + [500, 1][len(numbers) :])) > 0)
