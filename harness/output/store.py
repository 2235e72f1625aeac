"""Outcomes that last: a Zarr store written as they come, and gone on with after any end.

xarray and every other reader of Zarr open it.  A chunk is an item, and appears whole or not at
all; that it is finished is noted last.  Nothing depends on when or where an item was worked on, so
a store that was gone on with is byte for byte the one of an undisturbed run.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ..errors import UserError
from .files import refuse_unwritable

if TYPE_CHECKING:
    import zarr

EXTRA = 'pip install "autobalancer[large]"'
_MADE = "fmus/native/bin/"  # by a compiler, from the other sources
_SHOWN = 60  # characters of what a store was made for


@dataclass(frozen=True)
class StoredArray:
    """An array of a store.

    Attributes:
        dims: names of its dimensions; the items follow each other along `along`.
        shape: of the whole, and `chunk` along the items' dimension for each of them.
        dtype: `f8`, `i8` or `str`.
        meaning: with the unit.
    """

    dims: tuple[str, ...]
    shape: tuple[int, ...]
    along: str
    dtype: str = "f8"
    chunk: int = 1
    meaning: str = ""

    @property
    def axis(self) -> int:
        """Place of the items' dimension."""
        return self.dims.index(self.along)


class StoredItems:
    """Outcomes of numbered items, as tuples: for every variable of the part the item's chunk.

    The items' dimension comes first in a chunk; a chunk of one value is that value.
    """

    def __init__(self, group: zarr.Group, name: str, variables: Mapping[str, StoredArray]) -> None:
        self._arrays = [(_array(group, each), one) for each, one in variables.items()]
        self._done = _array(group, _mark(name))
        self._finished = set(np.flatnonzero(self._done[:]).tolist())
        self._known: dict[int, tuple[Any, ...]] = {}

    def __len__(self) -> int:
        return len(self._finished)

    def __contains__(self, item: object) -> bool:
        return item in self._finished

    def __getitem__(self, item: int) -> tuple[Any, ...]:
        if item not in self._known:
            self._known[item] = tuple(
                chunk.item() if chunk.size == 1 else np.moveaxis(chunk, one.axis, 0)
                for array, one in self._arrays
                for chunk in [array.blocks[_chunk_index(item, one)]]
            )
        return self._known[item]

    def __setitem__(self, item: int, outcome: tuple[Any, ...]) -> None:
        for (array, one), value in zip(self._arrays, outcome, strict=True):
            chunk = np.moveaxis(value, 0, one.axis) if np.ndim(value) else value
            array.blocks[_chunk_index(item, one)] = chunk
        self._done[item] = 1
        self._finished.add(item)
        self._known[item] = outcome


def refuse_store(path: Path) -> None:
    """Refuse a place where no store can be begun or gone on with.

    Raises:
        UserError: no library for stores, a file is there, or the place cannot be written to.
    """
    try:
        import zarr  # noqa: F401
    except ImportError:
        raise UserError(f"{path}: needs Zarr, and that Python 3.11: {EXTRA}") from None
    if path.is_file():
        raise UserError(f"{path}: is a file and no store: name another place, or remove it")
    refuse_unwritable(path / "anything" if path.is_dir() else path)


def open_store(
    path: Path,
    made_for: Mapping[str, str],
    parts: Mapping[str, Mapping[str, StoredArray]],
    coordinates: Mapping[str, tuple[str, ArrayLike]],
    program: Sequence[Path] = (),
) -> dict[str, StoredItems]:
    """A store's parts by name, begun if there is none at that place.

    Args:
        made_for: in words whatever the outcomes depend on, but for the program, which is added.
        parts: the variables of every part.
        coordinates: the dimension and the values along it, by name.
        program: folders of sources outside the package that the outcomes depend on.

    Raises:
        UserError: what is there is no store, or was made for something else.
    """
    import zarr

    made_for = {**made_for, "program": _program(program)}
    if not path.exists():
        unfinished = path.with_name(f".{path.name}-begun")
        shutil.rmtree(unfinished, ignore_errors=True)
        _begin(unfinished, made_for, parts, coordinates)
        os.rename(unfinished, path)
    try:
        group = zarr.open_group(path, mode="r+", use_consolidated=False)
        _refuse_foreign(path, dict(group.attrs), made_for)
        for half in path.rglob("*.partial"):  # a chunk that was being written when the end came
            half.unlink(missing_ok=True)
        return {name: StoredItems(group, name, variables) for name, variables in parts.items()}
    except (ValueError, KeyError, FileNotFoundError) as error:
        raise UserError(f"{path}: is no store that can be gone on with: {error}") from error


def _begin(
    path: Path,
    made_for: Mapping[str, str],
    parts: Mapping[str, Mapping[str, StoredArray]],
    coordinates: Mapping[str, tuple[str, ArrayLike]],
) -> None:
    """An empty store, with all its arrays."""
    import zarr

    group = zarr.create_group(path, attributes=dict(made_for))
    for name, (dim, values) in coordinates.items():
        data = np.asarray(values)
        kind = "str" if data.dtype.kind == "U" else data.dtype
        array = group.create_array(
            name, shape=data.shape, dtype=kind, chunks=data.shape, dimension_names=(dim,)
        )
        array[:] = data
    for name, variables in parts.items():
        for each, one in variables.items():
            sizes = zip(one.dims, one.shape, strict=True)
            group.create_array(
                each,
                shape=one.shape,
                dtype=one.dtype,
                chunks=tuple(one.chunk if dim == one.along else size for dim, size in sizes),
                fill_value="" if one.dtype == "str" else 0 if one.dtype == "i8" else np.nan,
                dimension_names=one.dims,
                attributes={"long_name": one.meaning},
            )
        first = next(iter(variables.values()))
        items = -(-first.shape[first.axis] // first.chunk)
        group.create_array(
            _mark(name), shape=(items,), dtype="u1", chunks=(1,), fill_value=0,
            dimension_names=(name,), attributes={"long_name": f"1: this {name} is finished"},
        )  # fmt: skip
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # Zarr 3 does not standardise it yet; xarray asks for it
        zarr.consolidate_metadata(path)


def _array(group: zarr.Group, name: str) -> Any:
    array: Any = group[name]
    # what happens to be all fill values is written, too: a chunk that is there was worked on
    return array.with_config({"write_empty_chunks": True})


def _mark(part: str) -> str:
    return f"{part}_done"


def _chunk_index(item: int, one: StoredArray) -> tuple[int, ...]:
    return tuple(item if dim == one.along else 0 for dim in one.dims)


def _program(others: Sequence[Path] = ()) -> str:
    """The package's sources, and others: different ones might compute something else."""
    root = Path(__file__).resolve().parents[2]
    content = hashlib.sha256()
    for folder in (*(root / name for name in ("models", "fmus", "harness")), *others):
        for path in sorted(folder.rglob("*.[pch]*")):
            name = path.relative_to(folder.parent).as_posix()
            if path.suffix in (".py", ".c", ".h") and not name.startswith(_MADE):
                content.update(name.encode() + path.read_bytes())
    return f"autobalancer {content.hexdigest()[:16]}"


def _refuse_foreign(path: Path, theirs: Mapping[str, Any], ours: Mapping[str, str]) -> None:
    for key, own in ours.items():
        other = theirs.get(key)
        if other == own:
            continue
        lines = zip_longest(str(other).splitlines(), own.splitlines(), fillvalue="")
        there, here = next((a, b) for a, b in lines if a != b)
        raise UserError(
            f"{path}: was made for another {key}: {there[:_SHOWN]!r} there, {here[:_SHOWN]!r} now; "
            "name another place, or remove it"
        )
