"""Random machines with stops, cubic springs and free strokes, against an integration written anew.

    python -m tests.studies.stops COUNT [SEED]
    python -m tests.studies.stops separate COUNT [SEED]
    python -m tests.studies.stops steps COUNT [SEED]
    python -m tests.studies.stops energy COUNT [SEED]

Discs and rigid rotors on two supports, some on a body whose foot has the stop or damper, some with
weights, constant speeds and run-ups.  SciPy integrates each from event to event by two methods;
where these differ there is no reference.  `separate` runs separate FMUs with a tolerance of 1e-5,
`steps` in given steps, machines with weights alone.  `energy` compares the energy that a machine
holds at the end of a run of tolerance 1e-9 with the work less all losses along the integrated
motion.
"""

from __future__ import annotations

import itertools
import sys
import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

import autobalancer as ab
from autobalancer.harness import cosimulate
from autobalancer.harness.errors import SimulationError

REVOLUTIONS = 12
AGREED = 3e-7  # of the largest displacement: by so much the two integrations may differ
BOOKED = 3e-10  # of the work: by so much the books of two integrations may differ
LATE = 1e-13  # of a gap, stroke or limit: by so much later than it happens an event is looked for
FEW = 400  # events of an integration; more of them take minutes
BY = (("DOP853", 1e-12), ("RK45", 1e-9))
TOLERANCES = {"": 1e-4, "separate": 1e-5, "energy": 1e-9}  # of the runs, by kind of study
STEPS = (40, 80, 160)  # per revolution
FOR_ENERGY = (("DOP853", 1e-13), ("DOP853", 1e-12))


def machine(rng: np.random.Generator, tolerance: float = 1e-4, bare: bool = False) -> ab.Scene:
    """A random machine with one or more supports that are not linear."""
    mass, natural = rng.uniform(2.0, 30.0), rng.uniform(10.0, 60.0)
    unlike = rng.choice([1.0, rng.uniform(0.6, 1.6)])
    k = mass * natural**2 * np.array([1.0, unlike])
    c = 2.0 * rng.uniform(0.01, 0.1) * mass * natural * np.array([1.0, 1.0])
    speed, unbalance = natural * rng.uniform(0.5, 2.5), rng.uniform(1e-4, 1e-3) * mass
    off = abs(k[0] - mass * speed**2) + c[0] * speed
    size = unbalance * speed**2 / off
    shape = "planar" if bare else rng.choice(["planar", "two_support", "tub"], p=[0.5, 0.3, 0.2])
    count = 2 if shape == "two_support" else 1
    rotor: dict[str, Any] = {"mass": mass}
    if shape == "two_support":
        half = [(k / 2).tolist(), (k / 2 * rng.uniform(0.8, 1.2)).tolist()]
        rotor |= {"kind": "two_support", "inertia": 0.02 * mass, "span": 0.4, "stiffness": half,
                  "damping": [(c / 2).tolist()] * 2, "planes": [0.13],
                  "unbalances": [{"position": 0.25, "amount": unbalance, "angle": 0.7}],
                  }  # fmt: skip
    else:
        rotor |= {"kind": "planar", "stiffness": k.tolist(), "damping": c.tolist(),
                  "unbalance": unbalance, "unbalance_angle": 0.7}  # fmt: skip
    places: list[Any] = [int(rng.integers(1, count + 1))]
    if shape == "tub":
        rotor |= {"on": "tub", "bodies": [{"name": "tub", "mass": 1.5 * mass, "feet": [
            {"stiffness": (2.0 * k).tolist(), "damping": (2.0 * c).tolist()}]}]}  # fmt: skip
        places.append("tub.foot[1]")
    which = rng.permutation(["stops", "cubic", "friction"])
    for name in which[: rng.integers(1, len(which) + 1)]:
        if name == "stops":
            stiff = k[0] * 10.0 ** rng.uniform(0.0, 2.0)
            rotor["stops"] = [
                {"support": place, "gap": size * rng.uniform(0.3, 1.2), "stiffness": stiff,
                 "damping": rng.choice([0.0, rng.uniform(0.02, 0.5)]) * np.sqrt(stiff * mass),
                 "kind": str(rng.choice(["ring", "ring", "x", "y"]))} for place in places
            ]  # fmt: skip
        elif name == "cubic":
            one = k[0] / count / size**2 * rng.uniform(0.05, 1.0)
            rotor["cubic_stiffness"] = [one] * 2 if count == 2 else one
            rotor["cubic"] = str(rng.choice(["radial", "axes"]))
        else:
            limit = unbalance * speed**2 * rng.uniform(0.05, 0.5)
            rotor["friction"] = [{"support": places[int(rng.integers(len(places)))], "limit": limit,
                                  "stiffness": k[0] * rng.uniform(1.0, 10.0),
                                  "free_stroke": size * rng.choice([0.0, rng.uniform(0.2, 2.0)]),
                                  }]  # fmt: skip
    weights = []
    if not bare and rng.random() < 0.5:
        weights = [{"kind": "pendulums", "name": "weights", "count": int(rng.integers(1, 4)),
                    "mass": 0.01 * mass, "drag": rng.uniform(0.1, 1.0), "track_radius": 0.1,
                    }]  # fmt: skip
    turn = 2.0 * np.pi / speed
    operation: dict[str, Any] = {"speed": speed}
    run: dict[str, Any] = {"revolutions": REVOLUTIONS}
    if rng.random() < 0.4:
        begin = rng.uniform(0.1, 0.9) * speed
        operation = {
            "run_up": {"from": begin, "to": speed, "seconds": rng.uniform(2.0, 8.0) * turn}
        }
        run = {"duration": REVOLUTIONS * turn}
    points = [""] if shape == "planar" else ["station[1].", "station[2]."]
    motion = [f"rotor.{p}{v}{a}" for v in ("", "v") for a in "xy" for p in points]
    angles = [f"weights.weight[{j + 1}].angle" for w in weights for j in range(w["count"])]
    return ab.Scene(rotor=rotor, balancer=weights, operation=operation,
                    run={**run, "record": [*motion, *angles]}, coupling={"tolerance": tolerance},
    )  # fmt: skip


class Held:
    """The equations of a machine in fixed axes: x of all points, y, their rates, weights, books."""

    def __init__(self, scene: ab.Scene) -> None:
        rotor, self.profile = scene.rotor, scene.profile()
        k, c = np.reshape(rotor.stiffness, (-1, 2)), np.reshape(rotor.damping, (-1, 2))
        if rotor.kind == "two_support":
            m, it, span = rotor.mass, rotor.inertia, rotor.span
            e = it / span**2
            self.mass = np.array([[m / 4 + e, m / 4 - e], [m / 4 - e, m / 4 + e]])
            self.k, self.c = (np.array([np.diag(each[:, a]) for a in (0, 1)]) for each in (k, c))
            (one,) = rotor.unbalances
            at = one.position / span
            self.u = one.amount * np.exp(1j * one.angle) * np.array([1.0 - at, at])
            at = rotor.planes[0] / span
            self.plane = np.array([1.0 - at, at])
            rows = {1: np.array([1.0, 0.0]), 2: np.array([0.0, 1.0])}
        else:
            self.mass, self.plane = np.array([[rotor.mass]]), np.array([1.0])
            self.k, self.c = (np.array([[[each[0, a]]] for a in (0, 1)]) for each in (k, c))
            self.u = np.array([rotor.unbalance * np.exp(1j * rotor.unbalance_angle)])
            rows = {1: np.array([1.0])}
        for body in rotor.bodies:
            (foot,), tie = body.feet, np.array([[1.0, -1.0], [-1.0, 1.0]])
            self.mass, self.plane = np.diag([rotor.mass, body.mass]), np.array([1.0, 0.0])
            self.u = np.append(self.u, 0.0)
            pair = zip((k[0], c[0]), (foot.stiffness, foot.damping), strict=True)
            self.k, self.c = (
                np.array([a[i] * tie + np.diag([0.0, b[i]]) for i in (0, 1)]) for a, b in pair
            )
            rows = {1: np.array([1.0, -1.0]), "tub.foot[1]": np.array([0.0, 1.0])}
        self.n = len(self.mass)
        self.stops = [(rows[s.support], s, {"ring": (1, 1), "x": (1, 0), "y": (0, 1)}[s.kind])
                      for s in rotor.stops]  # fmt: skip
        given = np.reshape(rotor.cubic_stiffness or (), (-1, 2))
        self.cubics = [(rows[j + 1], one, rotor.cubic) for j, one in enumerate(given)]
        self.sliders = [(rows[f.support], a, f.limit[a], f.stiffness[a],
                         (f.free_stroke or (0, 0))[a] / 2)
                        for f in rotor.friction for a in (0, 1)]  # fmt: skip
        self.weights = scene.balancer[0] if scene.balancer else None
        self.count = self.weights.count if self.weights else 0
        # of stops: 0 apart, 1 presses, 2 beyond; of sliders: way of slip, and place of the slider
        self.state = [0] * len(self.stops)
        self.slip, self.place = [0] * len(self.sliders), [0.0] * len(self.sliders)

    def start(self) -> np.ndarray:
        angles = np.array(self.weights.angles if self.weights else ())
        rates = np.full(self.count, self.profile.start)
        return np.concatenate([np.zeros(4 * self.n), angles, rates, np.zeros(1)])

    def pressure(self, j: int, s: np.ndarray) -> tuple[float, float, np.ndarray, float]:
        """r, force, direction and r' of a stop."""
        row, stop, mask = self.stops[j]
        d = (s[: 2 * self.n].reshape(2, -1) @ row) * mask
        v = (s[2 * self.n : 4 * self.n].reshape(2, -1) @ row) * mask
        r = float(np.hypot(*d))
        out = d / r if r else d
        rate = float(out @ v)
        return r, stop.stiffness * (r - stop.gap) + stop.damping * rate, out, rate

    def hold(self, j: int, s: np.ndarray) -> tuple[float, float]:
        """Way from the slider's middle and force of a slider."""
        row, axis, limit, stiffness, half = self.sliders[j]
        h = float(s[axis * self.n : (axis + 1) * self.n] @ row) - self.place[j]
        if self.slip[j]:
            return h, -self.slip[j] * limit
        return h, -stiffness * np.sign(h) * max(0.0, abs(h) - half)

    def rate(self, t: float, s: np.ndarray) -> np.ndarray:
        n, m = self.n, self.count
        q, v = s[: 2 * n].reshape(2, n), s[2 * n : 4 * n].reshape(2, n)
        phi, turning = s[4 * n : 4 * n + m], s[4 * n + m : 4 * n + 2 * m]
        w, w1, angle = self.profile.speed(t), self.profile.acceleration(t), self.profile.angle(t)
        push = self.u * (w * w - 1j * w1) * np.exp(1j * angle)
        force = np.array([push.real, push.imag])
        books = float((force * v).sum())  # work of the unbalance less all losses
        damped = np.array([self.c[a] @ v[a] for a in (0, 1)])
        books -= float((damped * v).sum())
        force -= damped + np.array([self.k[a] @ q[a] for a in (0, 1)])
        for row, k3, kind in self.cubics:
            d = q @ row
            size = d @ d if kind == "radial" else d * d
            force -= np.outer(k3 * size * d, row)
        for j, (row, stop, _) in enumerate(self.stops):
            _, pressed, out, out_rate = self.pressure(j, s)
            if self.state[j] == 1:
                force -= pressed * np.outer(out, row)
                books -= stop.damping * out_rate**2
        for j, (row, axis, _, _, _) in enumerate(self.sliders):
            held = self.hold(j, s)[1]
            force[axis] += held * row
            books += self.slip[j] != 0 and held * float(v[axis] @ row)
        matrix, right = np.zeros((2 * n + m, 2 * n + m)), np.zeros(2 * n + m)
        total = self.mass.copy()
        for j in range(m):
            each, radius, drag = self.weights.mass, self.weights.track_radius, self.weights.drag
            e = np.array([np.cos(phi[j]), np.sin(phi[j])])
            across = np.array([-e[1], e[0]])
            total = total + each * np.outer(self.plane, self.plane)
            force += each * radius * turning[j] ** 2 * np.outer(e, self.plane)
            coupled = each * radius * np.outer(across, self.plane).ravel()
            matrix[: 2 * n, 2 * n + j] = matrix[2 * n + j, : 2 * n] = coupled
            matrix[2 * n + j, 2 * n + j] = each * radius**2
            right[2 * n + j] = -drag * radius**2 * (turning[j] - w)
        matrix[:n, :n] = matrix[n : 2 * n, n : 2 * n] = total
        right[: 2 * n] = force.ravel()
        found = np.linalg.solve(matrix, right)
        return np.concatenate([s[2 * n : 4 * n], found[: 2 * n], turning, found[2 * n :], [books]])

    def watched(self, t: float, s: np.ndarray) -> list[float]:
        """What falls through 0 where a phase ends.

        A phase begins where such a function is 0.  It ends a little later than there: a step that
        jumps over the whole of it then has the end of the phase as its only fall.
        """
        found = []
        for j, (_, stop, _) in enumerate(self.stops):
            r, pressed, _, _ = self.pressure(j, s)
            inside, late = stop.gap - r, LATE * stop.gap
            held = late * stop.stiffness
            found += {0: [inside + late, 1.0], 1: [pressed + held, 1.0],
                      2: [late - inside, held - pressed]}[self.state[j]]  # fmt: skip
        for j, (row, axis, limit, stiffness, half) in enumerate(self.sliders):
            h, _ = self.hold(j, s)
            v = float(s[(2 + axis) * self.n : (3 + axis) * self.n] @ row)
            if self.slip[j]:
                found += [self.slip[j] * v, 1.0]
            else:
                most = half + limit / stiffness
                to_kink = (half - abs(h)) * self.kink[j]
                found += [most * (1.0 + LATE) - abs(h), to_kink + LATE * most]
        return found

    def enter(self, s: np.ndarray) -> None:
        """The side of its free stroke on which each slider is."""
        self.kink = [
            1.0 if abs(self.hold(j, s)[0]) < one[4] else -1.0 for j, one in enumerate(self.sliders)
        ]

    def passed(self, number: int, s: np.ndarray) -> None:
        """Change the phase behind the event of this number."""
        j, second = divmod(number, 2)
        if j < len(self.stops):
            r, _, _, _ = self.pressure(j, s)
            gap, before = self.stops[j][1].gap, self.state[j]
            beyond = r > gap * (1.0 + 1e-12)
            self.state[j] = 1 if before == 0 or second else 2 if before == 1 and beyond else 0
            if beyond and before:  # a stop that is let go relaxes: what it held is lost
                held = 0.5 * self.stops[j][1].stiffness * (r - gap) ** 2
                s[-1] += held if before == 2 else -held
            return
        j -= len(self.stops)
        row, axis, limit, stiffness, half = self.sliders[j]
        d = float(s[axis * self.n : (axis + 1) * self.n] @ row)
        if second:
            self.kink[j] = -self.kink[j]
        elif self.slip[j]:
            self.place[j] = d - self.slip[j] * (half + limit / stiffness)
            self.slip[j], self.kink[j] = 0, -1.0
        else:
            self.slip[j] = int(np.sign(d - self.place[j]))

    def energy(self, s: np.ndarray) -> float:
        """Kinetic and elastic energy of a machine without weights [J]."""
        q, v = s[: 2 * self.n].reshape(2, -1), s[2 * self.n : 4 * self.n].reshape(2, -1)
        found = sum(0.5 * (v[a] @ self.mass @ v[a] + q[a] @ self.k[a] @ q[a]) for a in (0, 1))
        for row, k3, kind in self.cubics:
            d = q @ row
            found += 0.25 * (k3[0] * (d @ d) ** 2 if kind == "radial" else (k3 * d**4).sum())
        for j, (_, stop, _) in enumerate(self.stops):
            if self.state[j] == 1:
                found += 0.5 * stop.stiffness * (self.pressure(j, s)[0] - stop.gap) ** 2
        for j, (_, _, _, stiffness, _) in enumerate(self.sliders):
            found += 0.5 * self.hold(j, s)[1] ** 2 / stiffness
        return float(found)


def integrated(held: Held, times: np.ndarray, method: str, rtol: float) -> np.ndarray:
    """States (size, T), from event to event."""
    s, begin = held.start(), 0.0
    found = np.empty((len(s), len(times)))
    found[:, 0] = s
    held.enter(s)
    corners = sorted({t for t in held.profile.times if 0.0 < t < times[-1]} | {times[-1]})
    top = max(held.profile.speeds)
    for corner in corners:
        for _ in itertools.count():
            events = []
            for number in range(len(held.watched(begin, s))):

                def event(t: float, s: np.ndarray, number: int = number) -> float:
                    return held.watched(t, s)[number]

                event.terminal, event.direction = True, -1  # type: ignore[attr-defined]
                events.append(event)
            done = solve_ivp(held.rate, (begin, corner), s, method, rtol=rtol, atol=rtol * 1e-6,
                             events=events, dense_output=True, max_step=0.1 / top)  # fmt: skip
            happened = [j for j, at in enumerate(done.t_events or ()) if len(at)]
            end, s = float(done.t[-1]), done.y[:, -1].copy()
            if happened:
                end, s = stepped_to_event(held, done, happened[0], method, rtol)
            inside = (times > begin) & (times <= end)
            if inside.any():
                found[:, inside] = done.sol(times[inside])
            begin = end
            if not happened:
                break
            held.events += 1
            if held.events > FEW:
                raise ArithmeticError("too many events")
            for number in happened:
                held.passed(number, s)
    return found


def stepped_to_event(
    held: Held, done: Any, number: int, method: str, rtol: float
) -> tuple[float, np.ndarray]:
    """Time and state of the event that ended an integration, by steps of the method.

    SciPy finds it in the method's interpolant, which errs by a hundred times as much.
    """
    start, s = float(done.t[-2]), done.y[:, -2]
    end = float(done.t[-1])
    for _ in range(3):
        if end <= start:
            break
        part = solve_ivp(held.rate, (start, end), s, method, rtol=rtol, atol=rtol * 1e-6)
        found = end, part.y[:, -1].copy()
        before = end - 1e-3 * (end - start)
        here, there = (held.watched(t, done.sol(t))[number] for t in (end, before))
        if here == there:
            break
        end -= held.watched(*found)[number] * (end - before) / (here - there)
    else:
        return found
    return float(done.t[-1]), done.y[:, -1].copy()


def reference(
    scene: ab.Scene, times: np.ndarray, by: Sequence[tuple[str, float]] = BY
) -> tuple[np.ndarray, Held, float]:
    """The states of two integrations that agree, the machine at their end, and by what they differ.

    Args:
        by: method and relative tolerance of each.

    Raises:
        ArithmeticError: they do not.
    """
    both = []
    for method, rtol in by:
        held = Held(scene)
        held.events = 0
        both.append((integrated(held, times, method, rtol), held))
    reach = np.abs(both[0][0][: 2 * held.n]).max()
    own = float(np.abs(both[0][0] - both[1][0])[: 2 * held.n].max() / reach)
    if not own <= AGREED:
        raise ArithmeticError(f"the two integrations differ by {own:.0e}")
    books = [float(states[-1, -1]) for states, _ in both]
    if by != BY and abs(books[0] - books[1]) > BOOKED * np.abs(both[0][0][-1]).max():
        raise ArithmeticError(f"the books of the two integrations differ: {books} J")
    return *both[0], own


def judge(scene: ab.Scene, separate: bool = False) -> tuple[float, float, bool, int]:
    """Error over the largest motion, less that of the reference; the stated one, whether it is
    known, and how many events there were.

    Raises:
        ArithmeticError: there is no reference.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        run = cosimulate(scene, separate=separate)
    states, held, own = reference(scene, np.asarray(run.time))
    n, names, angle = held.n, list(run.signals), np.array([held.profile.angle(t) for t in run.time])
    moved = np.array([run[name] for name in names[: 2 * n]])
    reach = np.abs(states[: 2 * n]).max()
    worst = float(np.abs(moved - states[: 2 * n]).max() / reach)
    for j in range(held.count):
        theta = states[4 * n + j] - angle
        size = max(1.0, float(np.abs(theta).max()))
        worst = max(
            worst, float(np.abs(run[f"weights.weight[{j + 1}].angle"] - theta).max()) / size
        )
    return max(0.0, worst - own), float(run.estimated_error), run.error_known, held.events


def energy(scene: ab.Scene) -> float:
    """What is missing in the books of a run's energy at its end, over the work of the unbalance."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        run = cosimulate(scene)
    states, held, _ = reference(scene, np.asarray(run.time), FOR_ENERGY)
    end = states[:, -1].copy()
    end[: 4 * held.n] = [run[name][-1] for name in list(run.signals)[: 4 * held.n]]
    most = max(abs(states[-1]).max(), held.energy(end))
    return abs(held.energy(end) - end[-1]) / most


def by_steps(count: int, rng: np.random.Generator) -> None:
    """Errors of separate FMUs in given steps, of machines with weights that have events."""
    found = []
    for k in range(count):
        scene = machine(rng)
        if not (scene.balancer and scene.has_events):
            continue
        given = [{"coupling.steps_per_rev": n, "coupling.scheme": "iterated"} for n in STEPS]
        try:
            judged = [judge(scene.replace(each), separate=True) for each in given]
        except (ArithmeticError, ValueError, SimulationError) as why:
            print(f"{k}: {why}", flush=True)
            continue
        found.append([one[0] for one in judged])
        print(f"{k}:", *(f"{one:.1e}" for one in found[-1]), f"{judged[0][3]} events", flush=True)
    both = zip(np.median(found, axis=0), np.max(found, axis=0), strict=True)
    print(f"{len(found)} machines, median and largest error at {STEPS} steps per revolution:",
          *(f"{median:.1e} ({largest:.1e})" for median, largest in both))  # fmt: skip


def main(*words: str) -> None:
    """Run machines; count misstated errors, or compare energies or numbers of steps."""
    kind = words[0] if words and not words[0].isdigit() else ""
    count, seed = (*words[bool(kind) :], *("200", "1")[len(words) - bool(kind) :])[:2]
    rng, found, none = np.random.default_rng(int(seed)), [], 0
    if kind == "steps":
        by_steps(int(count), rng)
        return
    compare, allowed = kind == "energy", TOLERANCES[kind]
    for k in range(int(count)):
        scene = machine(rng, allowed, compare)
        try:
            separate = kind == "separate"
            found.append((energy(scene), 0.0, True, 0) if compare else judge(scene, separate))
        except SimulationError as why:
            print(f"{k}: refused: {why}", flush=True)
            continue
        except (ArithmeticError, ValueError) as why:
            none += 1
            print(f"{k}: no reference: {why}", flush=True)
            continue
        true, stated, known, events = found[-1]
        if compare or (known and true > 3.0 * stated) or k % 20 == 0:
            print(
                f"{k}: {true:.1e}, stated {stated:.1e}, known {known}, {events} events", flush=True
            )
    true, said = np.array([one[:2] for one in found]).T
    known = np.array([one[2] for one in found])
    if compare:
        print(f"{len(true)} machines, {none} without reference: largest {true.max():.1e}")
        return
    print(f"{len(true)} machines, {none} without reference, "
          f"{int((~known).sum())} errors not known; "
          f"known and above three times what is stated {int((known & (true > 3 * said)).sum())}; "
          f"silent misses {int((known & (true > allowed) & (said <= allowed)).sum())}; "
          f"above the tolerance as stated {int((said > allowed).sum())}; "
          f"events {sum(one[3] for one in found)}; largest known error {true[known].max():.1e}"
    )  # fmt: skip


if __name__ == "__main__":
    main(*sys.argv[1:])
