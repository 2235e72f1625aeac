"""The stated error of coupled oscillators is the true one; hundreds: `tests.studies.pairs`."""

import pytest

from tests.studies.pairs import WITHIN, built, drawn, judged


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folders = {state: tmp_path_factory.mktemp(f"pairs-{state}") for state in (True, False)}
    return {state: built(folder, state) for state, folder in folders.items()}


@pytest.mark.parametrize("state", [True, False], ids=["rolled back", "stateless"])
@pytest.mark.parametrize(
    "pair", drawn(3, seed=2, tolerances=(1e-2, 1e-3)), ids=lambda pair: f"gain {pair.gain:.2g}"
)
def test_stated_and_true_error_of_random_pairs_agree(pair, state, files):
    stated, true = judged(pair, *files[state])
    assert true <= pair.tolerance
    assert true / WITHIN <= stated <= WITHIN * true
