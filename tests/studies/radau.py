"""Write Radau's rules with three, seven and eleven points: `fmus/native/machine/radau.c`.

    python -m tests.studies.radau

The s points are the zeros of P_s(2 t - 1) - P_(s-1)(2 t - 1) (Hairer & Wanner, Solving Ordinary
Differential Equations II, IV.5).  The rest follows from them: integrals, interpolating
polynomials, of up to seven points in powers of the time and of eleven as sums of Chebyshev's, and
the eigenvalues and vectors of the integrals.  All with 60 digits, by mpmath.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import mpmath as mp

DIGITS, WIDTH = 60, 110
RULES = {3: "THREE", 7: "SEVEN", 11: "ELEVEN"}
FILE = Path(__file__).resolve().parents[2] / "fmus" / "native" / "machine" / "radau.c"
HEAD = """\
/* Radau's rules with three, seven and eleven points: written by `python -m tests.studies.radau`. */
#include "machine/collocation.h"
"""


def nodes(stages: int) -> list[Any]:
    """Points within a step of length 1, ascending; the last is its end."""

    def legendre(degree: int) -> Any:
        return mp.taylor(lambda t: mp.legendre(degree, 2 * t - 1), 0, stages)

    series = [a - b for a, b in zip(legendre(stages), legendre(stages - 1), strict=True)]
    found = mp.polyroots(series[::-1], maxsteps=500, extraprec=400)
    return [*sorted(mp.re(root) for root in found)[:-1], mp.mpf(1)]


def modes(matrix: Any) -> list[tuple[Any, list[Any], list[Any]]]:
    """Eigenvalues, the real one first, with left and right vectors; right ones end with 1."""
    values, right = mp.eig(matrix)
    left, stages = right**-1, len(values)
    chosen = sorted(
        (k for k in range(stages) if mp.im(values[k]) > -(mp.mpf(10) ** (10 - DIGITS))),
        key=lambda k: mp.im(values[k]),
    )
    last = stages - 1
    return [
        (
            values[k],
            [left[k, i] * right[last, k] for i in range(stages)],
            [right[i, k] / right[last, k] for i in range(stages)],
        )
        for k in chosen
    ]


def in_chebyshev(power: list[Any]) -> list[Any]:
    """Coefficients by T_k(2 t - 1) of a polynomial, from those by t^k."""
    count = len(power)
    angles = [mp.pi * (m + mp.mpf(1) / 2) / count for m in range(count)]
    values = [mp.polyval(power[::-1], (1 + mp.cos(angle)) / 2) for angle in angles]

    def share(k: int) -> Any:
        return mp.fsum(v * mp.cos(k * angle) for v, angle in zip(values, angles, strict=True))

    return [(2 if k else 1) * share(k) / count for k in range(count)]


def _number(value: Any) -> str:
    return repr(float(value))


def _complex(value: Any, real: bool) -> str:
    return f"{{{_number(mp.re(value))}, {'0.0' if real else _number(mp.im(value))}}}"


def _row(numbers: Iterable[str], indent: str) -> str:
    lines, line = [], indent
    for number in numbers:
        if len(line) + len(number) + 2 > WIDTH:
            lines.append(line.rstrip())
            line = indent
        line += f"{number}, "
    return "\n".join([*lines, line.rstrip().rstrip(",")])


def _array(kind: str, name: str, rows: list[list[str]]) -> str:
    inner = ",\n".join(_row(row, "    ") for row in rows)
    return f"static const {kind} {name}[] = {{\n{inner}}};\n"


def rule(stages: int) -> str:
    """Of one rule: its arrays, and the structure that names them."""
    name, c, n = RULES[stages], nodes(stages), range(stages)
    inverse = mp.matrix(stages, stages)
    for i in n:
        for k in n:
            inverse[i, k] = c[i] ** k
    inverse = inverse**-1
    matrix = mp.matrix(stages, stages)
    for i in n:
        for j in n:
            matrix[i, j] = mp.fsum(c[i] ** (k + 1) / (k + 1) * inverse[k, j] for k in n)
    powers = [[mp.mpf(0), *(inverse[k, j] / c[j] for k in n)] for j in n]  # 0 at 0
    if stages <= 7:
        kind, orders, shown = "POWERS", range(1, stages + 1), powers
    else:
        kind, orders, shown = "SUMS", range(stages + 1), [in_chebyshev(power) for power in powers]
    found = modes(matrix)
    real = [k == 0 for k in range(len(found))]
    values = [_complex(mode[0], is_real) for mode, is_real in zip(found, real, strict=True)]
    left, right = (
        [[_complex(z, r) for z in mode[k]] for mode, r in zip(found, real, strict=True)]
        for k in (1, 2)
    )
    numbers = {
        "NODES": [[_number(node) for node in c]],
        "MATRIX": [[_number(matrix[i, j]) for j in n] for i in n],
        "SLOPES": [[_number(power[1]) for power in powers]],
        kind: [[_number(shown[j][k]) for j in n] for k in orders],
    }
    arrays = [_array("double", f"{key}_{name}", rows) for key, rows in numbers.items()]
    arrays += [
        _array("Complex", f"VALUES_{name}", [values]),
        _array("Complex", f"LEFT_{name}", left),
        _array("Complex", f"RIGHT_{name}", right),
    ]
    members = ["NODES", "MATRIX", "SLOPES", "POWERS", "SUMS", "VALUES", "LEFT", "RIGHT"]
    unread = {"POWERS", "SUMS"} - {kind}
    listed = [str(stages), str(len(found))]
    listed += ["NULL" if key in unread else f"{key}_{name}" for key in members]
    return "\n".join([*arrays, f"const Radau RADAU_{name} = {{\n{_row(listed, '    ')}}};\n"])


def text() -> str:
    """Of the file."""
    with mp.workdps(DIGITS):
        return "\n".join([HEAD, *(rule(stages) for stages in RULES)])


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")
