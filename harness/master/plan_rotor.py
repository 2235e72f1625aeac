"""A scene's rotor as build options and parameters of its unit."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ..scene.rotor import FlexibleRotor, PlanarRotor, TwoSupportRotor, Unbalance

Options = dict[str, Any]
Parameters = dict[str, float]
Pairs = Sequence[tuple[float, float]]


def rotor_options(
    rotor: PlanarRotor | TwoSupportRotor | FlexibleRotor, carrying: Sequence[int]
) -> tuple[Options, Parameters]:
    """Build options and parameters of the unit; `carrying` are the stations with balancers."""
    if isinstance(rotor, PlanarRotor):
        return _planar(rotor)
    if isinstance(rotor, TwoSupportRotor):
        return _two_support(rotor)
    return _flexible(rotor, carrying)


def _planar(rotor: PlanarRotor) -> tuple[Options, Parameters]:
    return {}, {
        "mass": rotor.mass,
        "stiffness_x": rotor.stiffness[0],
        "stiffness_y": rotor.stiffness[1],
        "damping_x": rotor.damping[0],
        "damping_y": rotor.damping[1],
        "internal_damping": rotor.internal_damping,
        "unbalance": rotor.unbalance,
        "unbalance_angle": rotor.unbalance_angle,
    }


def _two_support(rotor: TwoSupportRotor) -> tuple[Options, Parameters]:
    planes = rotor.planes or (0.0,)  # a unit has at least one plane
    unbalances = rotor.unbalances or (Unbalance(position=0.0, amount=0.0),)
    options = {
        "kind": rotor.kind,
        "stations": 2,
        "planes": len(planes),
        "unbalances": len(unbalances),
    }
    return options, {
        "mass": rotor.mass,
        "inertia": rotor.inertia,
        "polar_inertia": rotor.polar_inertia,
        "span": rotor.span,
        "com": rotor.span / 2.0 if rotor.com is None else rotor.com,
        **_supports(rotor.stiffness, rotor.damping),
        **{f"plane[{i}].position": place for i, place in enumerate(planes, start=1)},
        **_unbalances(unbalances),
    }


def _flexible(rotor: FlexibleRotor, carrying: Sequence[int]) -> tuple[Options, Parameters]:
    z = rotor.stations
    unbalances = rotor.unbalances or (Unbalance(position=z[0], amount=0.0),)
    options = {
        "kind": rotor.kind,
        "stations": len(z),
        "planes": len(carrying),
        "unbalances": len(unbalances),
        "shaft": "uniform" if rotor.compliance is None else "compliance",
    }
    values = {f"station[{j}].z": place for j, place in enumerate(z, start=1)}
    values |= {f"station[{j}].mass": mass for j, mass in enumerate(rotor.masses, start=1)}
    values |= {f"support[{s}].position": z[j - 1] for s, j in enumerate(rotor.supports, start=1)}
    values |= {f"plane[{i}].position": z[j - 1] for i, j in enumerate(carrying, start=1)}
    if rotor.compliance is None:
        assert rotor.bending_stiffness is not None
        values["bending_stiffness"] = rotor.bending_stiffness
    else:
        delta = rotor.compliance
        values |= {
            f"compliance[{j + 1},{k + 1}]": (delta[j][k] + delta[k][j]) / 2.0
            for j in range(len(delta))
            for k in range(j, len(delta))
        }
    values |= _supports(rotor.support_stiffness, rotor.support_damping)
    values |= _unbalances(unbalances)
    return options, {**values, "internal_damping": rotor.internal_damping}


def _supports(stiffness: Pairs, damping: Pairs) -> dict[str, float]:
    return {
        f"support[{s}].{what}_{axis}": value
        for what, pairs in (("stiffness", stiffness), ("damping", damping))
        for s, pair in enumerate(pairs, start=1)
        for axis, value in zip("xy", pair, strict=True)
    }


def _unbalances(unbalances: Sequence[Unbalance]) -> dict[str, float]:
    return {
        f"unbalance[{k}].{name}": value
        for k, unbalance in enumerate(unbalances, start=1)
        for name, value in unbalance.model_dump().items()
    }
