"""Error against run time: the measure, the orders, and what is said of failures."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest

from autobalancer.harness import load_scene
from autobalancer.harness.accuracy.precision.measure import (
    KEYS,
    TWO_DECADES,
    Point,
    Precision,
    all_methods,
    observed_orders,
    precision,
)
from autobalancer.harness.accuracy.precision.methods import Method, coupling_methods
from autobalancer.harness.accuracy.precision.plot import best_of_groups, plot_precision
from autobalancer.harness.accuracy.precision.report import cheapest, markdown, table
from autobalancer.harness.errors import SimulationError
from autobalancer.models.monolith import simulate

pytestmark = pytest.mark.slow

CUBIC = [Method("iterated", 3, n, 1) for n in (20, 40, 80)]
HELD = [Method("jacobi", 0, n) for n in (20, 80, 160)]
LINEAR = [Method("gauss-seidel", 1, n) for n in (40, 80)]


@pytest.fixture(scope="module")
def short():
    return load_scene("two_balls").replace({"run.revolutions": 4})


@pytest.fixture(scope="module")
def measured(short):
    loose = [Method("monolith LSODA", tolerance=10.0**-k) for k in (4, 6, 8)]
    bad = [Method("jacobi", 3, 40)]
    return precision(short, seconds=12.0, methods=[*CUBIC, *HELD, *LINEAR, *loose, *bad])


def test_every_scheme_has_the_order_it_states(measured):
    assert measured.orders["iterated cubic 1 pass"] == pytest.approx(4.0, abs=0.3)
    assert measured.orders["gauss-seidel linear"] == pytest.approx(2.0, abs=0.2)
    assert measured.orders["jacobi held"] == pytest.approx(1.0, abs=0.2)


def test_reference_is_two_decades_better_than_every_point_called_ok(measured):
    ok = [point for point in measured.points if point.status == "ok"]
    assert len(ok) >= 10
    assert all(TWO_DECADES * measured.reference_error <= point.error for point in ok)


def test_errors_agree_with_a_comparison_made_by_hand(short, measured):
    from autobalancer.harness import cosimulate

    scene = short.replace({"coupling.steps_per_rev": 20, "coupling.corrections": 1})
    run = cosimulate(scene, separate=True)
    right = simulate(short.assembly(), short.profile(), run.time, method="RK45", rtol=1e-11)
    by_hand = max(
        np.max(np.abs(run[name] - right.signal(name))) / np.ptp(right.signal(name))
        for name in run.signals
    )
    (point,) = [p for p in measured.points if p.method == CUBIC[0]]
    assert point.error == pytest.approx(by_hand, rel=0.05)
    assert 0.0 < point.at_end <= point.error


def test_cubic_signals_beat_held_jacobi_a_thousandfold_at_equal_steps(measured):
    error = {point.method: point.error for point in measured.points}
    assert error[HELD[0]] > 1000.0 * error[CUBIC[0]]


def test_a_method_that_cannot_run_is_named_with_its_reason(measured):
    (point,) = [p for p in measured.points if p.method.name == "jacobi" and p.method.order == 3]
    assert point.error is None
    assert point.seconds is None
    assert "unstable" in point.status
    assert "loop gain" in point.status
    assert "unstable" in markdown(measured)


def test_methods_too_slow_for_the_time_given_are_left_out_by_name(short):
    found = precision(short.replace({"run.revolutions": 20}), seconds=0.01, methods=CUBIC)
    statuses = [point.status for point in found.points]
    assert statuses[0].startswith("ok")
    assert all(status.startswith("left out") for status in statuses[1:])


def test_json_and_csv_have_the_same_rows(measured, tmp_path):
    rows = json.loads(json.dumps(measured.as_json()))["rows"]
    assert all(tuple(row) == KEYS for row in rows)
    assert {"scene", "method", "steps_per_rev", "tolerance", "error", "seconds"} < set(KEYS)
    measured.to_csv(tmp_path / "rows.csv")
    with open(tmp_path / "rows.csv", newline="", encoding="utf-8") as stream:
        written = list(csv.DictReader(stream))
    assert len(written) == len(rows) == len(measured.points)
    assert float(written[0]["error"]) == rows[0]["error"]


def test_cheapest_is_the_fastest_that_is_exact_enough(short):
    points = [
        Point("s", Method("jacobi", 0, 20), 1e-2, 1e-2, 0.1, 1, "ok"),
        Point("s", Method("iterated", 3, 20, 1), 1e-4, 1e-4, 0.3, 1, "ok"),
        Point("s", Method("gauss-seidel", 3, 40), 5e-4, 1e-4, 0.2, 1, "ok"),
        Point("s", Method("monolith LSODA", tolerance=1e-5), 1e-6, 1e-6, 0.25, 1, "ok"),
        Point("s", Method("iterated", 3, 10, 1), None, None, None, None, "failed: why"),
    ]
    found = Precision(short, tuple(points), ("rotor.x",), 1e-12, 3)
    assert found.cheapest(1e-3).method.name == "gauss-seidel"
    assert found.cheapest(2e-4).method.name == "monolith LSODA"
    assert found.cheapest(2e-4, coupled=True).method.name == "iterated"
    assert found.cheapest(1e-8) is None
    rows = {row[1]: row for row in cheapest(found).rows}
    assert rows["1e-03"][3] == "200 ms: gauss-seidel cubic, 40 steps per revolution"
    assert rows["1e-05"][2:] == ("-", "-", "250 ms: LSODA, tolerance 1e-05", "-")
    assert set(rows["1e-07"][2:]) == {"-"}


def test_points_at_the_reference_own_error_do_not_count_for_the_order():
    points = [
        Point("s", Method("iterated", 3, n, 1), error, error, 1.0, n, "ok")
        for n, error in ((10, 1e-4), (20, 1e-4 / 16), (40, 1e-4 / 256), (80, 1e-7))
    ]
    assert observed_orders(points, own=1e-8)["iterated cubic 1 pass"] == pytest.approx(4.0)


def test_scene_without_force_exchange_is_measured_once_a_step():
    scene = load_scene("liquid_disc")
    assert {m.name for m in all_methods(scene) if "monolith" not in m.name} == {"auto"}
    assert len(coupling_methods(True)) > len(coupling_methods(False))


def test_liquid_scene_is_exact_at_any_step():
    scene = load_scene("liquid_disc").replace({"run.revolutions": 3})
    methods = [Method("auto", steps_per_rev=10), Method("monolith DOP853", tolerance=1e-6)]
    found = precision(scene, seconds=2.0, methods=methods)
    assert found.points[0].error < 1e-9
    assert "reference" in found.points[0].status


def test_scene_without_a_reference_is_refused_in_words(short, monkeypatch):
    monkeypatch.setattr("autobalancer.harness.accuracy.precision.reference.BOUND", 1e-20)
    with pytest.raises(SimulationError, match="the error cannot be measured"):
        precision(short, seconds=1.0, methods=HELD[:1])


def test_weights_that_stick_and_motors_with_contacts_have_no_reference():
    scene = load_scene("finite_weights").replace({"run.revolutions": 8})
    methods = [Method("iterated", 3, 20, 1)]
    assert precision(scene, seconds=1.0, methods=methods).points[0].error < 1e-3
    with pytest.raises(SimulationError, match="does not support rolling_resistance of 'balls'"):
        precision(scene.replace({"balls.rolling_resistance": 1e-3}), seconds=1.0, methods=methods)
    motor = {"inertia": 1.0, "stall_torque": 1.0, "no_load_speed": 9.0}
    driven = scene.replace({"operation.speed": None, "operation.motor": motor})
    with pytest.raises(SimulationError, match="motor with weight_radius"):
        precision(driven, seconds=1.0)


def test_picture_and_table_are_made_of_what_was_measured(measured, tmp_path):
    picture = plot_precision(measured, tmp_path / "precision.png")
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert len(table(measured).rows) == len(measured.points)


def test_a_picture_shows_of_each_group_the_method_that_is_cheapest_most_often():
    def points(method, *pairs):
        return [Point("two_balls", method, e, e, seconds, 1, "ok") for e, seconds in pairs]

    cheap = points(Method("monolith LSODA", tolerance=1e-4), (1e-4, 1.0), (1e-8, 2.0))
    dear = points(Method("monolith RK45", tolerance=1e-4), (1e-4, 0.9), (1e-8, 9.0))
    ours = points(Method("iterated", 3, 20, 1), (1e-2, 5.0))
    assert list(best_of_groups([*cheap, *dear, *ours])) == [cheap, ours]


def test_command_writes_what_is_asked_and_ends_with_the_cheapest_way(invoke, tmp_path, monkeypatch):
    scene = tmp_path / "short.toml"
    source = load_scene("two_balls").path.read_text(encoding="utf-8")
    scene.write_text(source.replace("revolutions = 20", "revolutions = 1"), encoding="utf-8")
    target = tmp_path / "rows.json"
    few = [*CUBIC, *HELD, Method("monolith LSODA", tolerance=1e-4)]
    module = "autobalancer.harness.accuracy.precision.measure"
    monkeypatch.setattr(f"{module}.all_methods", lambda _scene: few)
    done = invoke("precision", str(scene), "--seconds", "10", "--json", str(target))
    assert done.exit_code == 0, done.output
    assert json.loads(target.read_text(encoding="utf-8"))["rows"]
    _, last = done.output.split("Cheapest way to an error")
    assert "1e-03" in last
    assert "1e-07" in last


def test_the_machine_in_one_piece_is_the_cheapest_at_every_error(short):
    """Beside separate units, whose signals are exchanged, and SciPy."""
    separate = [Method("iterated", 3, 20, 1), Method("iterated", 3, 40, 1)]
    whole = [Method("monolith LSODA", tolerance=1e-8)]
    together = [Method("iterated", 3, tolerance=t, one_file=True) for t in (1e-1, 1e-6)]
    found = precision(short, seconds=2.0, methods=[*separate, *together, *whole])
    _, _, loose, tight, _ = found.points
    assert tight.error < 1e-6
    assert tight.error < loose.error < 1e-2
    first = cheapest(found).rows[0]
    assert float(first[-1]) > 1.0
    assert first[2] in markdown(found)
