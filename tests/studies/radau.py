"""Write the numbers of Radau's rule with seven points, as `fmus/native/machine/radau.c` has them.

    python -m tests.studies.radau

The points are the zeros of P7(2 t - 1) - P6(2 t - 1) (Hairer & Wanner, Solving Ordinary
Differential Equations II, IV.5).  The rest follows from them: integrals and coefficients of
interpolating polynomials, and the eigenvalues and vectors of the integrals.  All with 60 digits, by
mpmath.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import mpmath as mp

STAGES, DIGITS, WIDTH = 7, 60, 110
FILE = Path(__file__).resolve().parents[2] / "fmus" / "native" / "machine" / "radau.c"
HEAD = """\
/* Radau's rule with seven points: written by `python -m tests.studies.radau`. */
#include "machine/collocation.h"
"""


def nodes() -> list[Any]:
    """Points within a step of length 1, ascending; the last is its end."""

    def legendre(degree: int) -> Any:
        return mp.taylor(lambda t: mp.legendre(degree, 2 * t - 1), 0, STAGES)

    series = [a - b for a, b in zip(legendre(STAGES), legendre(STAGES - 1), strict=True)]
    found = mp.polyroots(series[::-1], maxsteps=500, extraprec=400)
    return [*sorted(mp.re(root) for root in found)[:-1], mp.mpf(1)]


def modes(matrix: Any) -> list[tuple[Any, list[Any], list[Any]]]:
    """Eigenvalues, the real one first, with left and right vectors; right ones end with 1."""
    values, right = mp.eig(matrix)
    left = right**-1
    chosen = sorted(
        (k for k in range(STAGES) if mp.im(values[k]) > -(mp.mpf(10) ** (10 - DIGITS))),
        key=lambda k: mp.im(values[k]),
    )
    last = STAGES - 1
    return [
        (
            values[k],
            [left[k, i] * right[last, k] for i in range(STAGES)],
            [right[i, k] / right[last, k] for i in range(STAGES)],
        )
        for k in chosen
    ]


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


def _table(kind: str, name: str, rows: list[list[str]]) -> str:
    inner = ",\n".join(f"    {{{_row(row, '     ').lstrip()}}}" for row in rows)
    return f"const {kind} {name} = {{\n{inner}}};\n"


def text() -> str:
    """Of the file."""
    with mp.workdps(DIGITS):
        c, n = nodes(), range(STAGES)
        inverse = mp.matrix(STAGES, STAGES)
        for i in n:
            for k in n:
                inverse[i, k] = c[i] ** k
        inverse = inverse**-1
        matrix = mp.matrix(STAGES, STAGES)
        for i in n:
            for j in n:
                matrix[i, j] = mp.fsum(c[i] ** (k + 1) / (k + 1) * inverse[k, j] for k in n)
        found = modes(matrix)
        real = [k == 0 for k in range(len(found))]
        values = [_complex(mode[0], is_real) for mode, is_real in zip(found, real, strict=True)]
        sides = [
            [[_complex(z, r) for z in mode[k]] for mode, r in zip(found, real, strict=True)]
            for k in (1, 2)
        ]
        return (
            "\n".join(
                [
                    HEAD,
                    f"const double RADAU_NODES[STAGES] = {{\n{_row(map(_number, c), '    ')}}};\n",
                    _table(
                        "double",
                        "RADAU_MATRIX[STAGES][STAGES]",
                        [[_number(matrix[i, j]) for j in n] for i in n],
                    ),
                    _table(
                        "double",
                        "RADAU_COEFFICIENTS[STAGES][STAGES]",
                        [[_number(inverse[k, j] / c[j]) for j in n] for k in n],
                    ),
                    f"const Complex RADAU_VALUES[MODES] = {{\n{_row(values, '    ')}}};\n",
                    _table("Complex", "RADAU_LEFT[MODES][STAGES]", sides[0]),
                    _table("Complex", "RADAU_RIGHT[MODES][STAGES]", sides[1]).rstrip("\n"),
                ]
            )
            + "\n"
        )


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")
