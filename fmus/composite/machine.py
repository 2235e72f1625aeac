"""What the documentation of a composite says of its machine: a sketch, and how to run it."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .composition import Composition, Part

_LEFT, _LENGTH, _SHAFT = 70.0, 500.0, 120.0  # of the drawing
_EXCHANGE = " As model exchange, the solver of the tool integrates it."
_SPRING = "m0 0v10l-8 4 16 8-16 8 16 8-8 4v10m-14 0h28"
_STYLE = 'font-family="sans-serif" font-size="12" fill="none" stroke="#1f3b57" stroke-width="2"'


def page(made: Composition, name: str) -> str:
    """HTML: title, sketch, five lines that run it."""
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
        f"<h1>{escape(made.title or name)}</h1>\n<p>{escape(made.source)}</p>\n{sketch(made)}\n"
        f"<h2>Use</h2>\n<p>Import <code>{escape(name)}.fmu</code> as co-simulation: it needs no "
        f"connections and takes any communication step.{_EXCHANGE * bool(unit.states)} In Python, "
        f"<code>pip install fmpy</code>:</p>\n<pre>{escape(chr(10).join(lines))}</pre>\n"
    )


def sketch(made: Composition) -> str:
    """SVG of the machine from the side: shaft, supports, discs, balancers, unbalances."""
    rotor = made.parts[0]
    value = _values(rotor)
    places = [z for key, z in value.items() if key.endswith("].z")]
    ends = [value.get(f"support[{s}].position", (s - 1) * value.get("span", 1.0)) for s in (1, 2)]
    low, high = min([*ends, *places]), max([*ends, *places])

    def across(z: float) -> float:
        return _LEFT + _LENGTH * (z - low) / (high - low)

    middle = 0.5 * (low + high)
    drawn = [f'<path d="M{_LEFT - 30} {_SHAFT}H{_LEFT + _LENGTH + 30}" stroke-width="6"/>']
    drawn += [f'<path d="M{across(z):.1f} {_SHAFT}{_SPRING}"/>' for z in ends]
    if places:
        masses = [value[f"station[{j}].mass"] for j in range(1, len(places) + 1)]
        tall = [35.0 * (m / max(masses)) ** (1.0 / 3.0) for m in masses]
        drawn += [_box(across(z), 8.0, h, "#eef3f8") for z, h in zip(places, tall, strict=True)]
    elif "span" in value:
        drawn.append(_box(across(middle), 0.8 * _LENGTH, 28.0, "#eef3f8"))
    else:
        drawn.append(_box(across(middle), 14.0, 50.0, "#eef3f8"))
    for name in value:
        if name.endswith(("unbalance", ".amount")) and value[name]:
            of = name.removesuffix("amount") + "position"
            x = across(value.get(of, middle))
            drawn.append(f'<path d="M{x:.1f} {_SHAFT}v-62m-5 9l5-9 5 9" stroke="#c8372d"/>')
    rows: dict[float, int] = {}
    for part in made.parts[1:]:
        if part.plane:
            z = value.get(f"plane[{part.plane}].position", middle)
            rows[z] = rows.get(z, -1) + 1
            drawn += _balancer(part, across(z), rows[z])
        else:
            text = f'<text x="8" y="{_SHAFT - 24}" fill="#1f3b57" stroke="none">{part.name}</text>'
            drawn += [_box(_LEFT - 45.0, 30.0, 16.0, "#dfe7d5"), text]
    if places or "span" in value:
        length = f"{1e3 * (high - low):.4g} mm"
        text = (
            f'<text x="{across(middle):.0f}" y="192" fill="#1f3b57" stroke="none">{length}</text>'
        )
        drawn += [f'<path d="M{across(low)} 198H{across(high)}" stroke-width="1"/>', text]
    body = "\n".join(drawn)
    return f'<svg viewBox="0 0 640 210" width="640" role="img" {_STYLE}>\n{body}\n</svg>'


def _values(part: Part) -> dict[str, float]:
    starts = {v.name: v.start for v in part.unit.layout.reals if v.causality == "parameter"}
    return {k: float(v or 0.0) for k, v in {**starts, **part.start}.items()}


def _box(x: float, width: float, half: float, fill: str) -> str:
    corner = f'x="{x - 0.5 * width:.1f}" y="{_SHAFT - half:.1f}"'
    return f'<rect {corner} width="{width:.1f}" height="{2.0 * half:.1f}" fill="{fill}"/>'


def _balancer(part: Part, x: float, row: int) -> list[str]:
    """A track or a chamber above and below the shaft, with its name."""
    what = '<circle cx="{x:.1f}" cy="{y:.1f}" r="6" fill="#f2a900"/>'
    if part.model != "BallBalancer":
        what = '<path d="M{x:.1f} {y:.1f}m-8 0h16" stroke="#2a7fba" stroke-width="8"/>'
    marks = [what.format(x=x, y=_SHAFT + side * 44.0) for side in (-1, 1)]
    frames = [
        f'<rect x="{x - 10:.1f}" y="{_SHAFT + side * 44.0 - 9:.1f}" width="20" height="18"/>'
        for side in (-1, 1)
    ]
    height = 18 + 16 * row
    name = f'<text x="{x - 16:.1f}" y="{height}" fill="#1f3b57" stroke="none">{part.name}</text>'
    return [*frames, *marks, name]
