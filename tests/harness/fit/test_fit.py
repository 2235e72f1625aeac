"""Values found again from amplitudes of a closed form, how well they are known, and wrong input."""

import json
import math

import numpy as np
import pytest
from scipy.optimize import curve_fit, least_squares
from scipy.stats import t as student

from autobalancer.harness import UserError, cosimulate, load_scene
from autobalancer.harness.fit.measured import read_measured
from autobalancer.harness.fit.parameters import parse_free
from autobalancer.harness.fit.study import fit
from autobalancer.harness.result.many import cosimulate_many
from autobalancer.models.harmonic_balance import largest_displacement, unbalance_response

pytestmark = pytest.mark.slow

MASS, STIFFNESS, DAMPING, UNBALANCE = 2.0, 800.0, 6.0, 0.01
SPEEDS = np.linspace(8.0, 45.0, 24)
HEADS = "speed,rotor.unbalance,amplitude [mm]\n"


@pytest.fixture
def rotor():
    """A Jeffcott rotor whose transient has died out."""
    start = {"rotor.mass": MASS, "rotor.stiffness": 1000.0, "rotor.damping": 4.0}
    run = {"run.revolutions": 50, "coupling.steps_per_rev": 20}
    return load_scene("two_balls").without_balancers().replace(start | run)


def amplitude(speed, stiffness, damping, unbalance=UNBALANCE, mass=MASS):
    return unbalance * speed**2 / np.hypot(stiffness - mass * speed**2, damping * speed)


@pytest.fixture
def file(tmp_path):
    """A file of amplitudes at two unbalances, which scatter by 3 %."""
    scatter = np.exp(0.03 * np.random.default_rng(5).standard_normal(2 * len(SPEEDS)))
    rows = [(w, u) for u in (UNBALANCE, 0.02) for w in SPEEDS]
    values = [1e3 * amplitude(w, STIFFNESS, DAMPING, u) for w, u in rows] * scatter
    path = tmp_path / "measured.csv"
    lines = [f"{w},{u},{value}\n" for (w, u), value in zip(rows, values, strict=True)]
    path.write_text(f"# of the rig\n{HEADS}{''.join(lines)}")
    return path


FREE = ["rotor.stiffness[1]=rotor.stiffness[2],rotor.damping"]


def test_values_and_intervals_are_those_of_fits_of_the_closed_form(rotor, file):
    """The interval about the values of the one without run-out includes that of the other."""
    measured = read_measured(file, rotor)
    found = fit(rotor, measured, parse_free(FREE, rotor))
    unbalances, values = measured.settings["rotor.unbalance"], measured.values

    def curve(speed, stiffness, damping, *runout):
        pull = stiffness - MASS * speed**2 + 1j * damping * speed
        vector = complex(*runout) * UNBALANCE / MASS if runout else 0.0
        return np.log(np.abs(unbalances * speed**2 / pull + vector))

    def fitted(start):
        speeds = measured.settings["speed"]
        best, covariance = curve_fit(curve, speeds, np.log(values), start)
        wide = student.ppf(0.975, len(values) - len(start)) * np.sqrt(covariance.diagonal())
        return best[:2], wide[:2], covariance

    expected, alone, covariance = fitted((1000.0, 4.0))
    moved, beside, _ = fitted((*expected, 0.0, 0.0))
    intervals = np.maximum(alone, abs(moved - expected) + beside)
    assert (intervals < 2.0 * alone).all()
    assert found.values == pytest.approx(expected, rel=1e-4)
    assert found.uncertainty == pytest.approx(intervals, rel=0.01)
    correlation = covariance[0, 1] / math.sqrt(covariance[0, 0] * covariance[1, 1])
    assert found.correlation[0, 1] == pytest.approx(correlation, abs=0.01)
    assert abs(found.values - (STIFFNESS, DAMPING)) == pytest.approx(0.0, abs=1.5 * max(intervals))
    assert found.rms[0] > 5 * found.rms[1]
    assert found.guessed == pytest.approx(found.rms[1], rel=1e-3)
    assert not found.warnings()


def test_what_scales_everything_alike_is_not_told_apart(rotor, file):
    """Mass, stiffness, damping by one factor give the same amplitudes at that unbalance."""
    rotor = rotor.replace({"rotor.unbalance": UNBALANCE})
    lines = file.read_text().splitlines()
    cells = [line.split(",") for line in lines[2 : 2 + len(SPEEDS)]]
    file.write_text("speed,amplitude [mm]\n" + "".join(f"{a},{c}\n" for a, _, c in cells))
    free = parse_free([*FREE, "rotor.unbalance,rotor.mass"], rotor)
    said = fit(rotor, read_measured(file, rotor), free).warnings()
    assert len(said) == 4
    assert all("times worse" in text and text[-6:-3] in ("+1.", "-1.") for text in said)


def test_what_the_amplitudes_do_not_show_is_said(rotor, file):
    rotor = rotor.replace({"rotor.unbalance_angle": 0.5})
    free = parse_free([*FREE, "rotor.unbalance_angle"], rotor)
    found = fit(rotor, read_measured(file, rotor), free)
    assert found.warnings() == [
        "rotor.unbalance_angle: the measured amplitudes do not depend on it"
    ]
    assert found.values[2] == pytest.approx(0.5)
    assert np.isfinite(found.uncertainty[:2]).all()


def test_drag_is_found_from_runs_that_have_not_settled(tmp_path):
    """Measured by the separate units under the harness, fitted on the composite."""
    scene = load_scene("two_balls").replace({"run.revolutions": 12})
    rows = []
    for speed in (2.5, 3.0, 4.0):
        changes = {"operation.speed": speed, "weights.drag": 0.02}
        run = cosimulate(scene.replace(changes), record=["rotor.x", "rotor.y"])
        late = run.time > run.time[-1] - math.tau / speed
        rows.append((speed / math.tau, np.hypot(run["rotor.x"], run["rotor.y"])[late].max()))
    path = tmp_path / "run.csv"
    path.write_text("speed [Hz],residual\n" + "".join(f"{w},{a}\n" for w, a in rows))
    start = scene.replace({"weights.drag": 0.025})
    found = fit(start, read_measured(path, start), parse_free(["weights.drag"], start))
    assert found.values == pytest.approx([0.02], rel=2e-3)
    assert math.isnan(found.guessed)  # balancers are not harmonic balance's


def test_friction_is_found_from_amplitudes_of_runs(tmp_path):
    start = load_scene("bristol_friction").replace({"run.revolutions": 50})
    speeds = [1300.0, 1400.0, 1450.0, 1600.0, 1660.0, 1720.0, 1900.0, 1960.0, 2100.0]
    rows = {"speed": np.array(speeds) * math.pi / 30.0}
    true = start.replace({f"rotor.friction[{n}].limit[1]": 0.3 for n in (1, 2)})
    stations = [f"rotor.station[{k}].residual" for k in (1, 3)]
    run = cosimulate_many(true, rows, results=stations)
    path = tmp_path / "friction.csv"
    lines = [
        f"{w},{(a + b) / 2}\n" for w, a, b in zip(speeds, *map(run.get, stations), strict=True)
    ]
    path.write_text("speed [rpm],amplitude\n" + "".join(lines))
    free = ["rotor.friction[1].limit[1]=rotor.friction[2].limit[1],rotor.support_damping[1][2]"]
    found = fit(start, read_measured(path, start), parse_free(free, start))
    assert found.values == pytest.approx([0.3, 9.791], rel=1e-3)
    assert found.guessed < 0.02  # what higher harmonics and points between samples are


def test_a_limit_that_was_asked_for_is_kept(rotor, file):
    measured = read_measured(file, rotor)
    found = fit(
        rotor, measured, parse_free(FREE, rotor, ["rotor.damping=:5,rotor.stiffness[2]=1:"])
    )
    assert found.values[1] == pytest.approx(5.0)
    assert any("rotor.damping: ended at its limit, 5" in text for text in found.warnings())


def test_limits_and_priors_may_have_units(rotor):
    free, plain = FREE, ("rotor.damping=2:3000", "rotor.damping=0.5")
    texts = ("rotor.damping=2 N s/m:3 N s/mm", "rotor.damping=0.5e-3 N s/mm")
    alone, named = (parse_free(free, rotor, [limit], [prior]) for limit, prior in (plain, texts))
    for one, other in zip(alone, named, strict=True):
        assert other.limits == pytest.approx(one.limits)
        assert other.pull == pytest.approx(one.pull)
    assert alone != parse_free(free, rotor)


@pytest.mark.parametrize(
    ("limit", "words"),
    [
        ("rotor.mass=1:2", "rotor.mass is not free"),
        ("rotor.damping=1", "must be PATH=LOW:HIGH"),
        ("rotor.damping=1:x", "must be PATH=LOW:HIGH"),
        ("rotor.damping=1 kg:5", "a damping or drag is expected"),
        ("rotor.damping=5:9", "starts at 4, outside"),
        ("rotor.damping=9:5", "LOW must be below HIGH"),
        ("rotor.damping=nan:", "LOW must be below HIGH"),
    ],
)
def test_a_limit_that_is_wrong_is_refused(rotor, limit, words):
    with pytest.raises(UserError, match=words):
        parse_free(FREE, rotor, [limit])


def test_a_fit_far_from_the_measurements_says_that_the_scene_is_another_machine(tmp_path):
    """A balanced rotor, beside amplitudes of the rotor alone."""
    scene = load_scene("two_balls").replace({"run.revolutions": 60})
    path = tmp_path / "alone.csv"
    path.write_text("speed,amplitude [m]\n2.8,0.031\n3.0,0.030\n3.2,0.029\n")
    found = scene.fit(path, "weights.drag")
    assert math.exp(found.rms[1]) > 3.0
    assert any("--without-balancers" in text for text in found.warnings())
    alone = scene.without_balancers().fit(path, "rotor.unbalance")
    assert not any("another machine" in text for text in alone.warnings())


def test_every_support_can_be_measured_on_its_own(tmp_path):
    scene = load_scene("two_plane_rodrigues").replace({"run.revolutions": 8})
    path = tmp_path / "stations.csv"
    names = [f"rotor.station[{k}].residual" for k in (1, 2)]
    path.write_text(f"speed,amplitude,{names[0]},{names[1]} [mm]\n4.0,,0.01,\n4.5,0.02,,30\n")
    measured = read_measured(path, scene)
    assert list(measured.amplitudes) == ["amplitude", *names]
    assert measured.values == pytest.approx([0.02, 0.01, 0.03])


@pytest.mark.parametrize(
    ("path", "limits"),
    [
        ("rotor.mass", (0.0, math.inf)),
        ("rotor.polar_inertia", (0.0, 6.5)),  # twice the inertia, of a disc
        ("rotor.unbalances[1].position", (-math.inf, math.inf)),
    ],
)
def test_limits_are_those_of_the_scene(path, limits):
    (parameter,) = parse_free([path], load_scene("two_plane_rodrigues"))
    assert parameter.limits == pytest.approx(limits, abs=1e-9)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("speed,amplitude [kg]\n3,1\n", r"amplitude \[kg\]: a length is expected"),
        ("sped,amplitude\n3,1\n", "sped: neither measured nor set; did you mean speed?"),
        ("rotor.mas,amplitude\n3,1\n", "rotor.mas: neither measured nor set"),
        (
            "rotor.mass [mm],amplitude\n3,1\n",
            r"rotor.mass \[mm\]: a mass is expected: name the column `rotor.mass \[g\]`",
        ),
        ("speed\n3\n", "nothing measured: a column must be one of: amplitude"),
        ("rpm,amplitude\n3,1\n", r"rpm: neither measured nor set; did you mean speed \[rpm\]?"),
        ("speed,speed [Hz],amplitude\n3,3,1\n", "speed: given twice"),
        ("speed,amplitude\n3,-1\n", "amplitude: must be above 0, or empty"),
        ("speed,amplitude\n,1\n", "speed: every row must have a number"),
        ("speed,amplitude\n3,\n", "no amplitude is given"),
        ("speed rpm,amplitude\n3,1\n", "speed rpm: .*a column is named NAME or NAME"),
    ],
)
def test_a_file_that_is_wrong_is_refused_with_what_is_wrong(rotor, tmp_path, text, words):
    path = tmp_path / "wrong.csv"
    path.write_text(text)
    with pytest.raises(UserError, match=words):
        read_measured(path, rotor)


@pytest.mark.parametrize(
    ("free", "words"),
    [
        (",", "nothing is free"),
        ("rotor.mass,rotor.mass", "given twice"),
        ("rotor.mas", "'rotor.mas': unknown"),
        ("run.revolutions", "cannot be varied"),
        ("rotor.unbalance_angle", "starts at 0"),
        ("rotor.kind", "must be a number"),
        ("rotor.mass=rotor.nothing", "'rotor.nothing': unknown"),
    ],
)
def test_what_cannot_be_free_is_refused(rotor, free, words):
    with pytest.raises(UserError, match=words):
        parse_free([free], rotor)


def test_a_run_up_and_too_few_values_are_refused(rotor, tmp_path):
    path = tmp_path / "few.csv"
    path.write_text("speed,amplitude\n9,1e-4\n")
    measured, free = read_measured(path, rotor), parse_free(["rotor.mass"], rotor)
    with pytest.raises(UserError, match="1 measured value for 1 free parameter:"):
        fit(rotor, measured, free)
    path.write_text("amplitude\n1e-4\n1e-4\n")
    rising = rotor.replace({"operation.run_up": {"from": 5.0, "to": 9.0, "seconds": 5.0}})
    with pytest.raises(UserError, match="operation: a fit requires runs at constant speed"):
        fit(rising, read_measured(path, rising), free)


@pytest.mark.parametrize("harmonic", [False, True])
def test_a_scene_that_does_not_vibrate_is_refused(rotor, tmp_path, harmonic):
    path = tmp_path / "few.csv"
    path.write_text("speed,amplitude [mm]\n10,1\n20,2\n30,1\n")
    still = rotor.replace({"rotor.unbalance": 0.0})
    measured, parameters = read_measured(path, still), parse_free(["rotor.stiffness[1]"], still)
    with pytest.raises(UserError, match="does not vibrate where vibration was measured"):
        fit(still, measured, parameters, harmonic=harmonic)


def test_the_command_says_draws_and_predicts(invoke, file, tmp_path):
    picture, document, others = (tmp_path / name for name in ("fit.png", "fit.json", "more.csv"))
    others.write_text(f"speed [rpm],amplitude [mm]\n210,{1e3 * amplitude(22.0, 800.0, 6.0)}\n")
    settings = [f"rotor.mass={MASS}", f"rotor.unbalance={UNBALANCE}", "rotor.stiffness=1000"]
    settings += ["rotor.damping=4", "run.revolutions=50", "coupling.steps_per_rev=20"]
    sets = [word for text in settings for word in ("--set", text)]
    outcome = invoke(
        *("fit", "two_balls", "--without-balancers", "--measured", file, "--free", FREE[0]),
        *(*sets, "--predict", others, "-o", picture, "--json", document),
        *("--report", tmp_path / "report"),
    )
    assert outcome.exit_code == 0, outcome.output
    said = json.loads(document.read_text())
    assert said["parameters"][0]["value"] == pytest.approx(STIFFNESS, rel=0.01)
    assert said["rms"] == pytest.approx(0.03, rel=0.3)
    assert said["rms_predicted"] < 0.02
    assert "Warning" not in outcome.output
    assert f'--set "rotor.stiffness[2]={said["parameters"][0]["value"]:.6g}"' in outcome.output
    assert picture.stat().st_size > 10_000
    page = (tmp_path / "report" / "report.html").read_text()
    assert f"{said['parameters'][0]['value']:.6g}" in page
    assert "data:image/png" in page
    alone = invoke(
        *("fit", "two_balls", "--without-balancers", "--measured", file, "--free", FREE[0], *sets)
    )
    assert alone.exit_code == 0, alone.output
    assert "Predicted" in outcome.output
    assert "Predicted" not in alone.output
    wrong = invoke("fit", "two_balls", "--measured", file, "--free", "rotor.mas")
    assert wrong.exit_code == 2
    assert "rotor.mas" in wrong.stderr


def test_a_prior_counts_as_one_more_measurement(rotor, file):
    """Against SciPy on the closed form, with a row of the prior."""
    measured, scatter, deviation = read_measured(file, rotor), 0.03, 2.0
    priors = [f"rotor.stiffness[1]={deviation}"]
    free = parse_free(FREE, rotor, priors=priors, scatter=scatter)
    found = fit(rotor, measured, free, harmonic=True)

    def rows(values):
        simulated = amplitude(
            measured.settings["speed"], *values, measured.settings["rotor.unbalance"]
        )
        own = np.log(simulated / measured.values)
        return np.append(own, scatter * (values[0] - 1000.0) / deviation)

    expected = least_squares(rows, (1000.0, 4.0), x_scale=(1000.0, 4.0), xtol=1e-12)
    assert 810.0 < expected.x[0] < 990.0  # between what was measured and what was known before
    assert found.values == pytest.approx(expected.x, rel=1e-3)
    assert found.rms[1] == pytest.approx(np.sqrt(np.mean(expected.fun[:-1] ** 2)), rel=1e-3)


def test_of_several_starts_the_best_is_taken(tmp_path):
    """An unbalance beside another, whose angle has two minima; amplitudes by harmonic balance."""
    changes = {"run.revolutions": 150, "coupling.steps_per_rev": 20}
    true = load_scene("bristol").without_balancers().replace(changes)
    true = true.replace({f"rotor.unbalances[{n}].amount": a for n, a in ((2, 1.5e-5), (3, 0.0))})
    true = true.replace({"rotor.unbalances[2].angle": 2.0})
    speeds = np.array([1300.0, 1600, 1800, 2000, 2200, 2600, 3500, 4500]) * math.pi / 30.0
    motion = unbalance_response(true.assembly().rotor, speeds)
    path = tmp_path / "two.csv"
    rows = zip(speeds, largest_displacement(motion).mean(axis=1), strict=True)
    path.write_text("speed,amplitude [m]\n" + "".join(f"{w},{a}\n" for w, a in rows))
    start = {"rotor.unbalances[2].angle": -2.0, "rotor.unbalances[2].amount": 1e-5}
    scene, measured = true.replace(start), read_measured(path, true)
    free = parse_free([",".join(start)], scene)
    one, four = (fit(scene, measured, free, harmonic=True, starts=n) for n in (1, 4))
    assert one.guessed > 0.04
    assert four.guessed < 1e-6
    assert (one.starts, four.starts) == (1, 4)
    angle, amount = four.values
    assert amount == pytest.approx(1.5e-5, rel=0.01)
    assert math.remainder(angle - 2.0, math.tau) == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize(
    ("priors", "words"),
    [
        ("rotor.mass=1", "rotor.mass is not free"),
        ("rotor.damping=0", "a number above 0"),
        ("rotor.damping=x", "must be PATH=DEVIATION"),
    ],
)
def test_a_prior_that_is_wrong_is_refused(rotor, priors, words):
    with pytest.raises(UserError, match=words):
        parse_free(FREE, rotor, priors=[priors])


def test_harmonic_balance_that_has_no_answer_is_refused_where_it_is_asked_for(tmp_path):
    scene, path = load_scene("two_balls"), tmp_path / "run.csv"
    path.write_text("speed [Hz],residual\n0.4,0.1\n0.5,0.1\n")
    measured, free = read_measured(path, scene), parse_free(["weights.drag"], scene)
    for how in ({"harmonic": True}, {"starts": 2}):
        with pytest.raises(UserError, match=r"two_balls: no fit by harmonic balance: .*balancers"):
            fit(scene, measured, free, **how)


def test_the_picture_tells_measurements_at_different_settings_apart(rotor, file):
    measured = read_measured(file, rotor)
    upper, lower = fit(rotor, measured, parse_free(FREE, rotor)).plot().figure.axes
    legend = [text.get_text() for text in upper.get_legend().get_texts()]
    assert legend == [
        "amplitude, measured, rotor.unbalance 0.01 kg m",
        "amplitude, measured, rotor.unbalance 0.02 kg m",
        "fitted",
    ]
    marked = [line for line in upper.lines if len(line.get_xdata())]
    colours = [line.get_color() for line in marked]
    assert len(marked) == 4
    assert colours[0] == colours[1] != colours[2] == colours[3]
    for line, unbalance in zip(marked[::2], (0.01, 0.02), strict=True):
        at = measured.settings["rotor.unbalance"] == unbalance
        np.testing.assert_array_equal(line.get_xdata(), measured.settings["speed"][at])
        np.testing.assert_allclose(line.get_ydata(), 1e3 * measured.amplitudes["amplitude"][at])
    assert [line.get_color() for line in lower.lines[:2]] == colours[::2]
