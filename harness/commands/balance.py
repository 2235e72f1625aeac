"""`autobalancer balance`: a scene's rotor on the virtual balancing machine, or measured runs."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..errors import UserError
from ..output import options
from ..output.files import write_json
from ..output.terminal import progress_bar, say
from .changes import changed_scene, set_option

if TYPE_CHECKING:
    from ..balancing.correction import Correction
    from ..balancing.cycles import BalancingReport

_MOST_ANGLES = 1000


def command(
    scene: Annotated[
        str,
        typer.Argument(
            metavar="SCENE", help="Scene with a table [balancing]; or FILE.csv: measured runs."
        ),
    ],
    output: Annotated[
        Path | None, options.picture("Draw the corrections.", "--output", "-o")
    ] = None,
    json_file: Annotated[Path | None, options.json("the results")] = None,
    changes: Annotated[list[str] | None, set_option("balancing.grade=G1")] = None,
    angles: Annotated[
        str | None,
        typer.Option(
            help="Where masses fit: 12 (evenly) or 0,120,240 (deg); planes separated by /."
        ),
    ] = None,
    min_max: Annotated[
        bool,
        typer.Option(
            "--min-max", help="Minimise the largest reading instead of the sum of squares."
        ),
    ] = False,
    largest_mass: Annotated[
        str | None, typer.Option(help="Largest correction in g: 5, or 5,8 for each plane.")
    ] = None,
    grade: Annotated[
        str | None, typer.Option(help="Grade of ISO 21940-11, for measured runs.")
    ] = None,
    mass: Annotated[
        float | None, options.quantity("kg", "Mass of the rotor, kg, for --grade.", "--mass")
    ] = None,
    service_speed: Annotated[
        float | None,
        options.quantity(
            "rad/s",
            "Service speed, rad/s, for --grade; default: the fastest measured.",
            "--service-speed",
        ),
    ] = None,
    report: Annotated[Path | None, options.REPORT] = None,
) -> None:
    """Find correction masses, on a virtual machine or from runs.

    Exit code 1 if the grade is not met.
    """
    from ..balancing.report import print_correction, print_cycles
    from ..output.report import Report

    result: BalancingReport | Correction
    if scene.endswith(options.TABLE):
        from ..balancing.correction import correct

        if changes:
            raise UserError("--set: belongs to a scene; measured runs have nothing to replace")
        for option, value in (("--mass", mass), ("--service-speed", service_speed)):
            if value is not None and not grade:
                raise UserError(f"{option}: judges a grade: give it too, such as --grade G2.5")
        name = Path(scene).stem
        page = Report(report, f"Balancing: {Path(scene).name}", [])
        page.cited = "Feese & Grazier 2004; ISO 21940-11"
        result = correct(
            scene,
            angles=allowed_angles(angles),
            grade=grade or "",
            mass=mass,
            service_speed=service_speed,
            min_max=min_max,
            largest=largest_masses(largest_mass),
        )
        with page.keeping():
            print_correction(result, Path(scene).name)
    else:
        given: dict[str, object] = {"--angles": angles, "--min-max": min_max or None}
        given |= {
            "--largest-mass": largest_mass,
            "--grade": grade,
            "--mass": mass,
            "--service-speed": service_speed,
        }
        if unfit := [option for option, value in given.items() if value is not None]:
            raise UserError(
                f"{', '.join(unfit)}: belong to measured runs (FILE.csv), not to a scene"
            )
        loaded = changed_scene(scene, changes)
        name = loaded.name
        page = Report(report, f"Balancing: {loaded.heading}", [loaded])
        page.cited = "Polushkin 2016; ISO 21940-11"
        with progress_bar(f"balancing {name}") as progress:
            result = loaded.balance(progress=progress)
        with page.keeping():
            print_cycles(result)
    for path in filter(None, (output, page.picture(f"{name}_balance"))):
        say(f"Picture: {result.plot(path)}")
    page.write()
    if json_file is not None:
        write_json(result.as_json(), json_file)
    if not result.met:
        raise typer.Exit(1)


def allowed_angles(text: str | None) -> list[list[float]]:
    """Angles [rad] by plane: `12` is every 30 degrees from 0, `0,120,240` these; `/` parts planes.

    Raises:
        UserError: it is not written like that.
    """
    lists = []
    for part in text.split("/") if text is not None else ():
        try:
            numbers = [float(each) for each in part.split(",")]
        except ValueError:
            numbers = [math.nan]
        if len(numbers) == 1 and numbers[0] in range(1, _MOST_ANGLES + 1):
            numbers = [360.0 * k / numbers[0] for k in range(int(numbers[0]))]
        elif len(numbers) == 1 or not all(map(math.isfinite, numbers)):
            raise UserError(
                f"--angles {text}: must be a number of even places, 1 to {_MOST_ANGLES}, or angles "
                "in degrees with commas; lists for the planes are separated by /"
            )
        lists.append([math.radians(each) for each in numbers])
    return lists


def largest_masses(text: str | None) -> list[float]:
    """Largest corrections [g]: `5` is that of all planes, `5,8` those of each.

    Raises:
        UserError: it is not written like that.
    """
    try:
        return [float(each) for each in text.split(",")] if text is not None else []
    except ValueError:
        raise UserError(
            f"--largest-mass {text}: must be grams, one number or one per plane with commas: 5,8"
        ) from None
