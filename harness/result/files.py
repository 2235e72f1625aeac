"""A result as tables of other libraries, and as a netCDF file that gives the same result again.

Everything but the signals stands in one attribute as JSON: netCDF knows numbers and text alone.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import fields
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import UserError
from ..master.names import quantity
from ..output.files import write_whole
from ..output.outcome import library
from ..scene import Scene
from .velocity import VELOCITY

if TYPE_CHECKING:
    from pandas import DataFrame
    from xarray import Dataset

    from .result import Result

PACKAGE = "autobalancer"
FACTS = "autobalancer_run"  # the attribute
_TUPLES = ("left_out", "units", "events")
_OWN = ("time", "signals", "signal_units", "scene", "velocity")  # stored in ways of their own


def to_pandas(result: Result) -> DataFrame:
    """See `Result.to_pandas`."""
    pandas = library("pandas")
    frame = pandas.DataFrame(result.signals, index=pandas.Index(result.time, name="time"))
    frame.attrs = {"title": result.scene_title, "units": dict(result.signal_units)}
    return frame


def to_xarray(result: Result) -> Dataset:
    """See `Result.to_xarray`."""
    xarray, signals = library("xarray"), {}
    for name, values in result.signals.items():
        unit = result.signal_units.get(name, "")
        about = {"units": unit, "long_name": f"{quantity(name, unit)} {name}"}
        signals[name] = ("time", values, about)
    time = {"time": ("time", result.time, {"units": "s", "long_name": "time"})}
    return xarray.Dataset(signals, time, {"title": result.scene_title, FACTS: _facts(result)})


def save(result: Result, path: Path) -> Path:
    """See `Result.save`."""
    kept = {name: ("time", each) for name, each in result.velocity.items()}
    whole = to_xarray(result).assign(kept).to_netcdf(engine="scipy")
    with write_whole(path, "wb") as stream:
        stream.write(whole)
    return path


def load(path: Path, kind: type[Result]) -> Result:
    """See `Result.load`."""
    xarray = library("xarray")
    try:
        # a time in seconds is no date
        stored = xarray.load_dataset(path, engine="scipy", decode_times=False)
        return _result(stored, json.loads(stored.attrs[FACTS]), kind)
    except OSError as error:
        raise UserError(f"{path}: cannot be read: {error.strerror or error}") from error
    except (TypeError, ValueError, KeyError, AttributeError, ImportError) as error:
        raise UserError(
            f"{path}: is not a result that `Result.save` of this version has written; run the "
            "scene again and save that result, or load the file with the version that wrote it"
        ) from error


def _result(stored: Dataset, facts: dict[str, Any], kind: type[Result]) -> Result:
    scene, units = facts.pop("scene"), facts.pop("signal_units")
    columns = {str(name): v.values.astype(float) for name, v in stored.data_vars.items()}
    facts |= {name: tuple(facts[name]) for name in _TUPLES}
    return kind(
        time=stored["time"].values.astype(float),
        signals={name: each for name, each in columns.items() if name in units},
        velocity={n: each for n, each in columns.items() if n.endswith(f".{VELOCITY}")},
        signal_units=units,
        scene=scene and _scene(scene),
        **facts,
    )


def _facts(result: Result) -> str:
    plain = {f.name: getattr(result, f.name) for f in fields(result) if f.name not in _OWN}
    scene = result.scene
    plain |= {
        "signal_units": result.signal_units,
        "scene": scene
        and {
            "document": scene.document,
            "path": scene.path,
            "label": scene.label,
            "class": _class_name(type(scene)),
        },
    }
    return json.dumps(plain, default=str)


def _scene(stored: Mapping[str, Any]) -> Scene:
    path = stored["path"] and Path(stored["path"])
    kind = _class_named(stored.get("class", ""))
    return kind.from_document(stored["document"], path=path, label=stored["label"])


def _class_name(kind: type[Scene]) -> str:
    """Module and name of a scene's class, or of the first above it that this package has."""
    own = next(c for c in kind.__mro__ if c.__module__.split(".")[0] == PACKAGE)
    return f"{own.__module__}:{own.__qualname__}"


def _class_named(name: str) -> type[Scene]:
    """The class of this name, which is loaded as a pickle does; else the description's own."""
    module, _, own = name.partition(":")
    if module.split(".")[0] != PACKAGE:
        return Scene
    found = getattr(import_module(module), own)
    return found if isinstance(found, type) and issubclass(found, Scene) else Scene
