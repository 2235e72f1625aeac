"""Files that a user wrote: text, and tables of measurements as CSV."""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

from .errors import UserError

_SEPARATORS = ",;\t"
_DECIMAL_COMMA = r"[-+]?\d*,\d+(?:[eE][-+]?\d+)?(?:\s*[A-Za-zµμ°%][\w/%°^ -]*)?"  # and a unit
_TELLS_SEPARATOR = re.compile(r"sep=(.)", re.IGNORECASE)  # a first line for spreadsheets
_UTF_16 = b"\xff\xfe", b"\xfe\xff"
_OLD_OFFICE, _ZIP = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", b"PK\x03\x04"


def named_from(folder: Path, name: str) -> Path:
    """A file that a scene names from its own folder.

    Raises:
        UserError: the name is empty, or of no file.
    """
    if not name.strip():
        raise UserError('"": must not be empty: name a CSV file')
    path = folder / name
    if not path.exists():
        raise UserError(f"{path}: no such file; its path begins at the folder of the scene")
    return path


def read_text(path: Path, refused: type[UserError] = UserError) -> str:
    """The text of a file in UTF-8, with or without a byte-order mark.

    Raises:
        refused: the file cannot be read, or is not UTF-8.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise refused(f"{path}: cannot be read: {error.strerror or error}") from error
    if what := _kind_of(content):
        raise refused(f"{path}: {what}")
    zero = content.find(b"\0")
    if zero >= 0 and not content.startswith(_UTF_16):
        line = content.count(b"\n", 0, zero) + 1
        raise refused(f"{path}: line {line}: a zero byte; save the file as UTF-8 text")
    try:
        return content.decode("utf-8-sig")  # editors on Windows put a byte-order mark first
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise refused(
            f"{path}: line {line}: byte 0x{content[error.start]:02x} is not UTF-8; "
            "save the file as UTF-8 text"
        ) from error


def _kind_of(content: bytes) -> str:
    """What a file that is not text is, and what to do with it; empty where that is not known."""
    if content.startswith(_OLD_OFFICE):
        return "an Excel workbook (.xls): save it as CSV"
    if not content.startswith(_ZIP):
        return ""
    if b"application/vnd.oasis.opendocument.spreadsheet" in content[:200]:
        return "an OpenDocument spreadsheet (.ods): save it as CSV"
    if b"xl/workbook" in content:  # names of a zip's files are not compressed
        return "an Excel workbook (.xlsx): save it as CSV"
    if b"modelDescription.xml" in content:
        return "an FMU, not a text file"
    return "a zip archive, not a text file"


class CsvRow(NamedTuple):
    """A line of a CSV file.

    Attributes:
        place: file and line, for messages.
        cells: text by the column's name.
        has_decimal_commas: whether the file writes 0,5 for 0.5.
    """

    place: str
    cells: dict[str, str]
    has_decimal_commas: bool

    def number(self, name: str) -> float:
        """The number in a column.

        Raises:
            UserError: it is none, or has a point in a file with decimal commas, where 3.000 may
                mean 3000.
        """
        text, mark = self.cells.get(name, ""), "," if self.has_decimal_commas else "."
        try:
            if self.has_decimal_commas and "." in text:
                raise ValueError
            return float(text.replace(mark, "."))
        except ValueError:
            comma = " with a decimal comma, as others in this file" * self.has_decimal_commas
            raise UserError(f"{self.place}: {name} = {text!r}: must be a number{comma}") from None


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def read_csv(path: Path) -> tuple[list[str], list[CsvRow]]:
    """Names of the columns, and the lines; empty lines and those that begin with # are left out.

    Cells are separated by commas, semicolons or tabs; in the last two cases numbers can have
    decimal commas, as German spreadsheets write them.

    Raises:
        UserError: the file cannot be read, has no lines below the names, a name twice, or a line
            of another length than the names.
    """
    import csv  # few scenes name such a file

    lines = read_text(path).splitlines()
    told = _TELLS_SEPARATOR.fullmatch(lines[0]) if lines else None
    if told:
        lines[0] = ""
    # names, unlike numbers, have no commas
    head = next((line for line in lines if line.strip() and line[0] != "#"), "")
    separator = told[1] if told else max(_SEPARATORS, key=head.count)
    reader = csv.reader(lines, delimiter=separator, skipinitialspace=True)
    try:
        found = [(reader.line_num, [cell.strip() for cell in row]) for row in reader]
    except csv.Error as error:
        raise UserError(f"{path}, line {reader.line_num}: {error}") from error
    found = [(number, row) for number, row in found if any(row) and row[0][:1] != "#"]
    if len(found) < 2:
        raise UserError(f"{path}: needs a line with names of columns, and below it lines of values")
    names = found[0][1]
    while not names[-1]:  # columns that a spreadsheet has left empty
        names.pop()
    if all(_is_number(name) for name in names):
        raise UserError(
            f"{path}, line {found[0][0]}: {', '.join(names)}: must be names of columns, such as "
            "time [s]: write a line with them above the numbers"
        )
    if twice := {name for name in names if names.count(name) > 1}:
        raise UserError(f"{path}: {', '.join(sorted(twice))}: given twice")
    cells = [cell for _, row in found[1:] for cell in row]
    commas = separator != "," and any(re.fullmatch(_DECIMAL_COMMA, cell) for cell in cells)
    rows = []
    for number, row in found[1:]:
        place = f"{path}, line {number}"
        if len(row) < len(names) or any(row[len(names) :]):
            raise UserError(
                f"{place}: must have as many cells as there are names, {len(names)}; has {len(row)}"
            )
        rows.append(CsvRow(place, dict(zip(names, row, strict=False)), commas))
    return names, rows
