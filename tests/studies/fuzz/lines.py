"""Command lines: every command with any of its options, most of them right, some mangled."""

from __future__ import annotations

import random
from functools import cache
from pathlib import Path
from typing import Any

import typer

from autobalancer.harness import bundled_scenes
from autobalancer.harness.__main__ import program

from . import scenes
from .judge import KEPT

QUICK = ["two_balls", "filimonikhina", "liquid_disc", "three_mass_shaft", "run_up", "sommerfeld"]
ON_SCENE = [*["run"] * 20, "rotor", "check", "build", "speeds", "map", "balance", "scatter"]
LONG = ("check", "precision", "stress")  # made of many runs
NUMBERS = [
    "0", "1", "2", "3", "-5", "0.5", "12", "150", "1e300", "1e-300", "nan", "inf", "1e9", "x",
]  # fmt: skip
WORDS = [
    *["", ",", "--", "-", "-o", "--x", "--set", "--range", "--help", "--version", "nowhere", "/"],
    *["two_balls", "speed=1:2:3", "a=b=c", "\x1b[31m", "ü", "\udcff", "x" * 300, "-1", "a\nb"],
]
PLACES = [
    "new", "new", "new", "kept", "kept", "protected", "ü (x) 'y' %41", "nowhere/x", "folder/x",
]  # fmt: skip
ODD = [
    "/dev/null", "/dev/full", "/proc/x.png", "folder", ".", "given/scene.toml", "\udcff.csv", "x",
]  # fmt: skip
ENDINGS = {
    "FILE.csv": [".csv"],
    "FILE.png": [".png", ".svg", ".pdf"],
    "FILE": [".png", ".png", ".svg", ".pdf", ".html", ".csv"],
    "FILE.gif": [".gif", ".webp", ".mp4"],
    "FILE.html": [".html"],
    "FILE.toml": [".toml"],
}
NAMED_ENDINGS = {
    "json": ".json",
    "csv": ".csv",
    "markdown": ".md",
    "store": ".store",
}  # by an option's name
AXES = ["speed", "speed", "rotor.mass", "rotor.unbalance", "rotor.stiffness", "weights.drag"]
AXES += ["operation.gravity", "run.revolutions", "coupling.order", "rotor.kind", "nothing"]
DISTRIBUTIONS = [
    *["normal(1,0.1)", "normal(1,0.1,0.9,1.1)", "uniform(0.5,1)", "lognormal(1,0.1)"],
    *["normal(mean=1,deviation=5%)", "normal(1,-1)", "cauchy(1)", "norm()", "uniform(2,1)"],
    *["normal(nan,1)", "normal(1", "f(x)"],
]
VALUES = {  # of options by what the help calls them, with places that are filled in
    "KEY=VALUE": ["{change}", "rotor.mass=1.5", "operation.gravity=9.81", "coupling.order=5"],
    "PATH=LOW:HIGH:N[:log]": [
        *["speed=0.5:5:3", "rotor.mass=0.5:5:2", "rotor.unbalance=0.5:5:4:log"],
        *["{path}=0.5:150:3", "{path}={low}:{high}:3:log"],
    ],
    "PATH=NAME(NUMBERS)": [
        "rotor.mass=normal(1,0.1)",
        "{path}=uniform(0.5,1)",
        "{path}={distribution}",
    ],
    "PATH,...": [
        "rotor.stiffness",
        "rotor.mass,rotor.damping",
        "rotor.mass=weights.mass",
        "{path}",
    ],
    "DIR": ["report", "given", "folder", "nowhere/deep", "given/scene.toml", "/proc/x"],
    "TIME": ["1s", "0.1s", "5s", "0", "-1", "soon", "1e9d", "9999999999d"],
    "NAME": ["x86_64-linux", "x86_64-windows", "vax"],
    "ADDRESS": ["", "tcp://127.0.0.1:9", "127.0.0.1:99999", "nowhere"],
    "2|3": ["2", "3", "4"],
    "LOW HIGH": ["0.5", "3", "12", "150", *NUMBERS],
}
NAMED = {  # values of single options, by the option's name
    "measured": ["given/fitted.csv", "given/fitted.csv", "given/fitted_wrong.csv"],
    "predict": ["given/fitted.csv", "given/fitted_wrong.csv"],
    "method": ["floquet", "criterion", "criterion,floquet", "cosim", ",", ""],
    "angles": ["12", "0,120,240", "12/24", "0", "-3", "x", "1e9", ""],
    "grade": ["G2.5", "G0", "G-1", "X", "G1e300"],
    "words": ["stiff", "loop", "nothing"],
}
FITTED = (
    "speed [rpm],rotor.unbalance,amplitude [mm]\n1100,0.02,0.0455\n1900,0.01,0.09\n700,0.02,0.03\n"
)
BALANCED = (
    "run,mass_g[a],angle_deg[a],sensor,amplitude_um,phase_lag_deg\n"
    "0,,,1,20.0,30\n0,,,2,11.0,80\n1,5,90,1,12.0,70\n1,5,90,2,16.0,10\n"
)


@cache
def commands() -> dict[str, Any]:
    """By name, as the command line knows them."""
    return typer.main.get_command(program()).commands  # type: ignore[attr-defined]


def furnish(draw: random.Random, folder: Path) -> None:
    """Files that command lines name."""
    given = folder / "given"
    for place in (given, folder / "folder"):
        place.mkdir()
    scenes.scene(draw, given / "scene.toml")
    for name, text in (("fitted", FITTED), ("balanced", BALANCED)):
        (given / f"{name}.csv").write_text(text)
        cells = text.replace("\n", ",\n,").split(",")
        cells[draw.randrange(len(cells))] = draw.choice([*NUMBERS, *WORDS[:-3], "amplitude [km]"])
        mangled = ",".join(cells).replace(",\n,", "\n")
        (given / f"{name}_wrong.csv").write_text(mangled, "utf-8", "surrogateescape")
    for ending in {each for endings in ENDINGS.values() for each in endings}:
        (folder / f"kept{ending}").write_bytes(KEPT)
        (folder / f"protected{ending}").write_bytes(KEPT)
        (folder / f"protected{ending}").chmod(0o444)


def line(draw: random.Random, scene: str = "") -> list[str]:
    """One command and its arguments, on this scene where one is given."""
    name = draw.choice(ON_SCENE if scene else list(commands()))
    words = [name]
    for parameter in commands()[name].params:
        if parameter.param_type_name == "argument":
            if scene or parameter.required or draw.random() < 0.7:
                words.insert(1, scene or _scene(draw, name))
        elif draw.random() < (0.98 if parameter.required else 0.12):
            words += _option(draw, parameter)
    words += _brief(draw, name, words)
    if draw.random() < 0.1:
        _mangle(draw, words)
    return words


def _scene(draw: random.Random, command: str) -> str:
    kinds = [draw.choice(QUICK)] * 9 + [draw.choice(bundled_scenes())]
    kinds += ["given/scene.toml", draw.choice(WORDS)]
    if command == "balance":
        kinds += ["given/balanced.csv", "given/balanced_wrong.csv", "balancing_machine"] * 6
    return "stiff" if command == "stress" else draw.choice(kinds)


def _option(draw: random.Random, parameter: Any) -> list[str]:
    option = draw.choice(parameter.opts)
    if getattr(parameter, "is_flag", False):
        return [option]
    if parameter.nargs == 2 and draw.random() < 0.7:
        return [option, *draw.choice([("0.5", "3"), ("1", "12"), ("40", "150")])]
    return [option, *(_value(draw, parameter) for _ in range(parameter.nargs))]


def _value(draw: random.Random, parameter: Any) -> str:
    kind, name = parameter.metavar or "", parameter.name
    if draw.random() < 0.04:
        return draw.choice(WORDS + ODD)
    if kind.startswith("FILE") and name not in NAMED:
        if draw.random() < 0.1:
            return draw.choice(ODD)
        named = [ending for word, ending in NAMED_ENDINGS.items() if word in name]
        return draw.choice(PLACES) + draw.choice(named or ENDINGS[kind])
    members = getattr(parameter.type_descriptor.annotation, "__members__", {}).values()
    words = [each.value for each in members] or NAMED.get(name) or VALUES.get(kind, NUMBERS)
    return draw.choice(words).format(
        path=draw.choice(AXES),
        change=scenes.assignment(draw),
        distribution=draw.choice(DISTRIBUTIONS),
        low=draw.choice(NUMBERS),
        high=draw.choice(NUMBERS),
    )


def _brief(draw: random.Random, name: str, words: list[str]) -> list[str]:
    """Options that keep most lines short."""
    known = {option for each in commands()[name].params for option in each.opts}
    brief = {"--set": "run.revolutions=0.3", "-n": "4", "--movie-seconds": "0.2", "--starts": "6"}
    brief |= {"--most": "2", "--seconds": "1", "--at-most": "1s" if name in LONG else "5s"}
    return [
        part
        for option, what in brief.items()
        if option in known and (option not in words or option == "--set") and draw.random() < 0.9
        for part in (option, what)
    ]


def _mangle(draw: random.Random, words: list[str]) -> None:
    place, kind = draw.randrange(len(words)), draw.random()
    if kind < 0.3:
        del words[place]
    elif kind < 0.6:
        words[place] = draw.choice(WORDS)
    elif kind < 0.8:
        words.insert(place, draw.choice(words))
    else:
        draw.shuffle(words)
