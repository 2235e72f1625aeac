"""Distributions as they are written: what they mean, and what is refused with what is allowed."""

import math

import numpy as np
import pytest
from scipy import stats

from autobalancer.harness import UserError, load_scene
from autobalancer.harness.scatter.vary import Variation, drawn, frozen, refuse_wrong


@pytest.mark.parametrize(
    ("text", "cumulative"),
    [
        ("normal(0.2,0.02)", lambda x: 0.5 * (1 + math.erf((x - 0.2) / 0.02 / math.sqrt(2)))),
        ("normal(deviation=0.02, mean=0.2)", stats.norm(0.2, 0.02).cdf),
        ("uniform(0.15,0.25)", lambda x: (x - 0.15) / 0.1),
        ("lognormal(0.2,0.1)", stats.norm(math.log(0.2), 0.1).cdf),
    ],
)
def test_a_distribution_is_what_its_words_say(text, cumulative):
    found = Variation.parse(f"weights.drag={text}")
    assert found.path == "weights.drag"
    for x in (0.16, 0.18, 0.199):
        value = math.log(x) if text.startswith("lognormal") else x
        assert found.distribution.cdf(x) == pytest.approx(cumulative(value), rel=1e-9)


def test_a_normal_distribution_can_be_cut_off():
    one = Variation.parse("rotor.mass=normal(1,0.1,low=0.9,high=1.05)")
    values = drawn([one], 4000, 1)[:, 0]
    assert 0.9 <= values.min() < 0.901
    assert 1.049 < values.max() <= 1.05


@pytest.mark.parametrize(
    ("text", "mean", "deviation"),
    [
        ("rotor.mass=normal(950 g, 10%)", 0.95, 0.095),
        ("rotor.mass=normal(950g,deviation=5 g)", 0.95, 0.005),
        ("run.initial.x=normal(-2mm,10%)", -2e-3, 2e-4),
    ],
)
def test_numbers_take_units_and_percentages_of_the_mean(text, mean, deviation):
    one = Variation.parse(text, load_scene("two_balls")).distribution
    assert one.mean() == pytest.approx(mean)
    assert one.std() == pytest.approx(deviation)


def test_lognormal_takes_its_deviation_in_percent():
    one = Variation.parse("weights.drag=lognormal(0.2 N s/m, 10%)", load_scene("two_balls"))
    assert np.log([one.distribution.ppf(0.5)]) == pytest.approx(np.log([0.2]))
    assert one.distribution.kwds["scale"] == pytest.approx(0.2)
    assert one.distribution.args == pytest.approx((0.1,))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("weights.drag", "must be PATH=NAME"),
        ("weights.drag=0.2", "must be PATH=NAME"),
        ("weights.drag=norml(1,2)", "'norml': must be one of normal, uniform, lognormal"),
        ("weights.drag=normal(1)", "missing .* 'deviation'; allowed: mean, deviation, low, high"),
        ("weights.drag=normal(1,x)", "deviation = x: a ratio is expected"),
        ("weights.drag=normal(1,nan)", "must be finite"),
        ("weights.drag=normal(1,2,3,4,5)", "too many .*; allowed: mean"),
        ("weights.drag=normal(1,2,sigma=2)", "unexpected .* 'sigma'; allowed: mean"),
        ("weights.drag=normal(1,mean=2)", "multiple values .* 'mean'"),
        ("weights.drag=uniform(low=1,low=2)", "low: given twice"),
        ("weights.drag=normal(1,-2)", "deviation = -2: must be above 0"),
        ("weights.drag=normal(1,2,4,3)", "low = 4: must be below high = 3"),
        ("weights.drag=uniform(2,1)", "low = 2: must be below high = 1"),
        ("weights.drag=lognormal(-1,1)", "must be above 0"),
    ],
)
def test_a_wrong_variation_is_refused_with_what_is_allowed(text, said):
    with pytest.raises(UserError, match=said):
        Variation.parse(text)


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("wights.drag", "cannot be varied; must be speed or begin with one of: rotor., weights."),
        ("weights.drg", r"unknown \(did you mean \"drag\"\?\); weights has: kind, name, .*, drag,"),
        ("rotor.stifness[x]", r"unknown \(did you mean \"stiffness\"\?\); rotor has: kind,"),
    ],
)
def test_an_unknown_path_is_named_before_the_units_of_its_numbers(path, said):
    with pytest.raises(UserError, match=said):
        Variation.parse(f"{path}=normal(0.2 N s/m,10%)", load_scene("two_balls"))


@pytest.mark.parametrize(
    ("texts", "said"),
    [
        ([], "nothing varies"),
        (["weights.drag=uniform(1,2)"] * 2, "given 2 times"),
        (["coupling.tolerance=uniform(1,2)"], "cannot be varied; must be speed or begin with"),
        (["run.revolutions=uniform(1,2)"], "cannot be varied"),
        (["weights.drg=uniform(1,2)"], 'did you mean "drag"'),
        (["weights.drag=uniform(-2,-1)"], "must be 0 or more"),
        (["weights.count=uniform(1,3)"], "count"),
    ],
)
def test_what_cannot_vary_is_refused_before_the_work(texts, said):
    with pytest.raises(UserError, match=said):
        refuse_wrong(load_scene("two_balls"), [Variation.parse(text) for text in texts])


def test_a_value_is_drawn_alike_whatever_else_varies_after_it():
    drag, mass = (Variation.parse(t) for t in ("a.drag=normal(1,1)", "b.mass=uniform(0,1)"))
    together = drawn([drag, mass], 50, 7)
    np.testing.assert_array_equal(together[:, :1], drawn([drag], 50, 7))
    assert abs(np.corrcoef(together.T)[0, 1]) < 0.5
    assert (drawn([drag], 50, 8) != together[:, :1]).all()


@pytest.mark.parametrize("count", [10**14, 10**19])
def test_more_machines_than_memory_are_refused_with_their_number(count):
    with pytest.raises(UserError, match=f"n = {count}: must be a whole number from 1 to 100000000"):
        drawn([frozen("rotor.unbalance", stats.norm(1.0, 0.1))], count, 1)
