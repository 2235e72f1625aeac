"""Numbers as people write them."""

from __future__ import annotations

import pytest

from autobalancer.models.readable import readable_apart, rounded, written_apart


@pytest.mark.parametrize(
    ("one", "other", "texts"),
    [
        (2.1e-2, 2.0e-2, ("21 g m", "20 g m")),
        (1.000001, 1.0, ("1.000001 kg m", "1 kg m")),
        (3e-5, 2e-5, ("30 g mm", "20 g mm")),
        (3e-13, 2e-13, ("3e-07 g mm", "2e-07 g mm")),
        (4e-19, 4e-3, ("0 g m", "4 g m")),
    ],
)
def test_two_unbalances_differ_as_texts(one, other, texts):
    assert readable_apart(one, other) == texts


def test_neighbouring_doubles_are_told_apart():
    one, other = 0.1 + 0.2, 0.3
    assert written_apart(rounded, one, other, 4) == ("0.30000000000000004", "0.29999999999999999")
