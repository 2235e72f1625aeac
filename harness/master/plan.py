"""What a scene asks of the FMUs: which units, which start values, which variables are connected."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...fmus.build import build
from ..errors import UnitError
from ..scene import Scene
from ..scene.balancer import LiquidBalancer, WeightBalancer
from ..scene.rotor import FlexibleRotor
from .fmu import Unit
from .plan_rotor import rotor_options

AXES = ("xi", "eta")


@dataclass(frozen=True)
class UnitPlan:
    """One unit of a scene: its instance name, the FMU to build, and its start values."""

    name: str
    model: str
    options: Mapping[str, Any]
    parameters: Mapping[str, float | bool]


def plan(scene: Scene) -> list[UnitPlan]:
    """The units a scene needs and no others: the rotor first, then the balancers in order."""
    profile = scene.profile()
    drive = {"speed": profile.speed(0.0), "acceleration": profile.acceleration(0.0)}
    return [_rotor(scene, drive), *(_balancer(scene, one, drive) for one in scene.balancer)]


def ports(scene: Scene) -> list[int]:
    """Plane of the rotor unit, from 1, of every balancer.

    A flexible rotor has as many planes as stations: its unit has only those that carry something.
    """
    if isinstance(scene.rotor, FlexibleRotor):
        carrying = _carrying(scene)
        return [1 + carrying.index(balancer.at) for balancer in scene.balancer]
    return [balancer.at for balancer in scene.balancer]


def _carrying(scene: Scene) -> list[int]:
    """Stations with balancers, ascending; a unit has at least one plane."""
    return sorted({balancer.at for balancer in scene.balancer}) or [1]


def _rotor(scene: Scene, drive: Mapping[str, float]) -> UnitPlan:
    options, parameters = rotor_options(scene.rotor, _carrying(scene))
    count = options.get("stations", 1)
    prefixes = [f"station[{j}]." for j in range(1, count + 1)] if count > 1 else [""]
    start = {
        f"{'' if name == 'angle' else prefix}{name}0": value
        for name, value in scene.run.initial.items()
        for prefix in prefixes
    }
    return UnitPlan("rotor", "RotorOnSupports", options, {**parameters, **start, **drive})


def _balancer(
    scene: Scene, balancer: LiquidBalancer | WeightBalancer, drive: Mapping[str, float]
) -> UnitPlan:
    if isinstance(balancer, LiquidBalancer):
        names = ("chamber_radius", "float_radius", "height", "density", "inertia_as_force")
        values = {name: getattr(balancer, name) for name in names}
        return UnitPlan(balancer.label, "LiquidBalancer", {}, values)
    values = {
        "mass": balancer.mass,
        "track_radius": balancer.track_radius,
        "kappa": balancer.kappa,
        "drag": balancer.drag,
        "weight_radius": balancer.weight_radius or 0.0,
        "restitution": _restitution(scene, balancer),
        "rolling_resistance": balancer.rolling_resistance,
        "track_offset_xi": balancer.track_offset_xi,
        "track_offset_eta": balancer.track_offset_eta,
        "inertia_as_force": balancer.inertia_as_force,
        **drive,
    }
    mounted = balancer.build()
    for k, (angle, speed) in enumerate(zip(mounted.angles, mounted.speeds, strict=True), start=1):
        values[f"weight[{k}].angle0"] = angle
        values[f"weight[{k}].speed0"] = speed
    return UnitPlan(balancer.label, "BallBalancer", {"weights": balancer.count}, values)


def _restitution(scene: Scene, balancer: WeightBalancer) -> float:
    """Coefficient of the unit, which knows no rotor: for a rotor that is held."""
    if not (balancer.restitution and balancer.weight_radius):
        return 0.0
    from ...models.contact.contact import restitution_on

    rotor = scene.assembly().loaded_rotor
    row = rotor.planes[balancer.at - 1]
    carrier = 1.0 / float(row @ np.linalg.solve(rotor.mass, row))
    return restitution_on(
        balancer.restitution, balancer.mass, carrier, balancer.half_angle, balancer.kappa
    )


def file_name(unit: UnitPlan) -> str:
    """Name of the FMU file a unit is built as, such as `BallBalancer-weights-3.fmu`."""
    return "-".join([unit.model, *(f"{k}-{v}" for k, v in sorted(unit.options.items()))]) + ".fmu"


def provide(units: Sequence[UnitPlan], directory: Path, fmus: Path | None) -> list[Path]:
    """The FMU file of every unit: found in `fmus`, or built into `directory` once per kind.

    Raises:
        UnitError: `fmus` is given and lacks a file.
    """
    paths = []
    for unit in units:
        if fmus is None:
            path = directory / file_name(unit)
            if not path.exists():
                build(unit.model, path, **unit.options)
        else:
            candidates = [fmus / file_name(unit), fmus / f"{unit.model}.fmu"]
            found = [candidate for candidate in candidates if candidate.is_file()]
            if not found:
                raise UnitError(
                    f"{fmus}: no FMU for {unit.name!r}: expected {candidates[0].name} or "
                    f"{candidates[1].name}; `autobalancer build -o {fmus} SCENE` makes them"
                )
            path = found[0]
        paths.append(path)
    return paths


def refuse_other_build(unit: Unit, unit_plan: UnitPlan) -> None:
    """Raise UnitError where an FMU has not the scene's weights: more would run along unseen."""
    count = unit_plan.options.get("weights")
    found = sum(name.endswith("].angle0") for name in unit.variables)
    if count is not None and found and found != count:
        raise UnitError(
            f"{unit.path}: has {found} weights, {unit_plan.name!r} of this scene has {count}; the "
            "FMU is of a different build: build it for this scene"
        )


def signals(names: Sequence[str], order: int) -> list[str]:
    """Variables of coupling signals: all values, then all first derivatives, up to `order`.

    Each name has `{}` where the axis stands, for example `plane[1].F_{}`.  The units declare them
    in this order, so that they are exchanged as one slice.
    """
    axes = [name.format(axis) for name in names for axis in AXES]
    orders = [axes, [f"der({name})" for name in axes]]
    orders += [[f"der({name},{k})" for name in axes] for k in range(2, order + 1)]
    return [name for group in orders[: order + 1] for name in group]
