"""Tables 1 and 2 of Filimonikhina 2017: paper, criterion, Floquet and co-simulation row by row."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...models.criteria import Criterion
from ...models.papers.dimensionless import Dimensionless
from ...models.papers.tables import TABLE_1, TABLE_2, TableRow
from ...models.stability import growth_rates
from ...models.weights import Weights
from ..errors import SceneError
from ..scene import Scene
from ..stability.boundaries import speeds
from ..stability.speeds import Speeds
from .critical_speeds import rest_row, speed_rows
from .proved import bracket_rows
from .row import Row, Rows

TABLES = (*TABLE_1, *TABLE_2)
RANGE = (0.9, 13.0)  # n, below the lowest speed of both tables and well beyond the highest
NARROWEST = 0.02  # n: Floquet finds every wider band
# what the paper's intervals miss of the exact speeds: it integrates for a finite time, and calls
# stable what grows very slowly, which Table 2's heavy damping of the supports makes common
OUTSIDE = {1: 3e-4, 2: 2.2e-2}  # n
SEARCHED = 41  # speeds across a band: near its worst one will do, to see it grow
PRINTED = 5e-4  # relative, of the criterion's roots as printed


def check_row(scene: Scene, index: int) -> Iterator[Row]:
    """One row of both tables, counted from 0: the criterion's roots, every interval, every speed.

    Raises:
        SceneError: the scene is not a planar rotor with one set of two pendulums.
    """
    row = TABLES[index]
    number = index + 1 if row.table == 1 else index + 1 - len(TABLE_1)
    yield from rows_of(number, *variant(scene, row), row)


def variant(scene: Scene, row: TableRow) -> tuple[Scene, float]:
    """The scene with a row's parameters, in its own mass, frequency and radius; and its w_x.

    Raises:
        SceneError: the scene is not a planar rotor with one set of two pendulums.
    """
    base = scene.assembly()
    try:
        _, w_x = Dimensionless.of(base)
    except ValueError as error:
        raise SceneError(f"{scene.label}: check filimonikhina_table: {error}") from error
    given = base.weights[0].device
    assert isinstance(given, Weights)
    total = float(base.loaded_rotor.mass[0, 0])
    wanted = Dimensionless.of_row(row).assembly(total, w_x, given.track_radius)
    rotor, weights = wanted.rotor, wanted.weights[0].device
    assert isinstance(weights, Weights)
    if given.count != weights.count or given.kappa != 1.0:
        raise SceneError(
            f"{scene.label}: check filimonikhina_table: the tables are of two pendulums, the scene "
            f"has {given.count} weights with kappa = {given.kappa:g}"
        )
    changes = {
        "rotor.mass": rotor.mass[0, 0],
        "rotor.stiffness": [rotor.stiffness_x[0, 0], rotor.stiffness_y[0, 0]],
        "rotor.damping": [rotor.damping_x[0, 0], rotor.damping_y[0, 0]],
        "rotor.unbalance": abs(rotor.unbalance[0]),
        "rotor.unbalance_angle": 0.0,
        f"{base.weights[0].name}.mass": weights.mass,
        f"{base.weights[0].name}.drag": weights.drag,
    }
    return scene.replace({key: np.asarray(value).tolist() for key, value in changes.items()}), w_x


def rows_of(number: int, scene: Scene, w_x: float, row: TableRow) -> Iterator[Row]:
    """What the units of `variant` say of a row of a table."""
    rows = Rows(scene.name, "filimonikhina_table")
    damping = f", mu {row.mu_xi:g}, {row.mu_eta:g}" if row.table == 2 else ""
    label = f"Table {row.table} row {number} (eps {row.eps:g}, mu_w {row.mu_w:g}{damping}): "
    source = f"Filimonikhina 2017, Table {row.table}"
    roots = np.array(Criterion.of(scene.assembly()).critical_speeds) / w_x
    yield rows.number(
        f"{label}criterion, {len(roots)} roots", np.array(row.criterion), roots, PRINTED, source
    )
    low, high = RANGE[0] * w_x, RANGE[1] * w_x
    found = speeds(scene, (low, high), narrowest=NARROWEST * w_x, separate=True)
    exact = [c.speed / w_x for c in found.methods["floquet"]]
    for k, (begin, end) in enumerate(row.intervals):
        # speeds beyond the table's are findings, not the table's
        nearest = min(exact, key=lambda n: max(begin - n, n - end))
        outside = max(begin - nearest, nearest - end, 0.0)
        limit = OUTSIDE[row.table]
        yield rows.statement(
            f"{label}n{k + 1} by Floquet in the paper's interval",
            f"{begin:g} to {end:g}",
            f"{nearest:.6g}",
            outside <= limit,
            source,
            outside,
            limit,
        )
    yield from speed_rows(rows, found, label, w_x)
    yield from bracket_rows(rows, scene, found, label, w_x)
    yield from _beyond(rows, scene, w_x, label, found, len(row.intervals))


def _beyond(
    rows: Rows, scene: Scene, w_x: float, label: str, found: Speeds, printed: int
) -> Iterator[Row]:
    """Unstable bands that the paper does not report, each shown by a nonlinear run."""
    exact = [c.speed for c in found.methods["floquet"]]
    for begin, end in zip(exact[printed::2], exact[printed + 1 :: 2], strict=False):
        note = f"{label}FINDING, unstable again from {begin / w_x:.5g} to {end / w_x:.5g}: "
        grid = np.linspace(begin, end, SEARCHED)
        worst = float(grid[np.argmax(growth_rates(scene.assembly(), grid))])
        yield rest_row(rows, scene, worst, note)
