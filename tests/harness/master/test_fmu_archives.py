"""Archives of units that lead elsewhere, or that have no room."""

from __future__ import annotations

import errno
import shutil
import tempfile
import zipfile

import pytest
from typer.testing import CliRunner

from autobalancer.harness.__main__ import program
from autobalancer.harness.errors import UnitError
from autobalancer.harness.master.fmu import Fmu


@pytest.fixture
def damaged(fmus, tmp_path):
    """A unit with a further file of this name in it."""

    def made(name):
        path = shutil.copy(fmus.native("LiquidBalancer"), tmp_path / "liquid.fmu")
        with zipfile.ZipFile(path, "a") as archive:
            archive.writestr(name, "")
        return path

    return made


@pytest.mark.parametrize("name", ["/etc/elsewhere", "C:/elsewhere"])
def test_a_file_that_leads_out_of_the_folder_is_refused(damaged, name):
    with pytest.raises(UnitError, match=r"liquid\.fmu: cannot be unpacked: Illegal path"):
        Fmu(damaged(name), "liquid")


def test_a_full_disk_is_named_with_its_place(damaged, monkeypatch):
    def full(*_, **__):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("fmpy.extract", full)
    with pytest.raises(UnitError, match=r"into /.*autobalancer-.*: No space left .*TMPDIR"):
        Fmu(damaged("more"), "liquid")


def test_a_full_disk_that_names_no_file_is_told_where_to_look(monkeypatch):
    def full(*_, **__):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("autobalancer.harness.master.fmu.mkdtemp", full)
    done = CliRunner().invoke(program(), ["run", "two_balls", "--separate", "--quiet"])
    said = " ".join(done.output.split())
    assert done.exit_code == 2
    assert f"No space left on device: in {tempfile.gettempdir()}, where temporary files are" in said
