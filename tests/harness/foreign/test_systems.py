"""Systems of units of others, coupled by the master, against exact solutions."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

import autobalancer as ab
from tests.studies.masters.__main__ import deviation, system_of
from tests.studies.masters.problems import bolted

K = (10.0, 20.0)  # N/m to the ground, of either mass
PORTS = {"a.x": "s.x1", "a.v": "s.v1", "b.x": "s.x2", "b.v": "s.v2", "s.F": "a.F"}


@pytest.fixture(scope="module")
def chain(guest):
    """Two masses of 1 kg, a spring of 5 N/m and 0.2 N s/m between them; c is displaced."""

    def make(state: bool = True, order: str = "asb", **coupling) -> ab.System:
        mass, spring = guest("mass", state), guest("spring", state)
        files = {"a": (mass, {"x0": 1.0}), "b": (mass, {"k": K[1]}), "s": (spring, {})}
        unit = [{"name": n, "fmu": str(files[n][0]), "start": files[n][1]} for n in order]
        wires = [{"from": source, "to": target} for source, target in PORTS.items()]
        wires.append({"from": "s.F", "to": "b.F", "factor": -1})
        return ab.System(unit=unit, connection=wires, coupling=coupling, run={"duration": 1.0})

    return make


def exact(time):
    k, c = 5.0, 0.2
    matrix = np.array([
        [0, 1, 0, 0],
        [-(K[0] + k), -(0.1 + c), k, c],
        [0, 0, 0, 1],
        [k, c, -(K[1] + k), -(0.1 + c)],
    ])  # fmt: skip
    return np.array([expm(matrix * t) @ [1.0, 0.0, 0.0, 0.0] for t in time]).T


def error(result):
    x, _, y, _ = exact(result.time)
    return max(np.abs(result["a.x"] - x).max(), np.abs(result["b.x"] - y).max())


@pytest.mark.parametrize("scheme", ["jacobi", "gauss-seidel", "iterated"])
def test_errors_shrink_with_the_square_of_the_step(chain, scheme):
    coarse, fine = (error(chain(scheme=scheme, step=h).run()) for h in (0.05, 0.0125))
    assert fine < coarse / 12.0  # 16 by order 2, 4 by order 1


def test_errors_shrink_with_the_square_of_the_step_without_states(chain):
    """Nothing is taken back: brief steps at the start, and at the end of each, show what acts."""
    coarse, fine = (error(chain(state=False, step=h).run()) for h in (0.05, 0.0125))
    assert fine < coarse / 12.0


def test_a_tolerance_is_kept_and_the_error_stated(chain):
    result = chain(tolerance=1e-3).run()
    x, v, _, _ = exact(result.time)
    force = 5.0 * (exact(result.time)[2] - x) + 0.2 * (exact(result.time)[3] - v)
    wrong = np.abs(result["s.F"] - force).max() / np.abs(force).max()
    assert wrong < 1e-3
    assert wrong / 3.0 < result.estimated_error < 1e-3


def test_the_order_in_the_file_does_not_matter(chain):
    """The units step in the order with the fewest assumed signals, whatever the file's."""
    runs = [chain(order=o, scheme="gauss-seidel", step=0.02).run() for o in ("asb", "sba", "bas")]
    names = ["a.x", "b.x", "s.F"]
    first = np.array([runs[0][name] for name in names])
    for run in runs[1:]:
        np.testing.assert_allclose([run[n] for n in names], first, rtol=0, atol=1e-12)


def test_one_input_takes_the_sum_of_two_outputs(guest):
    """Two springs of 5 N/m between one mass and the ground act as one of 10 N/m."""
    mass, spring = str(guest("mass")), str(guest("spring"))
    unit = [{"name": "m", "fmu": mass, "start": {"x0": 1.0, "k": 0.0, "c": 0.0}}]
    unit += [{"name": n, "fmu": spring, "start": {"c": 0.0}} for n in ("s", "t")]
    wires = [{"from": "m.x", "to": "s.x1"}, {"from": "m.x", "to": "t.x1"}]
    wires += [{"from": "s.F", "to": "m.F"}, {"from": "t.F", "to": "m.F", "add": True}]
    system = ab.System(unit=unit, connection=wires, coupling={"step": 1e-2}, run={"duration": 2.0})
    result = system.run()
    np.testing.assert_allclose(result["m.x"], np.cos(np.sqrt(10.0) * result.time), atol=1e-3)


def test_whole_numbers_and_booleans_go_from_point_to_point(guest):
    moody = str(guest("moody"))
    unit = [{"name": name, "fmu": moody} for name in ("a", "b")]
    wires = [{"from": "a.steps", "to": "b.into"}, {"from": "a.on", "to": "b.enable"}]
    system = ab.System(unit=unit, connection=wires, coupling={"step": 0.1}, run={"duration": 0.5})
    result = system.run()
    assert result["a.steps"].tolist() == [0, 1, 2, 3, 4, 5]
    assert result["b.y"].tolist() == [0, 1, 2, 3, 4, 5]  # the sender has stepped before
    assert result["b.on"].tolist() == [0, 0, 0, 0, 0, 0]


def test_units_of_measurement_are_converted(guest, altered):
    """A mass that shows millimetres feeds a spring that wants metres."""
    definitions = (
        '<UnitDefinitions><Unit name="mm"><BaseUnit m="1" factor="0.001"/></Unit>'
        '<Unit name="m"><BaseUnit m="1"/></Unit></UnitDefinitions><LogCategories>'
    )

    def measured(unit):
        def edit(text):
            text = text.replace("<LogCategories>", definitions)
            for name in ('name="x"', 'name="x1"'):
                at = text.find(name)
                if at >= 0:
                    real = text.index("<Real", at)
                    text = f'{text[:real]}<Real unit="{unit}"{text[real + 5 :]}'
            return text

        return edit

    mass = altered(guest("mass"), measured("mm"), name="mass.fmu")
    spring = altered(guest("spring"), measured("m"), name="spring.fmu")
    system = ab.System(
        unit=[
            {"name": "m", "fmu": str(mass), "start": {"x0": 2.0}},
            {"name": "s", "fmu": str(spring)},
        ],
        connection=[{"from": "m.x", "to": "s.x1"}],
        coupling={"step": 0.1},
        run={"duration": 0.1},
    )
    result = system.run()
    assert result["s.F"][-1] == pytest.approx(-5.0 * result["m.x"][-1] / 1000.0, rel=1e-12)
    assert result.signal_units["m.x"] == "mm"


@pytest.mark.parametrize("state", [True, False])
@pytest.mark.parametrize("scheme", ["jacobi", "gauss-seidel"])
def test_explicit_schemes_solve_a_loop_gain_above_one(guest, scheme, state):
    """y = 1.5 u + 1 twice round: gain 2.25; what each step answers would grow for ever."""
    moody = str(guest("moody", state))
    unit = [{"name": n, "fmu": moody, "start": {"mood": "gain"}} for n in ("a", "b")]
    wires = [{"from": "a.y", "to": "b.u"}, {"from": "b.y", "to": "a.u"}]
    coupling = {"scheme": scheme, "step": 0.01}
    system = ab.System(unit=unit, connection=wires, coupling=coupling, run={"duration": 1.0})
    result = system.run()
    assert result["a.y"] == pytest.approx(-2.0, rel=1e-6)  # y = 1.5 y + 1
    said = "algebraic loop: a.y, b.y (made consistent behind every step; loop gain "
    assert any(said in event for event in result.events)


@pytest.mark.parametrize("gain", [0.1, 0.5, 3.0])
@pytest.mark.parametrize("scheme", ["jacobi", "gauss-seidel"])
@pytest.mark.parametrize("state", [True, False])
def test_explicit_schemes_err_by_the_square_of_the_step_at_any_gain(guest, state, scheme, gain):
    """A bracket on a mass; extrapolation alone is unstable from a gain of 1/3 on."""
    problem = bolted(gain)
    fmus = {name: guest(name, state) for name in ("mass", "bracket")}

    def wrong(step):
        result = system_of(problem, fmus, scheme=scheme, step=step).run()
        return deviation(problem, result.time, result.signals)

    assert wrong(0.005) < wrong(0.02) / 12.0  # 16 by order 2


def test_a_loop_that_cannot_be_seen_ends_where_it_grows(guest, altered):
    """No states, no steps of other lengths, nothing shown in initialisation mode."""
    declared = "canHandleVariableCommunicationStepSize"

    def edit(text):
        assert f'{declared}="true"' in text
        return text.replace(f'{declared}="true"', f'{declared}="false"')

    moody = str(altered(guest("moody", state=False), edit))
    unit = [{"name": n, "fmu": moody, "start": {"mood": "gain"}} for n in ("a", "b")]
    wires = [{"from": "a.y", "to": "b.u"}, {"from": "b.y", "to": "a.u"}]
    system = ab.System(unit=unit, connection=wires, coupling={"step": 0.01}, run={"duration": 10.0})
    with pytest.raises(ab.SimulationError, match="grow without bound"):
        system.run()


def test_fmi_3_runs_as_fmi_2(tmp_path):
    scene = ab.load("two_balls")
    found = []
    for fmi in (2, 3):
        built = ab.build_files(scene, tmp_path / str(fmi), fmi=fmi)
        rotor = next(p for p in built.files if p.name == "rotor.fmu")
        system = ab.load_system(rotor).replace({"run.duration": 0.5, "coupling.step": 0.01})
        name = system.unit[0].name
        found.append(system.replace({f"{name}.x0": 1e-3}).run(record=[f"{name}.x"])[f"{name}.x"])
    np.testing.assert_array_equal(*found)
    assert np.ptp(found[0]) > 1e-4


@pytest.mark.parametrize("suggested", ["0", "INF", "-1"])
def test_an_fmu_that_suggests_no_length_of_a_run_runs_for_a_second(suggested, guest, altered):
    element = f'<DefaultExperiment stopTime="{suggested}" stepSize="{suggested}"/><ModelVariables>'
    path = altered(guest("mass"), lambda text: text.replace("<ModelVariables>", element))
    system = ab.load_system(path)
    assert (system.run.duration, system.coupling.step) == (1.0, 0.002)


def test_an_fmu_that_suggests_a_later_start_is_refused_with_the_way_out(guest, altered):
    """It would run from 0 s, and until its stop time: not what it suggests."""
    element = '<DefaultExperiment startTime="5" stopTime="7.5"/><ModelVariables>'
    path = altered(guest("mass"), lambda text: text.replace("<ModelVariables>", element))
    with pytest.raises(ab.UnitError, match=r"startTime = 5: units start at 0 s here.*n = 2\.5"):
        ab.load_system(path)


def test_the_fixture_runs_a_system_and_its_signals_assert_themselves(cosim, guest, tmp_path):
    (tmp_path / "mass.toml").write_text(
        f'unit = [{{name = "m", fmu = "{guest("mass")}", start = {{x0 = 1.0, c = 0.0}}}}]\n'
        "coupling.step = 0.01\nrun.duration = 1.0\n"
    )
    result = cosim(tmp_path / "mass.toml", **{"m.k": 4.0})
    result.assert_close("m.x", np.cos(2.0 * result.time), 1e-6)
    result.assert_bounded("m.x", 1.0 + 1e-9)
    assert result.to_csv(tmp_path / "mass.csv").read_text().startswith("time,m.x")
    assert result.plot(tmp_path / "mass.png").stat().st_size > 1000
    with pytest.raises(AssertionError, match="differs by"):
        result.assert_close("m.x", 0.0, 1e-6)
