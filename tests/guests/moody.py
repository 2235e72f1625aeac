"""A unit that misbehaves in the way that its parameter `mood` names."""

import ctypes
import os
import time

from pythonfmu import (
    Boolean,
    Fmi2Causality,
    Fmi2Slave,
    Fmi2Variability,
    Integer,
    Real,
    String,
)


class Moody(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.mood, self.steps, self.u, self.y, self.on = "", 0, 0.0, 0.0, False
        self.into, self.enable = 0, False
        parameter = {"causality": Fmi2Causality.parameter, "variability": Fmi2Variability.fixed}
        discrete = Fmi2Variability.discrete
        self.register_variable(String("mood", **parameter))
        self.register_variable(Real("u", causality=Fmi2Causality.input))
        for name, kind in (("into", Integer), ("enable", Boolean)):
            self.register_variable(kind(name, causality=Fmi2Causality.input, variability=discrete))
        self.register_variable(Real("y", causality=Fmi2Causality.output))
        for name, kind in (("steps", Integer), ("on", Boolean)):
            self.register_variable(kind(name, causality=Fmi2Causality.output, variability=discrete))

    def exit_initialization_mode(self):
        if self.mood == "refuses":
            raise ValueError("mass must be positive")

    def do_step(self, current_time, step_size):
        self.steps += 1
        self.y, self.on = float(self.into), not self.enable
        if self.steps >= 2 and self.mood == "fails":
            return False
        if self.steps >= 2 and self.mood == "raises":
            raise ZeroDivisionError("a division in the second step")
        if self.steps >= 2 and self.mood == "nan":
            self.y = float("nan")
        if self.steps >= 2 and self.mood == "crashes":
            ctypes.string_at(0)
        if self.steps >= 2 and self.mood == "aborts":
            os.abort()
        if self.mood == "gain":
            self.y = 1.5 * self.u + 1.0
        return True

    def terminate(self):
        if self.mood == "hangs":
            time.sleep(1e6)
