"""A casing on springs, which a spring and a damper join to a shaft that moves in it.

m q'' = -K q - C q' + F,   F = k (x - q) + c (x' - q'),   the shaft feels -F; along x and along y
"""

import math

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

INNER = 2e-3  # s, of a Runge-Kutta step
START = {"m": 5.0, "K": 2000.0, "C": 10.0, "k": 500.0, "c": 5.0}
INPUTS = ("x", "y", "vx", "vy")
STATES = ("qx", "qy", "ux", "uy")
OUTPUTS = ("Fx", "Fy", *STATES)


class Casing(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        for name in (*START, *INPUTS, *OUTPUTS):
            setattr(self, name, START.get(name, 0.0))
        for name in START:
            causality, variability = Fmi2Causality.parameter, Fmi2Variability.fixed
            self.register_variable(Real(name, causality=causality, variability=variability))
        for name in INPUTS:
            self.register_variable(Real(name, causality=Fmi2Causality.input))
        for name in OUTPUTS:
            self.register_variable(Real(name, causality=Fmi2Causality.output))

    def exit_initialization_mode(self):
        self.show()

    def force(self, q, u):
        """On the shaft."""
        pull, drag = complex(self.x, self.y) - q, complex(self.vx, self.vy) - u
        return -self.k * pull - self.c * drag

    def acceleration(self, q, u):
        return (-self.K * q - self.C * u - self.force(q, u)) / self.m

    def do_step(self, current_time, step_size):
        count = math.ceil(step_size / INNER)
        h, q, u = step_size / count, complex(self.qx, self.qy), complex(self.ux, self.uy)
        for _ in range(count):
            a1 = self.acceleration(q, u)
            a2 = self.acceleration(q + h / 2 * u, u + h / 2 * a1)
            a3 = self.acceleration(q + h / 2 * u + h * h / 4 * a1, u + h / 2 * a2)
            a4 = self.acceleration(q + h * u + h * h / 2 * a2, u + h * a3)
            q, u = q + h * u + h * h / 6 * (a1 + a2 + a3), u + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
        self.qx, self.qy, self.ux, self.uy = q.real, q.imag, u.real, u.imag
        self.show()
        return True

    def show(self):
        found = self.force(complex(self.qx, self.qy), complex(self.ux, self.uy))
        self.Fx, self.Fy = found.real, found.imag
