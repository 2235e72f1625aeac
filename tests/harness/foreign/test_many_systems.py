"""Scatter and fit of systems of FMUs: by the names of their signals, against exact solutions."""

from __future__ import annotations

import json

import numpy as np
import pytest
import tomli_w
from scipy.stats import norm

import autobalancer as ab

DURATION = 2.0


@pytest.fixture
def mass(guest):
    """A mass of 1 kg on a spring, displaced by 1 m: x = cos(sqrt(k) t) without damping."""
    return ab.System(
        unit=[{"name": "m", "fmu": str(guest("mass")), "start": {"x0": 1.0, "c": 0.0, "k": 10.0}}],
        coupling={"step": 0.02},
        run={"duration": DURATION, "record": ["m.x", "m.v"]},
    )


def write(path, time, *columns):
    """A CSV file of measurements, from heads and values."""
    heads = ",".join(["time [s]", *(head for head, _ in columns)])
    rows = np.column_stack([time, *(values for _, values in columns)]).tolist()
    path.write_text("\n".join([heads, *(",".join(map(repr, row)) for row in rows)]))
    return path


def test_the_spread_of_a_signal_is_that_of_the_exact_solution(mass):
    found = mass.scatter({"m.k": norm(10.0, 0.5), "m.x0": "uniform(0.9,1.1)"}, n=40, seed=3)
    stiffness, start = found.values.T
    end = start * np.cos(np.sqrt(stiffness) * DURATION)
    np.testing.assert_allclose(found.end[:, 0], end, atol=1e-5)
    np.testing.assert_allclose(found.largest[:, 0], start, rtol=1e-2)
    importance = found.as_json()["signals"]["m.x"]["importance"]
    assert importance[0]["path"] == "m.x0"


def test_the_same_seed_draws_the_same_systems_in_any_number_of_processes(mass):
    vary = ["m.k=normal(10,5%)"]
    runs = [mass.scatter(vary, n=6, seed=7, workers=workers) for workers in (1, 2)]
    np.testing.assert_array_equal(runs[0].end, runs[1].end)


def test_a_system_that_fails_costs_itself_alone(mass):
    """Masses between -1 and 1 kg on a stiff spring: those below 0 move beyond all bounds."""
    system = mass.replace({"m.k": 1e3, "run.duration": 30.0, "coupling.step": 0.5})
    found = system.scatter({"m.m": "uniform(-1,1)"}, n=12)
    assert found.ran.tolist() == (found.values[:, 0] > 0.0).tolist()
    assert "m.x is no finite number at t = " in found.failure[~found.ran][0]
    assert np.isfinite(found.end[found.ran]).all()
    assert found.as_json()["failed"] == (~found.ran).sum()


def test_a_fit_finds_the_values_that_made_the_signals(mass, tmp_path):
    time = np.linspace(0.05, 1.95, 20)
    x, v = np.cos(3.5 * time), -3.5 * np.sin(3.5 * time)
    measured = write(tmp_path / "measured.csv", time, ("m.x", x), ("m.v", v))
    found = mass.fit(measured, "m.k")
    assert found.values[0] == pytest.approx(3.5**2, rel=1e-3)
    assert found.rms[1] < 1e-3 < found.rms[0]
    assert found.system.unit[0].start["k"] == found.values[0]
    assert found.predicted_rms(measured) == pytest.approx(found.rms[1], rel=1e-6)


def test_intervals_are_as_wide_as_values_scatter(mass, tmp_path):
    """95 % are 2.07 standard deviations: deviations over intervals have an rms near 0.48."""
    time, random = np.linspace(0.05, 1.95, 25), np.random.default_rng(5)
    decay = 0.2
    turn = np.sqrt(3.5**2 - decay**2)
    x = np.exp(-decay * time) * (np.cos(turn * time) + decay / turn * np.sin(turn * time))
    start, shares = mass.replace({"m.c": 0.3, "coupling.step": 0.05}), []
    for number in range(10):
        noisy = x + 0.02 * random.standard_normal(len(x))
        found = start.fit(write(tmp_path / f"{number}.csv", time, ("m.x", noisy)), ["m.k", "m.c"])
        shares += ((found.values - [3.5**2, 2.0 * decay]) / found.uncertainty).tolist()
    known = np.array([share for share in shares if np.isfinite(share)])
    assert len(known) >= 14  # none is given where residuals happen to look systematic
    assert 0.2 < np.sqrt(np.mean(known**2)) < 0.8
    assert (np.abs(known) > 1.0).sum() <= 3


def test_units_of_measurement_in_the_heads_are_converted(guest, altered, tmp_path):
    def edit(text):
        defined = '<UnitDefinitions><Unit name="m"><BaseUnit m="1"/></Unit></UnitDefinitions>'
        text = text.replace("<LogCategories>", f"{defined}<LogCategories>")
        real = text.index("<Real", text.index('name="x"'))
        return f'{text[:real]}<Real unit="m"{text[real + 5 :]}'

    file = altered(guest("mass"), edit)
    start = {"x0": 1.0, "c": 0.0, "k": 10.0}
    system = ab.System(unit=[{"name": "m", "fmu": str(file), "start": start}],
                       coupling={"step": 0.02}, run={"duration": 2.0})  # fmt: skip
    time = np.linspace(0.1, 1.9, 10)
    path = write(tmp_path / "mm.csv", time, ("m.x [mm]", 1e3 * np.cos(3.5 * time)))
    assert system.fit(path, "m.k").values[0] == pytest.approx(3.5**2, rel=1e-3)
    wrong = write(tmp_path / "wrong.csv", time, ("m.x [kg]", np.cos(time)))
    with pytest.raises(ab.UserError, match="different dimensions"):
        system.fit(wrong, "m.k")


def test_elements_of_arrays_are_measured_and_free_by_their_names(guest, altered, tmp_path):
    def edit(text):
        return text.replace('name="x"', 'name="x[1]"').replace('name="k"', 'name="k[1,2]"')

    file = altered(guest("mass"), edit)
    start = {"x0": 1.0, "c": 0.0, "k[1,2]": 10.0}
    system = ab.System(unit=[{"name": "m", "fmu": str(file), "start": start}],
                       coupling={"step": 0.02}, run={"duration": 2.0})  # fmt: skip
    time = np.linspace(0.1, 1.9, 10)
    for number, head in enumerate(("m.x[1]", "m.x[1] [m]")):
        path = write(tmp_path / f"{number}.csv", time, (head, np.cos(3.5 * time)))
        assert system.fit(path, "m.k[1,2]").values[0] == pytest.approx(3.5**2, rel=1e-3)


def test_a_run_that_ends_before_the_last_measurement_is_refused(mass, tmp_path, monkeypatch):
    def ended_early(_run, names, _changes):
        time = np.linspace(0.0, 1.0, 50)
        return time, {name: np.cos(3.5 * time) for name in names}

    monkeypatch.setattr("autobalancer.harness.fit.systems.recorded_again", ended_early)
    time = np.linspace(0.1, 1.9, 10)
    path = write(tmp_path / "long.csv", time, ("m.x", np.cos(3.5 * time)))
    with pytest.raises(ab.SimulationError, match=r"ends at t = 1 s, .* at 1\.9 s"):
        mass.fit(path, "m.k")


def test_a_value_that_is_no_distribution_is_refused_with_what_is_one(mass):
    with pytest.raises(ab.UserError, match=r"m\.x0 = 3.0: must be a text such as"):
        mass.scatter({"m.x0": 3.0}, n=3)


def test_commands_say_draw_and_write_both(mass, tmp_path, invoke):
    scene = tmp_path / "mass.toml"
    scene.write_text(tomli_w.dumps(mass.document))
    files = [tmp_path / name for name in ("s.csv", "s.png", "s.json", "f.png", "f.json")]
    done = invoke("scatter", scene, "--vary", "m.k=normal(10,5%)", "-n", "8", "-o", files[0],
                  "-o", files[1], "--json", files[2])  # fmt: skip
    assert done.exit_code == 0, done.output
    assert "8 systems, seed 1: 0 failed" in done.output
    assert json.loads(files[2].read_text())["signals"]["m.x"]["end"]["0.5"]
    time = np.linspace(0.1, 1.9, 10)
    path = write(tmp_path / "x.csv", time, ("m.x", np.cos(3.5 * time)))
    done = invoke("fit", scene, "--measured", path, "--free", "m.k", "-o", files[3],
                  "--json", files[4], "--predict", path)  # fmt: skip
    assert done.exit_code == 0, done.output
    assert '--set "m.k=12.25' in done.output
    assert all(file.stat().st_size > 100 for file in files)


WRONG = {
    "no unit": (
        ["--vary", "q.k=normal(1,5%)"],
        "must be UNIT.VARIABLE, a start value of one of: m",
    ),
    "no variable": (["--vary", "m.q=normal(1,5%)"], "Mass.fmu has no variable 'q'"),
    "an output": (["--vary", "m.x=normal(1,5%)"], "is an output of Mass.fmu, and cannot be set"),
    "twice": (["--vary", "m.k=uniform(1,2)", "--vary", "m.k=uniform(1,2)"], "given 2 times"),
    "a report": (["--vary", "m.k=uniform(1,2)", "--report", "a.html"], "has no rotor"),
}


@pytest.mark.parametrize("case", WRONG)
def test_what_cannot_vary_is_refused_with_what_can(case, mass, tmp_path, invoke):
    (tmp_path / "mass.toml").write_text(tomli_w.dumps(mass.document))
    options, words = WRONG[case]
    done = invoke("scatter", tmp_path / "mass.toml", "-n", "2", *options)
    assert done.exit_code == 2, done.output
    assert words in " ".join(done.output.split())


FILES = {
    "no time": ("m.x\n1\n2\n", "must have a column time [s]"),
    "no signal": ("time\n1\n2\n", "and one at least UNIT.VARIABLE"),
    "unknown unit": ("time,q.x\n0,1\n1,2\n", "must be time [s] or UNIT.VARIABLE"),
    "unknown signal": ("time,m.q\n0,1\n1,2\n", "Mass.fmu has no variable 'q'"),
    "falls": ("time,m.x\n1,1\n0.5,2\n", "must be numbers from 0 on that rise"),
    "beyond the end": ("time,m.x\n1,1\n9,2\n", "beyond run.duration = 2 s: set that higher"),
    "text": ("time,m.x\n0,1\n1,many\n", "m.x = 'many': must be a number"),
    "empty": ("time,m.x\n0,\n1,\n", "m.x: has no values"),
    "too few": ("time,m.x\n1,1\n", "1 measured value for 1 free parameter:"),
}


@pytest.mark.parametrize("case", FILES)
def test_wrong_measurements_are_refused_with_what_is_wrong(case, mass, tmp_path, invoke):
    (tmp_path / "mass.toml").write_text(tomli_w.dumps(mass.document))
    text, words = FILES[case]
    (tmp_path / "m.csv").write_text(text)
    done = invoke("fit", tmp_path / "mass.toml", "--measured", tmp_path / "m.csv", "--free", "m.k")
    assert done.exit_code == 2, done.output
    assert words in " ".join(done.output.split())


def test_what_cannot_be_free_is_refused(mass, tmp_path):
    path = write(tmp_path / "x.csv", np.array([0.1, 0.2]), ("m.x", np.array([1.0, 1.0])))
    for free, words in (("m.c", "starts at 0"), ("q.k", "must be UNIT.VARIABLE"),
                        ("m.q", "has no variable 'q'"), ("m.x", "cannot be set")):  # fmt: skip
        with pytest.raises(ab.UserError, match=words):
            mass.fit(path, free)
