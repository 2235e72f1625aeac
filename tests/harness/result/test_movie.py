"""Movies show the run's motion, say how much it is magnified, and appear whole or not at all."""

from __future__ import annotations

import math
import shutil
import subprocess

import numpy as np
import pytest
from PIL import Image, ImageSequence

from autobalancer.harness import UserError, cosimulate, load_scene
from autobalancer.harness.result.motion import Motion
from autobalancer.harness.result.movie import FRAMES_PER_SECOND, REACH, views
from autobalancer.harness.result.movie_stops import stop_views

pytestmark = pytest.mark.slow

RADIUS = 0.1  # m, the run-up's track


@pytest.fixture(scope="module")
def result():
    names = ["rotor.x", "rotor.y", "weights.weight[1].angle", "weights.weight[2].angle"]
    return cosimulate(load_scene("run_up"), record=names)


def test_weights_are_seen_on_the_track_about_the_displaced_centre(result):
    """At the end either side of the light side by arccos(U/(2 m R))."""
    motion = Motion(result.scene, result.time, result)
    factor, (view,) = views(motion, result.time)
    z = (result["rotor.x"] + 1j * result["rotor.y"]) * np.exp(-1j * motion.angle)
    np.testing.assert_allclose(view.trail[:, -1], factor * z, atol=1e-12)
    np.testing.assert_allclose(np.abs(view.weights - view.trail[:, -1]), RADIUS, rtol=1e-12)
    ends = np.angle(view.weights[:, -1] * np.exp(-1j * np.pi))
    assert sorted(ends) == pytest.approx([-math.acos(0.625), math.acos(0.625)], abs=1e-3)


def test_magnification_is_a_round_number_that_fills_the_track(result):
    motion = Motion(result.scene, result.time, result)
    factor, _ = views(motion, result.time)
    largest = np.hypot(result["rotor.x"], result["rotor.y"]).max()
    assert REACH * RADIUS / 2.5 < factor * largest <= REACH * RADIUS
    assert factor == 5.0


def test_weights_have_their_own_radii_and_the_unbalance_its_present_direction():
    radii = [0.015, 0.012, 0.015, 0.015, 0.015, 0.015]
    change = {"time": 0.1, "amount": 0.1, "angle": 1.0}
    own = {"speed": "1000 rpm", "run.revolutions": 3, "operation.unbalance_changes": [change]}
    scene = load_scene("washing_machine").replace({**own, "balls.weight_radius": radii})
    run = cosimulate(scene)
    _, (view,) = views(Motion(scene, run.time, run), run.time)
    assert view.radii.tolist() == radii
    turned = np.where(run.time < 0.1, 0.0, 1.0)
    np.testing.assert_allclose(np.exp(1j * view.heavy), np.exp(1j * turned), atol=1e-12)


def test_lobes_are_drawn_larger_than_they_are_with_the_weights_on_them():
    scene = load_scene("run_up").replace({"weights.race": [{"lobes": 2, "amplitude": 1e-6}]})
    run = cosimulate(scene.replace({"run.revolutions": 3}))
    _, (view,) = views(Motion(scene, run.time, run), run.time)
    assert view.lobes == pytest.approx(0.08 * RADIUS / 1e-6)
    assert [np.abs(view.race).max(), np.abs(view.race).min()] == pytest.approx([0.108, 0.092])
    arms, angle = np.abs(view.weights[0] - view.trail[:, -1]), run["weights.weight[1].angle"]
    np.testing.assert_allclose(arms, 0.1 + 0.008 * np.cos(2.0 * angle), rtol=1e-6)


def test_trail_is_the_last_revolution(result):
    motion = Motion(result.scene, result.time, result)
    factor, (view,) = views(motion, result.time)
    past = np.interp(motion.angle[-1] - math.tau, motion.angle, result.time)
    before = complex(*(np.interp(past, result.time, result[f"rotor.{axis}"]) for axis in "xy"))
    seen = before * np.exp(-1j * motion.angle[-1])
    assert view.trail[-1, 0] == pytest.approx(factor * seen, abs=1e-9)


@pytest.mark.parametrize("kind", ["gif", "webp"])
def test_movie_has_the_length_asked_for(result, tmp_path, kind):
    done = []
    path = result.movie(tmp_path / f"a.{kind}", seconds=0.5, progress=done.append)
    with Image.open(path) as movie:
        assert movie.n_frames == 0.5 * FRAMES_PER_SECOND
        movie.load()  # only then Pillow knows the duration of a webp
        assert movie.info["duration"] == 1000 / FRAMES_PER_SECOND
    assert done[-1] == 1.0
    assert done == sorted(done)


@pytest.mark.skipif(not shutil.which("ffmpeg"), reason="no ffmpeg: there are no mp4")
def test_mp4_shows_the_frames_of_the_gif(result, tmp_path):
    seconds, shape = 0.5, (320, 624, 3)
    result.movie(tmp_path / "a.gif", seconds=seconds)
    result.movie(tmp_path / "a.mp4", seconds=seconds)
    raw = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    command = ["ffmpeg", "-v", "error", "-i", tmp_path / "a.mp4", *raw]
    decoded = subprocess.run(command, capture_output=True, check=True)
    frames = np.frombuffer(decoded.stdout, np.uint8).reshape(-1, *shape).astype(float)
    with Image.open(tmp_path / "a.gif") as movie:
        stills = [
            np.asarray(still.convert("RGB"), float) for still in ImageSequence.Iterator(movie)
        ]
    assert len(frames) == len(stills) == seconds * FRAMES_PER_SECOND
    apart = [[np.abs(frame - still).mean() for still in stills] for frame in frames]
    assert np.argmin(apart, axis=1).tolist() == list(range(len(frames)))
    assert np.diagonal(apart).max() < 3.0  # of 255: both formats lose a little


def test_movie_that_is_interrupted_leaves_what_was_there(result, tmp_path):
    path = tmp_path / "a.gif"
    path.write_text("old", encoding="utf-8")

    def stop(done: float) -> None:
        if done > 0.3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        result.movie(path, seconds=0.5, progress=stop)
    assert [each.name for each in tmp_path.iterdir()] == ["a.gif"]
    assert path.read_text(encoding="utf-8") == "old"


def test_there_must_be_something_to_see(tmp_path):
    scene = load_scene("two_balls").without_balancers()
    with pytest.raises(UserError, match="has no balancer to show"):
        cosimulate(scene).movie(tmp_path / "a.gif")


@pytest.mark.parametrize(
    ("place", "message"),
    [
        ("a.mp4", "an mp4 needs ffmpeg, and there is none: take .gif or .webp"),
        ("a.avi", "movies end in .gif, .webp, .mp4"),
        ("no/a.gif", "there is no directory"),
    ],
)
def test_what_cannot_be_made_is_refused_before_the_run(
    invoke, tmp_path, monkeypatch, place, message
):
    monkeypatch.setattr("autobalancer.harness.result.movie.FFMpegWriter.isAvailable", lambda: False)
    monkeypatch.setattr("autobalancer.harness.result.run.cosimulate", None)
    done = invoke("run", "two_balls", "--movie", tmp_path / place)
    assert done.exit_code == 2, done.output
    assert message in done.output


def test_a_movie_without_length_is_refused_before_the_run(invoke, tmp_path, monkeypatch):
    monkeypatch.setattr("autobalancer.harness.result.run.cosimulate", None)
    done = invoke("run", "two_balls", "--movie", tmp_path / "a.gif", "--movie-seconds", "0")
    assert done.exit_code == 2, done.output
    assert "length of the movie = 0 s: must be 0.5 to 600 s" in done.output


def test_command_makes_a_movie_of_liquid(invoke, tmp_path):
    done = invoke(
        *("run", "liquid_disc", "--movie", tmp_path / "a.gif", "--movie-seconds", 0.5),
    )
    assert done.exit_code == 0, done.output
    with Image.open(tmp_path / "a.gif") as movie:
        assert movie.n_frames >= 2


def test_a_stop_is_seen_from_fixed_axes_with_what_touches_it():
    scene = load_scene("washing_machine_stops")
    slow = {"operation.run_up": {"from": 0, "to": 83.7758, "seconds": 8.0}, "run.duration": 5.0}
    scene = scene.replace(slow)
    forces = [f"rotor.stop[1].force_{axis}" for axis in "xy"]
    places = [f"rotor.station[{k}].{axis}" for k in (1, 2) for axis in "xy"]
    run = cosimulate(scene, record=[*places, *forces, "rotor.stop[1].touches"])
    motion = Motion(scene, run.time, run)
    (view,) = stop_views(motion, run.time)
    tub = run["rotor.station[2].x"] + 1j * run["rotor.station[2].y"]
    np.testing.assert_allclose(view.trail[:, -1], tub, atol=1e-12)
    pushed = np.hypot(run["rotor.stop[1].force_x"], run["rotor.stop[1].force_y"]) > 0.0
    assert 0.1 < pushed.mean() < 0.9
    # the stop lets go before the gap is open again
    assert (view.touched != pushed).mean() < 0.02
    # a touch can be shorter than the time between two records
    began = (np.diff(view.touched.astype(int)) == 1).sum()
    assert began == pytest.approx(run["rotor.stop[1].touches"][-1], abs=1.0)
