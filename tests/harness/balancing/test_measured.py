"""Corrections from measured runs: a published case, the virtual machine, and closed forms."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from autobalancer.harness import UserError, load_scene
from autobalancer.harness.balancing.correction import correct
from autobalancer.harness.balancing.machine import Machine
from autobalancer.harness.balancing.measured import read_measured
from autobalancer.harness.balancing.pieces import split
from autobalancer.harness.commands.balance import allowed_angles
from autobalancer.models.papers.influence import influence

# Feese & Grazier 2004, table 1: amplitude and phase of Fwd X, Fwd Y, Aft X, Aft Y
COMPRESSOR = {
    ("baseline", "", "", "", ""): [(0.68, 32), (0.56, 86), (1.94, 231), (2.07, 335)],
    ("aft", "", "", "11.1", "35"): [(1.31, 1), (1.25, 75), (0.93, 251), (1.00, 342)],
    ("both", "3.7", "135", "11.1", "35"): [(0.54, 9), (0.52, 75), (0.81, 196), (0.90, 296)],
}
HEAD = "run,mass_g[fwd],angle_deg[fwd],mass_g[aft],angle_deg[aft],sensor,amplitude_mil,"


def written(path, phase="phase_lead_deg", sign=1.0, sensors=4, runs=COMPRESSOR):
    lines = [HEAD + phase]
    for run, readings in runs.items():
        lines += [
            f"{','.join(run)},{number},{amplitude},{sign * angle}"
            for number, (amplitude, angle) in enumerate(readings[:sensors])
        ]
    path.write_text("\n".join(lines) + "\n")
    return path


def degrees(value):
    return math.degrees(math.atan2(value.imag, value.real)) % 360.0


def test_corrections_of_the_published_case_are_those_of_the_paper(tmp_path):
    """Feese & Grazier 2004: 15.3 g at 3 degrees aft, 6.6 g at 113 forward, and what remains."""
    found = correct(read_measured(written(tmp_path / "runs.csv")))
    forward, aft = found.exact.tolist()
    assert (round(abs(forward), 1), round(degrees(forward))) == (6.6, 113)
    assert (round(abs(aft), 1), round(degrees(aft))) == (15.3, 3)
    residuals = [(round(abs(a), 2), round(degrees(a))) for a in found.after.tolist()]
    assert residuals == [(0.08, 138), (0.09, 49), (0.05, 231), (0.05, 166)]
    assert round(found.rms, 2) == 0.07


def test_phases_that_lag_are_counted_the_other_way(tmp_path):
    lead = correct(read_measured(written(tmp_path / "lead.csv")))
    lag = correct(read_measured(written(tmp_path / "lag.csv", "phase_lag_deg", -1.0)))
    np.testing.assert_allclose(lag.exact, lead.exact, rtol=1e-12)


def test_measured_runs_of_the_virtual_machine_give_its_unbalance(tmp_path):
    """Trial runs read by hand from the co-simulated unit; the equations say what it carries."""
    scene = load_scene("balancing_machine")
    radius, lines = 80.0, ["run,sensor,amplitude_m,phase_lead_deg,speed_rpm"]
    lines[0] += "".join(f",mass_g[{p}],angle_deg[{p}],radius_mm[{p}]" for p in (1, 2))
    masses = {"first": (0.0, 20.0), "trial 1": (90.0, 0.0), "trial 2": (0.0, 70.0)}
    with Machine(scene) as machine:
        for run, mounted in masses.items():
            reading = machine.measure(1e-6 * radius * np.array(mounted, complex))
            for sensor, value in enumerate(reading.tolist()):
                cells = [run, sensor, abs(value), degrees(value), machine.speed * 30.0 / math.pi]
                cells += [cell for mass in mounted for cell in (mass or "", 0, radius)]
                lines.append(",".join(map(str, cells)))
        speed = machine.speed
    path = tmp_path / "runs.csv"
    path.write_text("\n".join(lines))
    rotor = scene.assembly().rotor
    k = influence(rotor, speed)[0]
    expected = -np.linalg.solve(k, influence(rotor, speed, np.eye(2))[0] @ rotor.unbalance)
    found = correct(read_measured(path), grade="G16", mass=scene.rotor.mass)
    expected = expected - 1e-6 * radius * np.array(masses["first"])  # what is mounted there stays
    np.testing.assert_allclose(1e-6 * radius * found.exact, expected, rtol=1e-9)
    assert np.isnan(found.uncertainty).all()  # two readings
    np.testing.assert_allclose(1e3 * found.coefficients / radius, k * 1e-3, rtol=1e-9)
    assert found.grade.permissible == pytest.approx(scene.rotor.mass * 16e-3 / speed)
    assert found.grade.before == pytest.approx(np.abs(expected).sum())
    assert found.grade.met


@pytest.mark.parametrize("text", ["12", "0,50,120,200,300", "12/0,170,340"])
def test_masses_at_allowed_angles_do_what_the_correction_does(tmp_path, text):
    measured = read_measured(written(tmp_path / "runs.csv"))
    exact = correct(measured)
    allowed = allowed_angles(text)
    found = correct(measured, angles=allowed)
    np.testing.assert_allclose(found.after, exact.after, atol=1e-12)
    for piece in found.pieces:
        assert piece.mass > 0.0
        own = allowed[-1 if piece.plane == "aft" else 0]
        assert piece.angle in own
    assert len(found.pieces) == 4


def test_allowed_angles_too_far_from_a_correction_are_refused(tmp_path):
    """Forward at 0 or 10 degrees alone, far from the 113 that are needed."""
    measured = read_measured(written(tmp_path / "runs.csv"))
    with pytest.raises(UserError, match=r"plane fwd: the correction at 11\d\.\d deg has no two"):
        correct(measured, angles=allowed_angles("0,10/12"))


def test_an_angle_that_is_hit_needs_one_mass():
    pieces = split(["a"], np.array([2.0 + 0.0j]), [[0.0, 2.0, 4.0]])
    assert [(p.mass, p.angle) for p in pieces] == [(2.0, 0.0)]


GOOD = "run,sensor,amplitude_um,phase_lead_deg,mass_g[1],angle_deg[1]\nr,a,1,0,,\nt,a,2,0,1,0\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (GOOD.replace("phase_lead_deg", "phase_deg"), "phase_lead_deg .* and phase_lag_deg"),
        (GOOD.replace("amplitude_um", "amplitude"), "one `amplitude_UNIT`"),
        (GOOD.replace("t,a,2,0,1,0\n", ""), "trial run is missing: .*plane 1 differ"),
        (GOOD.replace("t,a,2", "t,b,2"), "do not have the same readings: a, b"),
        (GOOD.replace("t,a,2", "t,a,x"), r"line 3: amplitude_um = 'x': must be a number"),
        (GOOD.replace("t,a,2", "t,a,-2"), r"line 3: amplitude = -2: must not be below 0"),
        (
            GOOD.replace("phase_lead_deg", "phase_lead_rad").replace("t,a,2,0", "t,a,2,75"),
            r"line 3: phase_lead_rad = 75: more than two turns; is it in degrees\? .*\[deg\]",
        ),
        (GOOD + "t,a,2,0,1,0\n", r"line 4: run 't': a is read twice"),
        (GOOD + "t,b,2,0,3,0\n", "do not agree on the mass in plane 1"),
        (
            GOOD.replace("mass_g[1],angle_deg[1]", "mass,angle"),
            r"mass = '1': has no unit: .*`mass \[g\]`",
        ),
        ("a,b\n1,2\n", "a: unknown column; allowed: run, sensor, speed, amplitude"),
        ("sensor,speed\n1,2\n", "needs a column `run`; has sensor, speed"),
    ],
)
def test_mistakes_in_the_file_are_named(tmp_path, text, message):
    path = tmp_path / "runs.csv"
    path.write_text(text)
    with pytest.raises(UserError, match=message):
        read_measured(path)


def test_what_readings_do_not_determine_is_refused_with_the_condition_number(tmp_path):
    both = {**COMPRESSOR, ("both", "3.7", "135", "11.1", "35"): [(1.31, 1), (1.25, 75)]}
    measured = read_measured(written(tmp_path / "alike.csv", sensors=1))
    with pytest.raises(UserError, match=r"readings in each run \(1\) .* planes \(2\)"):
        correct(measured)
    together = {k: v for k, v in both.items() if k[0] != "aft"}
    together = {k: v[:2] for k, v in together.items()}
    with pytest.raises(UserError, match="distinguish 1 of 2 planes"):
        correct(read_measured(written(tmp_path / "together.csv", runs=together)))
    good = read_measured(written(tmp_path / "good.csv"))
    with pytest.raises(UserError, match="needs the radius of every plane"):
        correct(good, grade="G2.5", mass=1.0, service_speed=100.0)


def test_a_trial_mass_without_effect_is_named_with_its_file_and_plane(tmp_path):
    path = tmp_path / "runs.csv"
    path.write_text(GOOD.replace("t,a,2", "t,a,1"))
    with pytest.raises(
        UserError, match=r"runs\.csv: the trial masses of plane 1 change no reading"
    ):
        correct(path)


@pytest.mark.parametrize("text", ["0", "1.5", "a", "10,x", ""])
def test_angles_that_cannot_be_are_refused(text):
    with pytest.raises(UserError, match="must be a number of even places"):
        allowed_angles(text)


def test_command_corrects_measured_runs_and_says_whether_the_grade_is_met(invoke, tmp_path):
    path, picture, data = written(tmp_path / "runs.csv"), tmp_path / "p.png", tmp_path / "d.json"
    text = path.read_text().replace("amplitude_mil", "radius_mm[fwd],radius_mm[aft],amplitude_mil")
    lines = text.splitlines()
    rows = [",".join([*r.split(",")[:6], "200", "200", *r.split(",")[6:]]) for r in lines[1:]]
    path.write_text("\n".join([lines[0], *rows]))
    arguments = ["balance", str(path), "--angles", "12", "--service-speed", "1832.6", "--grade"]
    done = invoke(*arguments, "G2.5", "--mass", "900", "-o", str(picture), "--json", str(data))
    assert done.exit_code == 0, done.output
    assert "condition number of the influence coefficients 1.91" in done.output
    assert picture.read_bytes().startswith(b"\x89PNG")
    found = json.loads(data.read_text())
    assert math.hypot(*found["exact"][0]) == pytest.approx(6.6, abs=0.05)
    assert [piece["plane"] for piece in found["pieces"]] == ["fwd", "fwd", "aft", "aft"]
    # 2.5 mm/s at 1832.6 rad/s, 900 kg; standard uncertainties of 0.29 g and 0.71 g at 200 mm
    assert found["grade"]["permissible"] == pytest.approx(900 * 2.5e-3 / 1832.6)
    assert found["grade"]["after"] == pytest.approx(0.2e-3 * (0.29 + 0.71), rel=0.01)
    assert invoke(*arguments, "G0.4", "--mass", "9").exit_code == 1
    wrong = invoke("balance", "balancing_machine", "--angles", "12")
    assert wrong.exit_code == 2
    assert "--angles: belong to measured runs" in wrong.stderr


def test_command_makes_the_largest_reading_least_and_keeps_masses_small(invoke, tmp_path):
    path = written(tmp_path / "runs.csv")
    plain, even = (invoke("balance", path, *more) for more in ([], ["--min-max"]))
    assert "largest 0.0907 mil" in plain.output
    assert "rms 0.082 mil, largest 0.082 mil" in even.output  # as far as two planes go
    small = invoke("balance", path, "--largest-mass", "6,10", "--json", tmp_path / "small.json")
    assert small.exit_code == 0, small.output
    exact = json.loads((tmp_path / "small.json").read_text())["exact"]
    assert math.hypot(*exact[0]) <= 6.0 + 1e-6
    assert math.hypot(*exact[1]) == pytest.approx(10.0)
    problems = {"6,10,3": "each of the 2", "6g": "must be grams", "": "must be grams"}
    for wrong, problem in problems.items() | {("-1", "grams above 0"), ("nan", "grams above 0")}:
        assert problem in invoke("balance", path, "--largest-mass", wrong).stderr


def test_a_grade_counts_what_a_largest_mass_leaves(tmp_path):
    path = written(tmp_path / "runs.csv")
    radii = replace(read_measured(path), radii=(200.0, 200.0))
    wanted = {"grade": "G2.5", "mass": 900.0, "service_speed": 1832.6}
    free, small = correct(radii, **wanted), correct(radii, largest=[1e-3], **wanted)
    assert small.grade.before == pytest.approx(free.grade.before)
    left = free.grade.before + free.grade.after  # as good as nothing is mounted
    assert small.grade.after == pytest.approx(left, rel=1e-3)
    assert not small.met


def test_the_column_of_the_sensor_can_be_left_out_where_there_is_one(tmp_path):
    lines = ["run,sensor,amplitude [um],phase_lead [deg],mass [g],angle [deg]",
             "as found,A,10,0,,", "trial,A,8,60,5,90"]  # fmt: skip
    named, short = tmp_path / "named.csv", tmp_path / "short.csv"
    named.write_text("\n".join(lines), encoding="utf-8")
    short.write_text("\n".join(each.replace(",sensor", "").replace(",A", "") for each in lines),
                     encoding="utf-8")  # fmt: skip
    both = [read_measured(path) for path in (named, short)]
    assert both[0].responses == pytest.approx(both[1].responses)
    twice = tmp_path / "twice.csv"
    twice.write_text(short.read_text("utf-8") + "\ntrial,9,70,5,90", encoding="utf-8")
    with pytest.raises(UserError, match="read twice; with several sensors add a column `sensor`"):
        read_measured(twice)
