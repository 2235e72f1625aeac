"""The picture of a run with and without its balancers."""

import numpy as np
import pytest

from autobalancer import load
from autobalancer.harness.errors import UserError


def test_the_lines_are_the_runs_with_and_without_balancers():
    scene = load("two_balls").replace({"run.revolutions": 60})
    picture = scene.run().plot_compared()
    bare, own = picture.panels[0].lines
    assert (bare.label, own.label) == ("without balancers", "with balancers")
    alone = scene.without_balancers().run()
    largest = np.hypot(alone["rotor.x"], alone["rotor.y"]).max()
    factor = bare.points[1].max() / largest
    assert factor in [pytest.approx(unit, rel=1e-2) for unit in (1.0, 1e3, 1e6)]  # other rows
    assert own.points[1][-1] < 0.1 * bare.points[1][-1]


def test_a_scene_without_balancers_has_nothing_to_compare():
    bare = load("two_balls").without_balancers().replace({"run.revolutions": 2})
    with pytest.raises(UserError, match="no balancer to leave out"):
        bare.run().plot_compared()


def test_the_command_draws_it(invoke, tmp_path):
    outcome = invoke("run", "two_balls", "--compare", tmp_path / "both.png")
    assert outcome.exit_code == 0, outcome.output
    assert (tmp_path / "both.png").stat().st_size > 10_000
