"""Published numbers of Filimonikhina 2017, with which the code is compared: Tables 1 and 2.

Two pendulums (kappa = 1) at 2 pi/3 and 4 pi/3, unbalance that of one weight, n_eta = 7.  The paper
found each critical speed by integrating the motion and gives the interval that holds it.
"""

from __future__ import annotations

from dataclasses import dataclass

STIFFNESS_RATIO = 7.0  # n_eta
UNBALANCE = 0.5  # of the weights' capacity
ANGLES = (2.0943951023931953, 4.1887902047863905)  # rad


@dataclass(frozen=True)
class TableRow:
    """One row, in the paper's dimensionless parameters (8).

    Attributes:
        table: 1 or 2.
        eps, mu_w, mu_xi, mu_eta: weights' mass, their drag, damping of the supports.
        criterion: roots of (18) as the paper prints them.
        intervals: of each critical speed n, as the paper prints them.
    """

    table: int
    eps: float
    mu_w: float
    mu_xi: float
    mu_eta: float
    criterion: tuple[float, ...]
    intervals: tuple[tuple[float, float], ...]


def _first(eps: float, mu_w: float, *starts: float) -> TableRow:
    spans = tuple((start, round(start + 0.05, 10)) for start in starts)
    return TableRow(1, eps, mu_w, 0.25, 0.5, (1.003, 5.041, 6.925), spans)


def _second(
    eps: float, mu_w: float, mu_xi: float, mu_eta: float, criterion: float, low: float, high: float
) -> TableRow:
    return TableRow(2, eps, mu_w, mu_xi, mu_eta, (criterion,), ((low, high),))


TABLE_1 = (
    _first(0.001, 0.25, 1.0, 5.0, 7.45),
    _first(0.001, 1.0, 1.0, 5.0, 7.0),
    _first(0.001, 5.0, 1.0, 5.0, 6.90),
    _first(0.01, 0.5, 1.0, 5.0, 8.3),
    _first(0.01, 5.0, 1.0, 5.0, 7.05),
    _first(0.01, 25.0, 1.0, 5.0, 6.90),
    _first(0.1, 0.5, 1.1, 5.10, 9.95),
    _first(0.1, 1.0, 1.05, 5.15, 9.75),
    _first(0.1, 2.0, 1.0, 5.10, 9.70),
    _first(0.1, 25.0, 1.0, 5.05, 7.15),
    _first(0.1, 50.0, 1.0, 5.0, 7.0),
)

# the first three rows of Table 2 stand for mu_w = 0.5 to 5: both ends are listed
TABLE_2 = (
    _second(0.01, 0.5, 1.0, 2.0, 1.044, 1.0, 1.10),
    _second(0.01, 5.0, 1.0, 2.0, 1.044, 1.0, 1.10),
    _second(0.01, 0.5, 2.5, 5.0, 1.411, 1.40, 1.45),
    _second(0.01, 5.0, 2.5, 5.0, 1.411, 1.40, 1.45),
    _second(0.01, 0.5, 0.5, 1.5, 1.011, 1.0, 1.05),
    _second(0.01, 5.0, 0.5, 1.5, 1.011, 1.0, 1.05),
    _second(0.01, 0.5, 3.0, 2.0, 6.278, 8.65, 8.70),
    _second(0.01, 0.5, 5.0, 2.5, 6.431, 9.45, 9.50),
    _second(0.01, 0.5, 5.0, 5.0, 5.0, 11.70, 11.75),
    _second(0.001, 0.5, 3.0, 2.0, 6.27780, 6.45, 6.50),
    _second(0.001, 0.5, 5.0, 2.5, 6.43059, 6.60, 6.65),
    _second(0.001, 0.5, 5.0, 5.0, 5.0, 5.10, 5.15),
    _second(0.01, 5.0, 3.0, 2.0, 6.27780, 6.30, 6.35),
    _second(0.01, 5.0, 5.0, 2.5, 6.43059, 6.45, 6.50),
    _second(0.01, 5.0, 5.0, 5.0, 5.0, 5.0, 5.05),
)
