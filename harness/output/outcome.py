"""What the methods of a scene give back: each is a table, most are a picture, and files of both."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from ..errors import UserError
from .files import PICTURES, write_json, write_whole
from .table import Sheet

if TYPE_CHECKING:
    from pandas import DataFrame
    from xarray import Dataset

    from .picture import Picture
    from .plot import Drawing

_SHOWN = 20  # rows in a notebook
_TABLE, _JSON, _ARRAYS = ".csv", ".json", ".nc"


class Outcome(ABC):
    """A result that is a table.

    Attributes:
        dimensions: how many leading columns of the table span a grid.
        drawn_by: module and function of its picture; called with it and a path.
        document_by: of its document for JSON; default: the rows of its table.
    """

    dimensions: ClassVar[int] = 0
    drawn_by: ClassVar[str] = ""
    document_by: ClassVar[str] = ""

    @abstractmethod
    def table(self) -> Sheet:
        """Numbers under heads with their units; an empty cell where there is none.

        >>> found = ab.load("filimonikhina").speeds(0.5, 12.0, "criterion")
        >>> found.table().columns[0]
        'method'
        """

    def plot(self, path: str | Path | None = None, **options: Any) -> Path | Drawing | Picture:
        """The picture: written where a path is given, else shown in a notebook, `save(path)`.

        Args:
            options: of the function `drawn_by`.

        Raises:
            UserError: there is no picture of it, or the file cannot be written.

        >>> found = ab.load("filimonikhina").speeds(0.5, 12.0, "criterion")
        >>> found.plot("speeds.png").name
        'speeds.png'
        """
        if not self.drawn_by:
            raise UserError(f"{type(self).__name__}: has no picture; save it as .csv or .json")
        found: Path | Drawing = _function(self.drawn_by)(self, path and Path(path), **options)
        return found

    def as_json(self) -> dict[str, Any]:
        """Everything, for JSON.

        >>> found = ab.load("filimonikhina").speeds(0.5, 12.0, "criterion")
        >>> list(found.as_json())[0]
        'scene'
        """
        if self.document_by:
            return dict(_function(self.document_by)(self))
        sheet = self.table()
        return {"rows": [dict(zip(sheet.columns, row, strict=True)) for row in sheet.rows]}

    def to_csv(self, path: str | Path) -> Path:
        """Write the table as CSV.

        Raises:
            UserError: the file cannot be written.

        >>> found = ab.load("filimonikhina").speeds(0.5, 12.0, "criterion")
        >>> found.to_csv("speeds.csv").name
        'speeds.csv'
        """
        return self.table().write_csv(Path(path))

    def to_pandas(self) -> DataFrame:
        """The table as a frame, columns named with their units.

        Raises:
            UserError: pandas is not installed.

        >>> found = ab.load("filimonikhina").speeds(0.5, 12.0, "criterion")
        >>> len(found.to_pandas())
        3
        """
        sheet = self.table()
        rows = [[None if cell == "" else cell for cell in row] for row in sheet.rows]
        frame = library("pandas").DataFrame(rows, columns=list(sheet.columns))
        return frame.infer_objects()

    def to_xarray(self) -> Dataset:
        """The table as a data set, a grid where it is one.

        Raises:
            UserError: xarray is not installed.

        >>> found = ab.load("filimonikhina").speeds(0.5, 12.0, "criterion")
        >>> found.to_xarray().sizes["index"]
        3
        """
        library("xarray")
        frame = self.to_pandas()
        grid = list(frame.columns[: self.dimensions])
        return (frame.set_index(grid) if grid else frame).to_xarray()

    def save(self, path: str | Path) -> Path:
        """Write .csv (the table), .json (everything), .nc (the data set), or the picture.

        Raises:
            UserError: the name has another end, or the file cannot be written.

        >>> found = ab.load("filimonikhina").speeds(0.5, 12.0, "criterion")
        >>> found.save("speeds.json").name
        'speeds.json'
        """
        path = Path(path)
        suffix = path.suffix.lower()
        if suffix == _TABLE:
            return self.to_csv(path)
        if suffix == _JSON:
            write_json(self.as_json(), path)
        elif suffix == _ARRAYS:
            whole = self.to_xarray().to_netcdf(engine="scipy")
            with write_whole(path, "wb") as stream:
                stream.write(whole)
        elif suffix.removeprefix(".") in PICTURES:
            self.plot(path)
        else:
            ends = ", ".join((_TABLE, _JSON, _ARRAYS, *(f".{kind}" for kind in PICTURES)))
            raise UserError(f"{path}: must end in {ends}")
        return path

    def __repr__(self) -> str:
        sheet = self.table()
        title = f" {sheet.title!r}" if sheet.title else ""
        return f"<{type(self).__name__}{title}: {len(sheet.rows)} rows>"

    def _repr_html_(self) -> str:
        sheet = self.table()
        return replace(sheet, rows=sheet.rows[:_SHOWN]).html()


def _function(place: str) -> Callable[..., Any]:
    module, _, name = place.partition(":")
    found: Callable[..., Any] = getattr(import_module(module, __package__), name)
    return found


def library(name: str) -> Any:
    """A library that is not required.

    Raises:
        UserError: it is not installed.
    """
    try:
        return __import__(name)
    except ImportError as error:
        raise UserError(f'this needs {name}: pip install "autobalancer[data]"') from error
