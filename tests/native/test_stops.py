"""Cubic springs, stops and free strokes in both engines, against closed forms."""

from __future__ import annotations

import fmpy
import numpy as np
import pytest
from fmpy import platform_tuple
from scipy.interpolate import CubicHermiteSpline

import autobalancer as ab
from autobalancer.fmus.composite.build import build_composite
from autobalancer.harness import cosimulate
from autobalancer.harness.master.one_file import composition
from autobalancer.harness.master.one_file_run import OneFileRun
from autobalancer.harness.master.recorder import Recorder
from autobalancer.models.cubic_spring import CubicDisc, free_period
from autobalancer.models.free_stroke import turning_points
from autobalancer.models.stops import DiscInRing, FreeBetweenStops, restitution
from tests.studies import stops as study

pytestmark = pytest.mark.filterwarnings(
    "ignore::autobalancer.harness.scene.plausible.ImplausibleWarning"
)
XY = ("rotor.x", "rotor.y", "rotor.vx", "rotor.vy")
ENGINES = pytest.mark.parametrize("separate", [False, True], ids=["one piece", "separate units"])


def disc(seconds, speed=40.0, more=(), initial=None, **keys):
    """A disc of 1 kg and 1 N/m; without unbalance the speed sets the rows of the result alone."""
    rotor = {"mass": 1.0, "stiffness": 1.0, "damping": 0.0, "unbalance": 0.0} | keys
    return ab.Scene(
        rotor=ab.Planar(**{key: value for key, value in rotor.items() if value is not None}),
        operation={"speed": speed},
        run={"duration": seconds, "initial": initial or {}, "record": [*XY, *more]},
        coupling={"tolerance": 1e-9},
    )


def passages(run):
    """Times at which the disc passes the middle."""
    return CubicHermiteSpline(run.time, run["rotor.x"], run["rotor.vx"]).roots(extrapolate=False)


def ends_at(run):
    return np.hypot(run["rotor.x"][-1], run["rotor.y"][-1])


@ENGINES
@pytest.mark.parametrize("ratio", [0.1, 1.0, 10.0])
def test_free_motion_on_a_cubic_spring_has_the_elliptic_period(ratio, separate):
    scene = disc(10.0, cubic_stiffness=ratio, cubic="axes", initial={"x": 1.0})
    found = passages(scene.run(separate=separate))
    assert 2.0 * (found[2] - found[1]) == pytest.approx(free_period(1.0, 1.0, ratio, 1.0), rel=1e-9)


@ENGINES
@pytest.mark.parametrize("speed", [0.6, 1.0, 2.0])
def test_free_motion_between_stops_has_the_exact_period_and_force(speed, separate):
    stops = [{"gap": 0.5, "stiffness": 8.0, "kind": "x"}]
    names = [f"rotor.stop[1].{name}" for name in ("largest_force", "touches")]
    run = disc(20.0, stops=stops, initial={"vx": speed}, more=names).run(separate=separate)
    found, exact = passages(run), FreeBetweenStops.of(1.0, 1.0, 8.0, 0.5, speed)
    assert found[3] - found[1] == pytest.approx(exact.period, rel=1e-9)
    force = 8.0 * (exact.amplitude - 0.5)
    assert run[names[0]][-1] == pytest.approx(force, rel=1e-3)
    beyond = np.abs(run["rotor.x"]) > 0.5
    assert run[names[1]][-1] == np.count_nonzero(beyond[1:] & ~beyond[:-1])


@ENGINES
@pytest.mark.parametrize("ratio", [0.05, 0.2, 0.5])
def test_a_damped_stop_gives_back_the_exact_speed(ratio, separate):
    stops = [{"gap": 0.5, "stiffness": 1.0, "damping": 2.0 * ratio}]
    scene = disc(20.0, stiffness=1e-12, stops=stops, initial={"vx": 1.0})
    back = -scene.run(separate=separate)["rotor.vx"].min()
    assert back == pytest.approx(restitution(1.0, 1.0, 2.0 * ratio), abs=1e-8)


@ENGINES
def test_a_whirl_against_a_damped_ring_keeps_the_books_of_energy(separate):
    # work of the unbalance less the losses of damper and stop, integrated apart: 0.0457645587 J
    stops = [{"gap": 0.2, "stiffness": 9.0, "damping": 0.4}]
    run = disc(200.0, 1.05, damping=0.1, unbalance=0.05, stops=stops).run(separate=separate)
    x, y, vx, vy = (run[name][-1] for name in XY)
    beyond = max(0.0, np.hypot(x, y) - 0.2)
    stored = 0.5 * (vx**2 + vy**2) + 0.5 * (x * x + y * y) + 4.5 * beyond**2
    assert stored == pytest.approx(0.0457645587, abs=5.1e-11)


@pytest.mark.parametrize("speed", [1.0, 1.08, 1.2])
def test_the_rotor_whirls_on_a_cubic_spring_as_exactly_known(speed):
    run = disc(600.0, speed, damping=0.05, unbalance=0.02, cubic_stiffness=1.0).run()
    exact = CubicDisc(1.0, 1.0, 0.05, 1.0).amplitudes(0.02, speed)[0]
    assert ends_at(run) == pytest.approx(exact, rel=1e-5)


def test_the_upper_of_three_whirls_on_a_cubic_spring_stays():
    upper = CubicDisc(1.0, 1.0, 0.05, 1.0).amplitudes(0.02, 1.08)[-1]
    z = 0.02 * 1.08**2 / (1.0 - 1.08**2 + upper**2 + 0.05j * 1.08)
    begin = {"x": z.real, "y": z.imag, "vx": -1.08 * z.imag, "vy": 1.08 * z.real}
    scene = disc(600.0, 1.08, damping=0.05, unbalance=0.02, cubic_stiffness=1.0, initial=begin)
    assert ends_at(scene.run()) == pytest.approx(0.42209690, abs=1e-7)


@pytest.mark.parametrize("speed", [1.05, 1.5])
def test_the_rotor_whirls_in_a_ring_as_exactly_known(speed):
    stops = [{"gap": 0.2, "stiffness": 9.0}]
    run = disc(400.0, speed, damping=0.1, unbalance=0.05, stops=stops).run()
    exact = DiscInRing(1.0, 1.0, 0.1, 9.0, 0.2).amplitudes(0.05, speed)[0]
    assert ends_at(run) == pytest.approx(exact, rel=1e-6)


@ENGINES
@pytest.mark.parametrize(
    ("stroke", "points"), [(0.02, [0.106529, 0.022115, 0.002750]), (0.0, [0.1])]
)
def test_a_damper_with_free_stroke_turns_back_where_it_must(separate, stroke, points):
    friction = [{"limit": [5.0, 0.0], "stiffness": 2e5, "free_stroke": stroke}]
    scene = disc(2.0, 400.0, stiffness=100.0, friction=friction, initial={"x": 0.2})
    run = scene.run(separate=separate)
    x, v = run["rotor.x"], run["rotor.vx"]
    turns = np.flatnonzero(v[:-1] * v[1:] < 0.0)
    found = [max(abs(x[k]), abs(x[k + 1])) for k in turns[: len(points)]]
    assert found == pytest.approx(points, abs=6e-5 if not stroke else 1.5e-6)
    hard = turning_points(100.0, 5.0, stroke, 0.2)[1 : 1 + len(points)]
    assert found == pytest.approx(hard, abs=6e-5)  # 5 N bend the contact by 25 um


def test_within_the_free_stroke_nothing_is_lost():
    friction = [{"limit": [5.0, 5.0], "stiffness": 2e3, "free_stroke": "20 mm"}]
    scene = disc(20.0, friction=friction, initial={"x": 0.0099})
    run = scene.run()
    assert run["rotor.x"] == pytest.approx(0.0099 * np.cos(run.time), abs=1e-12)


def test_a_spring_that_softens_ends_where_it_pulls_no_more():
    scene = disc(20.0, cubic_stiffness=-1.0, initial={"x": 0.5, "vx": 1.0})
    with pytest.raises(ab.SimulationError, match=r"rotor\.cubic\[1\].*reached 1 m.*softens"):
        scene.run()
    calm = disc(20.0, cubic_stiffness=-1.0, cubic="axes", initial={"x": 0.5}).run()
    assert np.abs(calm["rotor.x"]).max() <= 0.5 + 1e-9


@pytest.mark.slow
def test_random_machines_state_their_error():
    """A sample of `python -m tests.studies.stops`."""
    rng, judged = np.random.default_rng(1), 0
    for _ in range(4):
        scene = study.machine(rng)
        try:
            true, stated, known, _ = study.judge(scene)
        except ArithmeticError:
            continue
        judged += 1
        assert not known or true <= min(1e-4, 3.0 * stated)
    assert judged >= 2


@pytest.mark.slow
def test_the_books_of_energy_of_random_machines_are_kept_to_nine_digits():
    rng = np.random.default_rng(2)
    assert max(study.energy(study.machine(rng, 1e-9, bare=True)) for _ in range(2)) <= 1e-9


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_solver_of_the_tool_meets_the_stops_as_co_simulation_does(tmp_path, fmi):
    stops = [{"gap": 0.2, "stiffness": 9.0, "damping": 0.4}]
    scene = disc(60.0, 1.05, damping=0.1, unbalance=0.05, cubic_stiffness=0.5, stops=stops)
    path = build_composite(
        composition(scene), tmp_path, name="one", fmi=fmi, platforms=[platform_tuple]
    )
    names = ["rotor.x", "rotor.y", "rotor.stop[1].touches"]
    own, solved = (
        fmpy.simulate_fmu(
            str(path), fmi_type=kind, stop_time=60.0, output_interval=0.25, output=names,
            relative_tolerance=1e-9,
        )
        for kind in ("CoSimulation", "ModelExchange")
    )  # fmt: skip
    size = np.abs(own["rotor.x"]).max()
    for name in names[:2]:
        at = np.interp(own["time"], solved["time"], solved[name])
        assert np.abs(at - own[name]).max() <= 1e-5 * size
    assert solved[names[2]][-1] == own[names[2]][-1] == 2.0


BOUNCING = {
    "rotor": {"kind": "planar", "mass": 1.0, "stiffness": 1e4, "damping": 20.0, "unbalance": 2e-3,
              "stops": [{"gap": 1e-3, "stiffness": 1e6, "damping": 10.0}]},
    "operation": {"speed": 90.0},
    "run": {"duration": 0.25, "record": [*XY, "rotor.stop[1].touches"]},
}  # fmt: skip


@ENGINES
def test_a_touch_of_a_stop_counts_once(separate):
    """As often as the disc has come to be beyond the gap, though the time of that has an error."""
    scene = ab.Scene.from_document({**BOUNCING, "coupling": {"steps_per_rev": 3000}})
    run = cosimulate(scene, separate=separate)
    beyond = np.hypot(run["rotor.x"], run["rotor.y"]) > 1e-3
    assert run["rotor.stop[1].touches"][-1] == np.count_nonzero(beyond[1:] & ~beyond[:-1]) == 23


@pytest.mark.parametrize("tolerance", [1e-3, 1e-5, 1e-7])
def test_a_touch_of_a_damped_stop_is_three_events_at_any_tolerance(tolerance):
    """Touch, letting go, back inside: found at once where the motion of the step has them."""
    scene = ab.Scene.from_document({**BOUNCING, "coupling": {"tolerance": tolerance}})
    with OneFileRun(scene) as run:
        run.start(1.0, np.array([0.0, 0.25]))
        run.record(Recorder(run.units, ["rotor.stop[1].touches"]), None)
        assert run.events[-1] == 3 * 22 + 1  # the last of 23 ends beyond the run


@pytest.fixture(scope="module")
def bouncing(tmp_path_factory):
    """A run of it as one file, by its interface and the times between two reads."""
    scene = ab.Scene.from_document({**BOUNCING, "coupling": {"tolerance": 1e-8}})
    folder = tmp_path_factory.mktemp("bouncing")
    path = build_composite(composition(scene), folder, name="one", platforms=[platform_tuple])

    def run(kind, interval):
        names = ["rotor.stop[1].touches", "rotor.stop[1].largest_force"]
        solver = {"solver": "CVode", "relative_tolerance": 1e-9} if kind == "ModelExchange" else {}
        found = fmpy.simulate_fmu(str(path), fmi_type=kind, output=names, stop_time=0.25,
                                  output_interval=interval, **solver)[-1]  # fmt: skip
        return [found[name] for name in names]

    return run


@pytest.mark.parametrize("interval", [1e-4, 1e-3, 2.5e-3, 5e-3])
def test_model_exchange_has_touches_and_largest_force_whatever_the_steps(bouncing, interval):
    """Between two reads a contact goes by, of which the unit sees both ends alone."""
    expected = bouncing("CoSimulation", 1e-4)
    assert bouncing("ModelExchange", interval) == pytest.approx(expected, rel=2e-5)


def test_a_solver_of_the_tool_is_told_where_a_stop_is_touched_and_left(tmp_path):
    """Three events a touch; two of them at the gap, on the way out and back inside."""
    scene = ab.Scene.from_document({**BOUNCING, "coupling": {"tolerance": 1e-8}})
    path = build_composite(composition(scene), tmp_path, name="one", platforms=[platform_tuple])
    solved = fmpy.simulate_fmu(str(path), fmi_type="ModelExchange", output=XY, solver="CVode",
                               relative_tolerance=1e-9, stop_time=0.25, output_interval=1e-4,
                               record_events=True)  # fmt: skip
    events = solved[1:][np.diff(solved["time"]) == 0.0]
    beyond = np.hypot(events["rotor.x"], events["rotor.y"]) / 1e-3 - 1.0
    outwards = events["rotor.x"] * events["rotor.vx"] + events["rotor.y"] * events["rotor.vy"] > 0.0
    at_gap = abs(beyond) < 1e-9
    assert len(events) == 3 * 22 + 1
    assert np.count_nonzero(at_gap & outwards) == 23
    assert np.count_nonzero(at_gap & ~outwards) == 22


def test_the_largest_force_of_model_exchange_is_not_beyond_that_of_a_hard_damper(tmp_path):
    """It falls to nothing, with a time of 1/21, in a step of the solver, from the touch on."""
    stops = [{"gap": 0.5, "stiffness": 100.0, "damping": 2000.0}]
    scene = disc(0.6, stiffness=1e-12, stops=stops, initial={"vx": 1.0})
    path = build_composite(composition(scene), tmp_path, name="one", platforms=[platform_tuple])
    name = "rotor.stop[1].largest_force"
    found = fmpy.simulate_fmu(str(path), fmi_type="ModelExchange", output=[name], solver="CVode",
                              relative_tolerance=1e-9, stop_time=0.6,
                              output_interval=0.02)[-1]  # fmt: skip
    assert found[name] == pytest.approx(2000.0, rel=1e-6)


@ENGINES
@pytest.mark.parametrize("held", ["stops", "friction"])
def test_a_table_of_bearings_that_begins_above_rest_goes_with_stops_and_friction(held, separate):
    """The numbers of the table are the same at every speed that it holds: those of the supports."""
    more = {"stops": [{"support": 1, "gap": 0.02, "stiffness": 50.0}]}
    if held == "friction":
        more = {"friction": [{"limit": [0.004, 0.004], "stiffness": [20.0, 20.0]}]}
    rows = [[speed, 1.0, 0.0, 0.0, 1.0, 0.1, 0.0, 0.0, 0.1] for speed in (30.0, 50.0)]
    start = {"x": 0.05, "vy": 0.02}
    plain = disc(3.0, stiffness=1.0, damping=0.1, initial=start, **more)
    table = disc(
        3.0, stiffness=None, damping=None, initial=start, bearings=[{"table": rows}], **more
    )
    runs = [scene.run(separate=separate) for scene in (plain, table)]
    times = np.linspace(0.0, 3.0, 50)
    found = [np.array([np.interp(times, run.time, run[n]) for n in XY]) for run in runs]
    np.testing.assert_allclose(found[1], found[0], atol=1e-5)
