"""Tables that spreadsheets of any country write are read alike; what is not clear is refused."""

import csv
import io

import numpy as np
import pytest

from autobalancer.harness import UserError, load_scene
from autobalancer.harness.balancing import measured as balancing
from autobalancer.harness.fit import measured as fit
from autobalancer.harness.input_files import read_csv

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
        ("a,b\n1,2 \xb5m\n".encode("latin-1"), "line 2: byte 0xb5 is not UTF-8; save the file as"),
    ],
)
def test_what_is_no_table_of_numbers_is_refused_with_its_line(tmp_path, text, said):
    path = tmp_path / "wrong.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(UserError, match=said):
        _ = [row.number(name) for names, rows in [read_csv(path)] for row in rows for name in names]


def test_columns_that_a_spreadsheet_leaves_empty_are_none(tmp_path):
    path = tmp_path / "wide.csv"
    path.write_text("a;b;;\n1;2;;\n")
    names, rows = read_csv(path)
    assert names == ["a", "b"]
    assert [row.cells for row in rows] == [{"a": "1", "b": "2"}]
