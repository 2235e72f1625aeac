"""Numbers as people write them: digits that are enough, and units in which unbalances read well."""

from __future__ import annotations

from collections.abc import Callable

_UNBALANCES = ((1.0, "kg m"), (1e-3, "g m"), (1e-6, "g mm"))
_NOTHING = 1e-8  # of the larger of two unbalances: rounding of a sum that is 0
_MOST_DIGITS = 17  # that tell any two doubles apart


def rounded(value: float, digits: int = 4) -> str:
    """A value with so many digits, and without an exponent below a billion."""
    text = f"{value:.{digits}g}"
    return f"{float(text):.0f}" if 10**digits <= abs(float(text)) < 1e9 else text


def brief(value: float, digits: int = 2) -> str:
    """A number for people, in a unit that fits: what is as good as nothing is 0."""
    return "0" if abs(value) < 1e-5 else rounded(value, digits)


def written_apart(
    write: Callable[[float, int], str], one: float, other: float, fewest: int
) -> tuple[str, str]:
    """Two numbers with the fewest digits that tell them apart, `fewest` at least.

    Args:
        write: the text of a number with so many digits.
    """
    for digits in range(fewest, _MOST_DIGITS + 1):
        texts = write(one, digits), write(other, digits)
        if texts[0] != texts[1]:
            break
    return texts


def unbalance_unit(value: float) -> tuple[str, float]:
    """Unit in which an unbalance [kg m] reads well, and how many of it are one kg m."""
    size, unit = next(((s, u) for s, u in _UNBALANCES if value >= s), _UNBALANCES[-1])
    return unit, 1.0 / size


def readable_unbalance(value: float) -> str:
    """An unbalance [kg m] in the unit in which it reads well, such as '30 g m'."""
    unit, factor = unbalance_unit(value)
    return f"{brief(value * factor, 3)} {unit}"


def readable_apart(one: float, other: float) -> tuple[str, str]:
    """Two different unbalances [kg m] in one unit, with the digits that tell them apart."""
    unit, factor = unbalance_unit(max(one, other))
    nothing = _NOTHING * max(one, other)

    def write(value: float, digits: int) -> str:
        return f"{rounded(value * factor, digits) if value > nothing else 0} {unit}"

    return written_apart(write, one, other, 3)
