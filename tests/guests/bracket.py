"""A bracket bolted to a mass, with an oscillator on it: its force answers the acceleration at once.

F = -mb a + k (z - x) + c (z' - v),   m z'' = -k (z - x) - c (z' - v)

The loop gain of force and acceleration is mb over the mass that the bracket is bolted to.
"""

import math

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

INNER = 5e-3  # s, of a Runge-Kutta step


class Bracket(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.mb, self.m, self.c, self.k, self.z0 = 0.5, 1.0, 0.1, 10.0, 0.0
        self.x = self.v = self.a = self.F = self.z = self.w = 0.0
        for name in ("mb", "m", "c", "k", "z0"):
            causality, variability = Fmi2Causality.parameter, Fmi2Variability.fixed
            self.register_variable(Real(name, causality=causality, variability=variability))
        for name in ("x", "v", "a"):
            self.register_variable(Real(name, causality=Fmi2Causality.input))
        self.register_variable(Real("F", causality=Fmi2Causality.output))
        for name in ("z", "w"):  # states, which pythonfmu saves where they are variables
            self.register_variable(Real(name, causality=Fmi2Causality.local))

    def enter_initialization_mode(self):
        self.z = self.z0

    def pull(self, z, w):
        return self.k * (z - self.x) + self.c * (w - self.v)

    def exit_initialization_mode(self):
        self.enter_initialization_mode()  # some tools set parameters between both
        self.show()

    def show(self):
        self.F = self.pull(self.z, self.w) - self.mb * self.a

    def do_step(self, current_time, step_size):
        count = math.ceil(step_size / INNER)
        h = step_size / count
        for _ in range(count):
            z, w = self.z, self.w
            a1 = -self.pull(z, w) / self.m
            a2 = -self.pull(z + h / 2 * w, w + h / 2 * a1) / self.m
            a3 = -self.pull(z + h / 2 * w + h * h / 4 * a1, w + h / 2 * a2) / self.m
            a4 = -self.pull(z + h * w + h * h / 2 * a2, w + h * a3) / self.m
            self.z += h * w + h * h / 6 * (a1 + a2 + a3)
            self.w += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
        self.show()
        return True
