"""Tables that spreadsheets of any country write are read alike; what is not clear is refused."""

import csv
import io
import zipfile

import numpy as np
import pytest

from autobalancer.harness import UserError, load_scene
from autobalancer.harness.balancing import measured as balancing
from autobalancer.harness.fit import measured as fit
from autobalancer.harness.input_files import read_csv
from autobalancer.harness.measurements import Known, read_measurements

AMPLITUDES = [["speed [rpm]", "amplitude [mm]"], ["1100.5", "4.55e-2"], ["3", ""]]
READINGS = [
    ["run", "sensor", "amplitude_um", "phase_lag_deg", "mass_g[1]", "angle_deg[1]"],
    ["as found, cold", "front", "1.5", "30", "", ""],
    ["trial", "front", "2.25", "31.5", "3.5", "0"],
]


def written(path, table, separator, decimal, ends="\n", before="", after=""):
    """A table as a spreadsheet writes it."""
    text = io.StringIO()
    writer = csv.writer(text, delimiter=separator, lineterminator="\n")
    writer.writerow([cell + after for cell in table[0]])
    writer.writerows([[cell.replace(".", decimal) for cell in row] for row in table[1:]])
    path.write_bytes((before + text.getvalue()).replace("\n", ends).encode())
    return path


FORMS = {
    "english": (",", "."),
    "german": (";", ","),
    "german, tabs": ("\t", ","),
    "tabs": ("\t", "."),
    "byte-order mark and Windows": (";", ",", "\r\n", "\ufeff"),
    "the separator in the first line": (";", ",", "\r\n", "sep=;\n"),
    "comment and empty line above": (";", ",", "\n", "# rig 3, bearing 2\n\n"),
    "spaces": (";", ",", "\n", "", " "),
}


@pytest.mark.parametrize("form", FORMS.values(), ids=FORMS)
def test_measurements_are_read_alike_in_every_form(tmp_path, form):
    path = tmp_path / "measured.csv"
    found = fit.read_measured(written(path, AMPLITUDES, *form), load_scene("two_balls"))
    np.testing.assert_allclose(found.settings["speed"] * 30.0 / np.pi, [1100.5, 3.0])
    np.testing.assert_allclose(found.amplitudes["amplitude"], [4.55e-5, np.nan])
    runs = balancing.read_measured(written(path, READINGS, *form))
    assert runs.runs == ("as found, cold", "trial")
    phases = np.radians([[-30.0], [-31.5]])
    np.testing.assert_allclose(runs.responses, [[1.5], [2.25]] * np.exp(1j * phases))
    np.testing.assert_allclose(runs.mounted, [[0.0], [3.5]])


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("a;b\n0,5;1.000\n", "line 2: b = '1.000': must be a number with a decimal comma, as"),
        ("a;b\n0,5;x\n", "line 2: b = 'x': must be a number"),
        ("# no\na,b\n\n1,2,3\n", "line 4: must have as many cells as there are names, 2; has 3"),
        ("a,b\n", "needs a line with names of columns, and below it lines of values"),
        ("", "needs a line with names of columns"),
        ("a,a\n1,2\n", "a: given twice"),
        ("\n0,0\n1,2\n", "line 2: 0, 0: must be names of columns, such as time"),
        ("a,b\n1,\0002\n", "line 2: a zero byte; save the file as UTF-8 text"),
        ("a,b\n1,2\n".encode("utf-16-le"), "line 1: a zero byte; save the file as UTF-8 text"),
        ("a,b\n1,2\n".encode("utf-16"), "line 1: byte 0x.. is not UTF-8; save the file as"),
        ("a,b\n1,2 \xb5m\n".encode("latin-1"), "line 2: byte 0xb5 is not UTF-8; save the file as"),
    ],
)
def test_what_is_no_table_of_numbers_is_refused_with_its_line(tmp_path, text, said):
    path = tmp_path / "wrong.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(UserError, match=said):
        _ = [row.number(name) for names, rows in [read_csv(path)] for row in rows for name in names]


@pytest.mark.parametrize("text", ["1e308", "-1e61", "1e-300"])
def test_a_number_that_no_equation_could_square_is_refused_with_its_line(tmp_path, text):
    path = tmp_path / "measured.csv"
    path.write_text(f"speed [rad/s]\n3\n{text}\n")
    with pytest.raises(UserError, match=f"line 3: .* = {text}: must be 0, or from 1e-60 to 1e"):
        _first_column(path, [Known("speed", ("rad/s",))])


def test_columns_that_a_spreadsheet_leaves_empty_are_none(tmp_path):
    path = tmp_path / "wide.csv"
    path.write_text("a;b;;\n1;2;;\n")
    names, rows = read_csv(path)
    assert names == ["a", "b"]
    assert [row.cells for row in rows] == [{"a": "1", "b": "2"}]


def _first_column(path, known):
    table = read_measurements(path, known)
    return table.numbers(table.columns[0])


@pytest.mark.parametrize(
    ("heads", "value", "cell"),
    [
        ("amplitude [mil pp]", 0.5 * 2.54e-5, "1"),
        ("amplitude_um_rms", 2.0**0.5 * 1e-6, "1"),
        ("amplitude (mm 0-peak)", 1e-3, "1"),
        ("amplitude [mm]", 0.5 * 2.54e-5, "1 mil pp"),
        ("amplitude", 2.54e-5, "1 mils"),
        ("speed [Hz]", 2.0 * np.pi, "1"),
        ("speed", np.pi / 30.0, "1 rpm"),
        ("mass[a] [oz]", 0.028349523125, "1"),
        ("mass_oz[drive end]", 0.028349523125, "1"),
        ("mass [lb]", 0.45359237, "1"),
        ("mass[a]", 0.1000738, "3.53 oz"),
        ("mass[a]", 1e-3, "1e0 g"),
        ("unbalance [oz-in]", 0.000720077887375, "1"),
    ],
)
def test_units_in_heads_and_cells_are_those_of_the_field(tmp_path, heads, value, cell):
    known = [
        Known("amplitude", ("m",), is_size=True),
        Known("speed", ("rad/s",)),
        Known("mass", ("kg",), per_plane=True),
        Known("unbalance", ("kg m",)),
    ]
    path = tmp_path / "table.csv"
    path.write_text(f"{heads}\n{cell}\n")
    assert _first_column(path, known) == pytest.approx([value], rel=1e-6)


@pytest.mark.parametrize(
    ("head", "cell", "said"),
    [
        ("mass[a]", "1", r"line 2: mass\[a\] = '1': has no unit: .* such as `mass\[a\] \[g\]`"),
        ("mas[a] [g]", "1", r"mas\[a\] .*: unknown column .did you mean mass\[a\]"),
        ("mass[oz]", "1", "is oz the unit or the plane"),
        ("mass_grm[a]", "1", "unknown unit 'grm'"),
        ("mass [mm]", "1", r"mass \[mm\]: a mass is expected: name the column `mass \[g\]`"),
        ("mass [g]", "3 mm", "line 2: .* = '3 mm': a mass is expected"),
        ("mass [g]", "nan", "must be a finite number"),
        ("mass_g[a] [oz]", "1", "has two units, g and oz"),
        ("weight [g]", "1", "unknown column; allowed: mass"),
        ("rpm", "1", r"did you mean speed \[rpm\]"),
        ("size [um pp rms]", "1", "unit 'um pp rms': must have one of pp"),
        ("size [pp]", "1", "unknown unit 'pp': write the unit of length"),
        (
            "amplitude",
            "1 um\n2 mm/s",
            "line 3: amplitude = .2 mm/s.: must be in m, or a unit",
        ),
        ("amplitude [um]", "1\n2 mm/s", "line 3: amplitude .um. = '2 mm/s': must be in m"),
    ],
)
def test_heads_and_cells_that_are_not_clear_are_refused(tmp_path, head, cell, said):
    path = tmp_path / "table.csv"
    path.write_text(f"{head}\n{cell}\n")
    with pytest.raises(UserError, match=said):
        _first_column(
            path,
            [
                Known("mass", ("kg",), per_plane=True),
                Known("speed", ("rad/s",)),
                Known("size", ("m",), is_size=True),
                Known("amplitude", ("m", "m/s"), is_size=True),
            ],
        )


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ({"xl/workbook.xml": ""}, r"an Excel workbook \(.xlsx\): save it as CSV"),
        (
            {"mimetype": "application/vnd.oasis.opendocument.spreadsheet"},
            "an OpenDocument spreadsh",
        ),
        ({"modelDescription.xml": ""}, "an FMU, not a text file"),
        ({"a.txt": ""}, "a zip archive"),
        (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(500), r"an Excel workbook \(.xls\): save it"),
    ],
)
def test_files_that_are_no_text_are_named(tmp_path, content, said):
    path = tmp_path / "table.csv"
    if isinstance(content, bytes):
        path.write_bytes(content)
    else:
        with zipfile.ZipFile(path, "w") as archive:
            for name, text in content.items():
                archive.writestr(name, text)
    with pytest.raises(UserError, match=said):
        read_csv(path)


def test_a_runout_is_subtracted_in_balancing_and_may_stand_in_one_line(tmp_path):
    """10 at 20 deg less 1 at 45 deg, in another unit and counted the other way."""
    path = tmp_path / "runs.csv"
    path.write_text(
        "run,sensor,amplitude [mil pp],phase_lag [deg],mass[a] [oz],angle[a] [deg],"
        "slow_roll [um pp],slow_roll_phase_lead [deg],note\n"
        "as found,A,10,20,,,25.4,-45,cold\ntrial,A,8,300,3.53 oz,90,,,\n"
    )
    runs = balancing.read_measured(path)
    phase = np.exp(-1j * np.radians([20.0, 300.0]))
    expected = np.array([10.0, 8.0]) * phase - np.exp(-1j * np.radians(45.0))
    np.testing.assert_allclose(runs.responses[:, 0], expected)
    assert runs.unit == "mil pp"
    np.testing.assert_allclose(runs.mounted[:, 0], [0.0, 100.0738j], rtol=1e-6)
