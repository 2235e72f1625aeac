"""A spring and a damper without a state: F = k (x2 - x1) + c (v2 - v1), R = -F."""

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real


class Spring(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.k, self.c = 5.0, 0.2
        self.x1 = self.v1 = self.x2 = self.v2 = self.F = self.R = 0.0
        for name in ("k", "c"):
            causality, variability = Fmi2Causality.parameter, Fmi2Variability.fixed
            self.register_variable(Real(name, causality=causality, variability=variability))
        for name in ("x1", "v1", "x2", "v2"):
            self.register_variable(Real(name, causality=Fmi2Causality.input))
        for name in ("F", "R"):
            self.register_variable(Real(name, causality=Fmi2Causality.output))

    def exit_initialization_mode(self):
        self.F = self.k * (self.x2 - self.x1) + self.c * (self.v2 - self.v1)
        self.R = -self.F

    def do_step(self, current_time, step_size):
        self.exit_initialization_mode()
        return True
