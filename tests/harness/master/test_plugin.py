"""The pytest fixture `cosim`, as somebody else's tests use it."""

import pytest

from autobalancer.harness import load_scene

pytest_plugins = ["pytester"]


@pytest.fixture
def with_scene(pytester: pytest.Pytester) -> pytest.Pytester:
    text = load_scene("two_balls").path.read_text(encoding="utf-8")
    (pytester.path / "mine.toml").write_text(text, encoding="utf-8")
    return pytester


def test_scene_beside_the_test_is_found_from_any_directory(with_scene, tmp_path, monkeypatch):
    path = with_scene.makepyfile(
        """
        import math

        def test_balls_balance(cosim):
            result = cosim("mine.toml")
            result.assert_balanced(below=1e-4)
            angles = [result[f"weights.weight[{k}].angle"][-1] for k in (1, 2)]
            assert abs(abs(angles[0]) - 2 * math.pi / 3) < 2e-3

        def test_override_reaches_the_units(cosim):
            # twice what two weights can hold: they stand side by side, opposite, and half is left
            result = cosim("mine.toml", **{"rotor.unbalance": 0.1, "run.revolutions": 80})
            assert abs(result["weights.moment_xi"][-1] + 2 * 0.025 * 1.0) < 5e-3
            assert abs(result["rotor.x"]).max() > 0.1

        def test_record_can_be_chosen(cosim):
            result = cosim("mine.toml", record=["rotor.vx"], speed=4.0, **{"run.revolutions": 1})
            assert list(result.signals) == ["rotor.vx"]
            assert result.scene.operation.speed == 4.0
        """
    )
    monkeypatch.chdir(tmp_path)
    with_scene.runpytest_inprocess(path).assert_outcomes(passed=3)


def test_failing_assertion_says_what_was_wrong(with_scene):
    with_scene.makepyfile(
        """
        def test_too_strict(cosim):
            cosim("two_balls", **{"run.revolutions": 2}).assert_balanced(below=1e-9)

        def test_mistake(cosim):
            cosim("mine.toml", **{"rotor.mas": 1.0})
        """
    )
    outcome = with_scene.runpytest_inprocess()
    outcome.assert_outcomes(failed=2)
    outcome.stdout.fnmatch_lines_random(
        [
            "*not balanced: rotor still moves * m (0-peak) at t = * s, expected at most 1e-09 m *",
            "*over the last 10 % of *",
            "*'rotor.mas': unknown (did you mean \"mass\"?)*",
        ]
    )
    # no line of the library stands between the test and the message
    outcome.stdout.no_fnmatch_line("*scene.py:*")
    outcome.stdout.no_fnmatch_line("*pytest_plugin.py:*")
