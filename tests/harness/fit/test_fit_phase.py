"""Vibration with a phase, run-out, and residuals that are not scatter: against a closed form."""

from __future__ import annotations

import numpy as np
import pytest

from autobalancer.harness import UserError, cosimulate
from autobalancer.harness.fit.measured import read_measured
from autobalancer.harness.fit.parameters import parse_free
from autobalancer.harness.fit.study import fit
from autobalancer.harness.fit.systematic import significance
from autobalancer.models.harmonic_balance import unbalance_response
from tests.studies.fit_intervals import (
    DAMPING,
    FREE,
    MASS,
    STIFFNESS,
    UNBALANCE,
    coverage,
    response,
    rotor,
)

SPEEDS = np.linspace(8.0, 45.0, 24)
RUNOUT = 0.002 * np.exp(1j * np.radians(50.0))


def written(path, values, heads="rotor.x.amplitude [um pp],rotor.x.phase_lag [deg]", more=""):
    """A file of complex amplitudes [m]."""
    lines = [f"speed [rad/s],{heads}"]
    for w, a in zip(SPEEDS, values, strict=True):
        lines.append(f"{w},{2e6 * abs(a)},{-np.degrees(np.angle(a))}{more}")
    path.write_text("\n".join(lines))
    return path


@pytest.fixture
def seen():
    """Complex amplitudes that scatter by 1 % and 0.01 rad."""
    random = np.random.default_rng(3)
    parts = 0.01 * random.standard_normal((2, len(SPEEDS)))
    return response(SPEEDS) * np.exp(parts[0] + 1j * parts[1])


def test_amplitude_and_phase_give_stiffness_damping_and_direction_of_the_unbalance(tmp_path, seen):
    """The phase alone tells where the unbalance is; the reference mark may be anywhere."""
    scene = rotor().replace({"rotor.unbalance_angle": 0.4})
    path = written(tmp_path / "run.csv", seen * np.exp(0.7j))
    free = parse_free([*FREE, "rotor.unbalance_angle"], scene)
    found = fit(scene, read_measured(path, scene), free)
    truth = np.array([STIFFNESS, DAMPING, 0.7])
    assert np.isfinite(found.uncertainty).all()
    assert (np.abs(found.values - truth) < 2.0 * found.uncertainty).all()
    assert (found.uncertainty < (2.5, 0.1, 0.02)).all()  # a run-out included
    assert found.rms[1] == pytest.approx(0.01, rel=0.3)
    assert not found.warnings()


def test_in_phase_and_quadrature_are_the_same_measurement(tmp_path, seen):
    scene = rotor()
    one = read_measured(written(tmp_path / "a.csv", seen), scene)
    heads = "rotor.x.in_phase [mm rms],rotor.x.quadrature_lag [mm rms]"
    lines = [f"speed,{heads}"]
    lines += [
        f"{w},{1e3 * a.real / np.sqrt(2.0)},{-1e3 * a.imag / np.sqrt(2.0)}"
        for w, a in zip(SPEEDS, seen, strict=True)
    ]
    (tmp_path / "b.csv").write_text("\n".join(lines))
    other = read_measured(tmp_path / "b.csv", scene)
    np.testing.assert_allclose(other.logarithms, one.logarithms, atol=1e-9)


def test_a_runout_is_subtracted_as_a_vector(tmp_path, seen):
    heads = "rotor.x.amplitude [um pp],rotor.x.phase_lag [deg],"
    heads += "rotor.x.slow_roll [um pp],rotor.x.slow_roll_phase_lead [deg]"
    path = written(tmp_path / "run.csv", seen + RUNOUT, heads, f",{2e6 * abs(RUNOUT)},50")
    scene = rotor()
    measured = read_measured(path, scene)
    np.testing.assert_allclose(measured.vibrations["rotor.x"], seen, rtol=1e-9)
    found = fit(scene, measured, parse_free(FREE, scene), harmonic=True)
    assert (np.abs(found.values - (STIFFNESS, DAMPING)) < 2.0 * found.uncertainty).all()
    assert not found.warnings()


def test_a_runout_that_was_not_subtracted_is_warned_of_and_no_interval_is_given(tmp_path, seen):
    scene, path = rotor(), tmp_path / "run.csv"
    rows = zip(SPEEDS, np.abs(seen + RUNOUT), strict=True)
    path.write_text("speed,amplitude [m]\n" + "".join(f"{w},{a}\n" for w, a in rows))
    found = fit(scene, read_measured(path, scene), parse_free(FREE, scene), harmonic=True)
    assert abs(found.values[0] - STIFFNESS) > 50.0  # it is off
    assert np.isnan(found.uncertainty).all()
    (text,) = found.warnings()
    assert text.startswith("residuals of neighbours deviate alike")
    assert "A constant run-out (0.00" in text
    assert found.runout.sizes["amplitude"] == pytest.approx(abs(RUNOUT), rel=0.2)
    assert found.values[0] + found.runout.shift[0] * 900.0 == pytest.approx(STIFFNESS, abs=10.0)


def test_an_interval_is_widened_with_a_warning_where_scatter_hides_a_runout_from_the_other_test(
    tmp_path,
):
    """2 % of the amplitude under a scatter of 3 %, at 12 speeds."""
    scene, speeds, widened = rotor(), SPEEDS[::2], 0
    random = np.random.default_rng(4)
    for k in range(12):
        vector = 0.02 * UNBALANCE / MASS * np.exp(2j * np.pi * random.uniform())
        seen = np.abs(response(speeds) + vector) * np.exp(0.03 * random.standard_normal(12))
        path = tmp_path / f"{k}.csv"
        rows = "".join(f"{w},{a}\n" for w, a in zip(speeds, seen, strict=True))
        path.write_text(f"speed,amplitude [m]\n{rows}")
        found = fit(scene, read_measured(path, scene), parse_free(FREE, scene), harmonic=True)
        off = np.abs(found.values - (STIFFNESS, DAMPING))
        assert found.warnings() or (off <= found.uncertainty).all()
        if found.runout.is_likely and not found.is_systematic:
            widened += 1
            assert (off <= found.uncertainty).all()
            assert found.warnings()[0].startswith("A constant run-out")
    assert widened >= 3


def test_a_value_that_a_runout_moves_without_a_trace_is_named(tmp_path):
    """At one speed a run-out is an unbalance."""
    scene, path = rotor(), tmp_path / "run.csv"
    scatter = np.exp(0.01 * np.random.default_rng(2).standard_normal(9))
    rows = "".join(f"30,{abs(response(30.0)) * s}\n" for s in scatter)
    path.write_text(f"speed,amplitude [m]\n{rows}")
    found = fit(scene, read_measured(path, scene), parse_free(["rotor.unbalance"], scene))
    (text,) = found.warnings()
    assert "a run-out of 10 % of the amplitude would move it by up to 0.0009 and not show" in text


@pytest.mark.parametrize("column", ["amplitude", "residual", "rotor.residual", "rotor.x.amplitude"])
def test_a_runout_is_found_in_every_column(tmp_path, column):
    """An elliptic orbit, by its major axis or one direction, with 0.3 % of scatter."""
    scene = rotor().replace({"rotor.stiffness": [900.0, 1100.0]})
    motion = unbalance_response(scene.assembly().rotor, SPEEDS)[:, :, 0]
    moved = motion + 0.2 * RUNOUT * np.array([1.0, -1j])
    x, y = moved.T
    major = 0.5 * (np.abs(x + 1j * y) + np.abs(x - 1j * y))
    seen = np.abs(x) if column == "rotor.x.amplitude" else major
    seen = seen * np.exp(0.003 * np.random.default_rng(8).standard_normal(len(SPEEDS)))
    path = tmp_path / "run.csv"
    rows = "".join(f"{w},{a}\n" for w, a in zip(SPEEDS, seen, strict=True))
    path.write_text(f"speed,{column} [m]\n{rows}")
    free = parse_free(["rotor.damping"], scene.replace({"rotor.damping": 5.5}))
    found = fit(scene, read_measured(path, scene), free, harmonic=True)
    (size,) = found.runout.sizes.values()
    assert size == pytest.approx(0.2 * abs(RUNOUT), rel=0.1)
    assert found.runout.chance < 1e-6


def test_intervals_cover_clean_data_and_exclude_few_truths_under_a_runout():
    """A small sample of `python -m tests.studies.fit_intervals`."""
    given, _, covers, _ = coverage(20, SPEEDS, 0.03, 0.0)
    assert given >= 0.7
    assert covers.min() >= 0.85
    _, _, _, missed = coverage(10, SPEEDS, 0.005, 0.1)
    assert missed.max() <= 0.1


@pytest.mark.parametrize(("lag", "share"), [(0.0, 0.1), (0.8, 0.97)])
def test_the_test_of_residuals_has_its_significance(lag, share):
    """Scatter without and with autocorrelation, of which a line was fitted; 200 draws."""
    random, n = np.random.default_rng(7), 30
    jacobian, found = np.column_stack([np.ones(n), np.arange(n)]), []
    for _ in range(200):
        e = random.standard_normal(n)
        for k in range(1, n):
            e[k] += lag * e[k - 1]
        e -= jacobian @ np.linalg.lstsq(jacobian, e, rcond=None)[0]
        found.append(significance(e, jacobian, [np.arange(n)]) < 0.1)
    assert np.mean(found) == pytest.approx(share, abs=0.07)


def test_the_turning_part_of_many_runs_is_that_of_a_run(tmp_path):
    """By a discrete Fourier transform of the last revolution of the signal."""
    from autobalancer.harness.result.many import cosimulate_many

    scene = rotor()
    names = ["rotor.x.in_phase", "rotor.x.quadrature_lead", "rotor.y.in_phase"]
    found = cosimulate_many(scene, {"speed": [12.0, 30.0]}, results=names)
    for k, speed in enumerate((12.0, 30.0)):
        run = cosimulate(scene.replace({"operation.speed": speed}), record=["rotor.x", "rotor.y"])
        last = slice(-21, -1)
        theta = speed * run.time[last]
        part = 2.0 * np.mean(run["rotor.x"][last] * np.exp(-1j * theta))
        other = 2.0 * np.mean(run["rotor.y"][last] * np.exp(-1j * theta))
        seen = [found[name][k] for name in names]
        assert seen == pytest.approx([part.real, part.imag, other.real], rel=1e-3, abs=1e-7)


@pytest.mark.parametrize(
    ("heads", "words"),
    [
        ("rotor.x.phase_lag [deg]", "there is no amplitude beside it"),
        ("rotor.x.amplitude [um],rotor.x.phase [deg]", "which way is it counted"),
        ("rotor.x.amplitude [um],rotor.x.phase_lag", "has no unit"),
        ("rotor.x.amplitude [kg]", "a length is expected"),
        ("rotor.x.amplitude [um],rotor.x.runout [um]", "subtracted as a vector: give its phase"),
        ("rotor.z.amplitude [um]", r"did you mean rotor\.[xy]\.amplitude"),
    ],
)
def test_vibration_that_is_not_whole_is_refused(tmp_path, heads, words):
    path = tmp_path / "wrong.csv"
    path.write_text(f"speed,{heads}\n3" + ",1" * (1 + heads.count(",")) + "\n")
    with pytest.raises(UserError, match=words):
        read_measured(path, rotor())
