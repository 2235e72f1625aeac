"""What stands in an FMU's documentation folder: equations, variables, needs, licences."""

from __future__ import annotations

from html import escape

from .slave import Unit
from .variables import Variable

_HEAD = (
    '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{name}</title><style>'
    "body{{font-family:sans-serif;max-width:60em;margin:2em auto;padding:0 1em}}"
    "table{{border-collapse:collapse}}td,th{{border:1px solid #bbb;padding:.2em .6em;"
    "text-align:left}}code,pre{{background:#f4f4f4}}pre{{padding:.6em}}</style></head><body>\n"
)

_SIGNALS = """xi and eta are axes that turn with the rotor; seen in them a vector a of the fixed
axes is a e^{-i beta}, with beta the rotor's angle. An input signal is a cubic over the
communication step: its value and its derivatives of order 1 to 3 at the start of the step.
Connect only the value and it is held. Outputs belong to the end of the step and come
with their exact slope."""

_EQUATIONS = {
    "RotorOnSupports": """\
M q'' + (C + C_i) q' + (K + w C_i J) q = S^T F + U (w^2 - i w') e^{i(beta+g)}

q    displacements of the stations, x + i y          beta' = w = speed,  w' = acceleration
C    damping of the supports                         C_i  internal_damping (turns with the shaft)
K    stiffness of supports and shaft                 U, g unbalance and its angle
F    forces on the planes; M includes plane[i].added_mass at plane i

planar       one station: Filimonikhina 2017 (4), Dubovik 2006 (5)
two_support  rigid body, q at its supports a span l apart; a plane at distance a from support 1
             moves by q_1 + (q_2 - q_1) a/l; tilt psi = (q_2 - q_1)/l couples the axes by
             + polar_inertia w psi_y' (x), - polar_inertia w psi_x' (y): Polushkin 2016 (8), (9)
flexible     discs on a massless shaft; the shaft pulls with T^T delta^-1 T, T q the bending from
             the line through the supports, delta the compliance of the shaft supported there:
             Filimonikhin 2011 (1); C_i is this stiffness times internal_damping (largest delta_jj)

At constant speed a step is exact (matrix exponential of
rotor, unbalance and cubic force); while the speed changes, Radau IIA of order 5.""",
    "LiquidBalancer": """m2 = rho pi (r1^2 - r2^2) h      mass of the liquid
r  = r1^2 / (r1^2 - r2^2)        F = -r m2 a
r1 chamber_radius, r2 float_radius, h height, rho density, a acceleration of the chamber's centre

Dubovik 2006 (4), (5).  The liquid is a pure added mass r m2 = rho pi r1^2 h: it leaves through the
port added_mass, or in F when inertia_as_force is true.""",
    "BallBalancer": """kappa theta'' + (b/m) theta' = -(1/R) Im(a e^{-i theta}) - kappa w'
F = -N m a - (d/dt)^2 (sum of m R e^{i theta}), seen in fixed axes

theta angle of a weight in the rotor, a acceleration of the track's centre in the rotor's axes,
m mass, R track_radius, b drag, kappa 7/5 for balls, 3/2 for rollers, 1 for pendulums

Filimonikhina 2017 (4).  N m leaves through the port added_mass, or in F when inertia_as_force is
true.  Drag is integrated exactly, so that it may have any size.""",
}

_LIMITS = {
    "RotorOnSupports": """Small displacements: the supports and the shaft are linear. Discs of a
flexible rotor are points: they have mass, but no inertia against tilting. The speed is
prescribed: give its value and its acceleration at the start of every step, the unit keeps them over
the step. plane[i].added_mass is constant over a step.""",
    "LiquidBalancer": """The float stays on the axis of rotation and the liquid follows at once.
Valid while clearance is positive: beyond it the float touches the chamber; the unit warns
once, with the time. With inertia_as_force = true a tool that exchanges held signals diverges
as soon as r m2 reaches the rotor's mass, whatever the step: prefer the port added_mass.""",
    "BallBalancer": """No gravity along the track, rolling without slip, drag proportional to the
speed relative to the rotor. With weight_radius = 0 the weights are points that pass through each
other; above it they collide with the given restitution, as on a rotor that is held, and pack. A
collision's impulse reaches the rotor as a pulse of F over the two following steps, exact in
momentum, one to two steps late: of order 1 in the step, and only with derivatives connected. The
rotor-frame build keeps that momentum exactly. rolling_resistance lets weights stick. With
inertia_as_force = true a tool that exchanges held signals diverges as soon as N m reaches the
rotor's mass: prefer the port added_mass.""",
}

_NEEDS = """{unit} runs Python code: the host process needs CPython 3.10 or newer, 64 bit{numpy}.

Nothing else is needed: the model and the Python side of pythonfmu 0.7 are inside, under a package
name of their own, and no package installed on the host is used{but}.

How the host finds Python
  - A host that is itself a Python program (FMPy, PyFMI, libcosimpy ...) lends its own interpreter.
  - Any other host loads libpython at run time:
      Linux    libpython3.so (the stable ABI) must be found by the loader: LD_LIBRARY_PATH
               or, for hosts that load FMUs with private symbols, LD_PRELOAD=.../libpython3.x.so
      Windows  the folder of python3.dll must be in PATH, and PYTHONHOME must name its installation.

Binaries: linux64, win64.
"""

_MIT = """Permission is hereby granted, free of charge, to any person obtaining a copy
of this software and associated documentation files (the "Software"), to deal
in the Software without restriction, including without limitation the rights
to use, copy, modify, merge, publish, distribute, sublicense, and/or sell
copies of the Software, and to permit persons to whom the Software is
furnished to do so, subject to the following conditions:

The above copyright notice and this permission notice shall be included in all
copies or substantial portions of the Software.

THE SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR
IMPLIED, INCLUDING BUT NOT LIMITED TO THE WARRANTIES OF MERCHANTABILITY,
FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE
AUTHORS OR COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER
LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR OTHERWISE, ARISING FROM,
OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN THE
SOFTWARE.
"""

LICENCE = f"""autobalancer: MIT License

Copyright (c) 2026 the autobalancer authors

{_MIT}"""

LICENCE_WITH_PYTHONFMU = f"""{LICENCE}
pythonfmu (binaries, and its Python files in resources): MIT License

Copyright (c) 2019-2020 NTNU - Department of Ocean Operations and Civil Engineering
Copyright (c) 2019-2020 Safran SA

{_MIT}"""


def html(unit: type[Unit], name: str) -> bytes:
    """documentation/index.html of a configured unit."""
    options = ", ".join(f"{key} = {value}" for key, value in sorted(unit.options.items()))
    parts = [
        _HEAD.format(name=escape(name)),
        f"<h1>{escape(name)}</h1>\n<p>{escape(unit.__doc__ or '')}</p>\n",
        f"<p>Unit {unit.__name__}, built with {escape(options)}.</p>\n",
        f"<h2>Equations</h2>\n<pre>{escape(_EQUATIONS[unit.__name__])}</pre>\n",
        f"<h2>Signals</h2>\n<p>{escape(_SIGNALS)}</p>\n",
        f"<h2>Validity</h2>\n<p>{escape(_LIMITS[unit.__name__])}</p>\n",
        "<h2>Variables</h2>\n",
    ]
    for causality in ("parameter", "input", "output"):
        rows = [_row(v) for v in unit.layout.variables if v.causality == causality]
        parts.append(
            f"<h3>{causality.capitalize()}s</h3>\n<table><tr><th>Name</th><th>Unit</th>"
            f"<th>Start</th><th>Allowed</th><th>Meaning</th></tr>\n{''.join(rows)}</table>\n"
        )
    return ("".join(parts) + "</body></html>\n").encode()


def _row(variable: Variable) -> str:
    start = "" if variable.start is None else f"{variable.start!r}"
    allowed = variable.allowed
    if variable.boolean:
        start, allowed = start.lower(), "true, false"
    elif variable.causality == "output":
        allowed = ""
    cells = [variable.unit, start, allowed, variable.description]
    return (
        f"<tr><td><code>{escape(variable.name)}</code></td>"
        + "".join(f"<td>{escape(cell)}</td>" for cell in cells)
        + "</tr>\n"
    )


def external_dependencies(unit: type[Unit], needs_numpy: bool) -> bytes:
    """documentation/externalDependencies.txt."""
    numpy = ", with NumPy 1.24 or newer" if needs_numpy else " (the standard library is enough)"
    but = " but NumPy" if needs_numpy else ""
    return _NEEDS.format(unit=unit.__name__, numpy=numpy, but=but).encode()
