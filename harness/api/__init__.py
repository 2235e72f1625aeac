"""Rotors with automatic balancers.

A `Scene` is a rotor, its balancers, and how the rotor is driven.  What is done with one is a method
of it, TOML is its file form, and all numbers are in SI units; text such as "20 g m" is converted.

    >>> import autobalancer as ab
    >>> drum = ab.Scene(
    ...     rotor=ab.Planar(mass=8.0, stiffness=20e3, damping=64.0, unbalance="20 g m"),
    ...     balancer=[ab.Balls(count=3, mass="50 g", track_radius=0.2, drag=0.2)],
    ...     speed="1430 rpm",
    ... )
    >>> drum
    <Scene 'scene': planar rotor, balls 'balls'>
    >>> drum == ab.load(drum.save("drum.toml"))
    True
    >>> drum.replace({"rotor.stiffness[x]": 30e3}).rotor.stiffness
    (30000.0, 20000.0)

`__init__.pyi` names everything that is here; a name is loaded when it is first used.
"""

from pathlib import Path

from autobalancer.fmus.lazy import lazy_names, names_in

_names = names_in(Path(__file__).with_suffix(".pyi"))
__all__ = sorted(_names)
__getattr__, __dir__ = lazy_names(__name__, _names)
