"""A planar rotor on springs with the ports that balls need: forces and accelerations that turn."""

import cmath

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

PARAMETERS = {"mass": 1.0, "stiffness_x": 1e4, "stiffness_y": 1e4, "damping_x": 0.0}
PARAMETERS |= {"damping_y": 0.0, "unbalance": 0.0, "unbalance_angle": 0.0}
INPUTS = ("speed", "plane[1].F_xi", "plane[1].F_eta", "plane[1].added_mass")
OUTPUTS = ("x", "y", "vx", "vy", "angle", "plane[1].a_xi", "plane[1].a_eta")


class TurningRotor(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.value = {**PARAMETERS, **dict.fromkeys((*INPUTS, *OUTPUTS), 0.0)}
        kinds = dict.fromkeys(PARAMETERS, Fmi2Causality.parameter)
        kinds |= dict.fromkeys(INPUTS, Fmi2Causality.input)
        kinds |= dict.fromkeys(OUTPUTS, Fmi2Causality.output)
        for name, kind in kinds.items():
            fixed = kind is Fmi2Causality.parameter
            variability = Fmi2Variability.fixed if fixed else Fmi2Variability.continuous
            self.register_variable(
                Real(
                    name,
                    causality=kind,
                    variability=variability,
                    getter=lambda n=name: self.value[n],
                    setter=lambda v, n=name: self.value.update({n: v}),
                ),
                nested=False,
            )

    def acceleration(self, q, v, angle):
        p, turn = self.value, cmath.exp(1j * angle)
        force = complex(p["plane[1].F_xi"], p["plane[1].F_eta"]) * turn
        force += cmath.rect(p["unbalance"] * p["speed"] ** 2, p["unbalance_angle"] + angle)
        force -= p["stiffness_x"] * q.real + p["damping_x"] * v.real
        force -= 1j * (p["stiffness_y"] * q.imag + p["damping_y"] * v.imag)
        return force / (p["mass"] + p["plane[1].added_mass"])

    def exit_initialization_mode(self):
        p = self.value
        q, v = complex(p["x"], p["y"]), complex(p["vx"], p["vy"])
        a = self.acceleration(q, v, p["angle"]) * cmath.exp(-1j * p["angle"])
        p["plane[1].a_xi"], p["plane[1].a_eta"] = a.real, a.imag

    def do_step(self, current_time, step_size):
        p, h = self.value, step_size / 4
        q, v, t = complex(p["x"], p["y"]), complex(p["vx"], p["vy"]), p["angle"]
        for _ in range(4):  # Runge-Kutta-Nystrom
            half, end = t + p["speed"] * h / 2, t + p["speed"] * h
            a1 = self.acceleration(q, v, t)
            a2 = self.acceleration(q + h / 2 * v, v + h / 2 * a1, half)
            a3 = self.acceleration(q + h / 2 * v + h * h / 4 * a1, v + h / 2 * a2, half)
            a4 = self.acceleration(q + h * v + h * h / 2 * a2, v + h * a3, end)
            q, v = q + h * v + h * h / 6 * (a1 + a2 + a3), v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
            t = end
        p["x"], p["y"], p["vx"], p["vy"], p["angle"] = q.real, q.imag, v.real, v.imag, t
        self.exit_initialization_mode()
        return True
