"""Builder of composite FMUs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from html import escape
from pathlib import Path

from ..build import COMPOSITION, native_contents, written
from ..native.build.compile import stamp
from ..native.build.layout import identity_of
from ..xml.description import Capabilities
from .composition import Composition

_EXCHANGE = " As model exchange, the solver of the tool integrates it."


def build_composite(
    composition: Composition,
    destination: Path | str,
    *,
    name: str,
    fmi: int = 2,
    platforms: Iterable[str] | None = None,
    extra: Mapping[str, bytes] | None = None,
) -> Path:
    """Build the FMU of coupled units.

    Args:
        composition: the units and their coupling.
        destination: folder (made when missing), or a file that ends in .fmu.
        name: model name and file name.
        fmi: 2 or 3.
        platforms: default: all.
        extra: more files, by their names in the FMU.

    Returns:
        The file.

    Raises:
        ValueError: an argument is not one of those allowed; the text names it.
        NotCompiled: a native library is not of the present sources, and there is no compiler.
        OSError: the file cannot be written; nothing is left behind.
    """
    text = composition.token(stamp())
    files = native_contents(
        composition.described(name),
        name,
        identity_of(text),
        Capabilities(),
        fmi,
        platforms,
        _page(composition, name),
        tuple(dict.fromkeys(part.unit.unit for part in composition.parts)),
    )
    return written({**files, COMPOSITION: text.encode(), **(extra or {})}, destination, name)


def _page(made: Composition, name: str) -> str:
    """HTML: title, and five lines that run it."""
    unit = made.described(name)
    shown = [v for v in unit.shown if v.causality == "output" and v.quantity == "Displacement"]
    label = unit.label(shown[0].name)
    lines = (
        "from fmpy import plot_result, simulate_fmu",
        f'run = simulate_fmu("{name}.fmu", stop_time={made.stop:.6g}, output=["{label}"])',
        f'print("largest:", abs(run["{label}"]).max(), "m")',
        "plot_result(run)",
    )
    return (
        f"<h1>{escape(made.title or name)}</h1>\n<p>{escape(made.source)}</p>\n"
        f"<h2>Use</h2>\n<p>Import <code>{escape(name)}.fmu</code> as co-simulation: it needs no "
        f"connections and takes any communication step.{_EXCHANGE * bool(unit.states)} In Python, "
        f"<code>pip install fmpy</code>:</p>\n<pre>{escape(chr(10).join(lines))}</pre>\n"
    )
