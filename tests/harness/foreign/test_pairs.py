"""The stated error of coupled oscillators is the true one; hundreds: `tests.studies.pairs`."""

import pytest

from tests.studies.pairs import WITHIN, built, drawn, judged


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    return built(tmp_path_factory.mktemp("pairs"))


@pytest.mark.parametrize("pair", drawn(3, seed=2), ids=lambda pair: f"gain {pair.gain:.2g}")
def test_stated_and_true_error_of_random_pairs_agree(pair, files):
    stated, true = judged(pair, *files)
    assert true <= pair.tolerance
    assert true / WITHIN <= stated <= WITHIN * true
