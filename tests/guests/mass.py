"""A mass on a spring and a damper under a force: m x'' + c x' + k x = F."""

import math

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

INNER = 5e-3  # s, of a Runge-Kutta step


class Mass(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.m, self.c, self.k, self.x0, self.v0 = 1.0, 0.1, 10.0, 0.0, 0.0
        self.F = self.x = self.v = self.a = 0.0
        for name in ("m", "c", "k", "x0", "v0"):
            causality, variability = Fmi2Causality.parameter, Fmi2Variability.fixed
            self.register_variable(Real(name, causality=causality, variability=variability))
        self.register_variable(Real("F", causality=Fmi2Causality.input))
        for name in ("x", "v", "a"):
            self.register_variable(Real(name, causality=Fmi2Causality.output))

    def enter_initialization_mode(self):
        self.x, self.v = self.x0, self.v0

    def exit_initialization_mode(self):
        self.enter_initialization_mode()  # some tools set parameters between both
        self.a = self.acceleration(self.x, self.v)

    def acceleration(self, x, v):
        return (self.F - self.c * v - self.k * x) / self.m

    def do_step(self, current_time, step_size):
        count = math.ceil(step_size / INNER)
        h = step_size / count
        for _ in range(count):
            x, v = self.x, self.v
            a1 = self.acceleration(x, v)
            a2 = self.acceleration(x + h / 2 * v, v + h / 2 * a1)
            a3 = self.acceleration(x + h / 2 * v + h * h / 4 * a1, v + h / 2 * a2)
            a4 = self.acceleration(x + h * v + h * h / 2 * a2, v + h * a3)
            self.x += h * v + h * h / 6 * (a1 + a2 + a3)
            self.v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
        self.a = self.acceleration(self.x, self.v)
        return True
