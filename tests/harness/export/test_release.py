"""The archive of a release."""

import hashlib
import io
import zipfile

import pytest
from fmpy import platform_tuple
from fmpy.validation import validate_fmu

from autobalancer.harness.errors import UserError
from autobalancer.harness.export import release
from autobalancer.harness.export.release import CHECKSUMS, build_release


def test_a_release_is_the_same_bytes_twice_and_its_checksums_are_those_of_its_files(tmp_path):
    form = {"platforms": [platform_tuple], "scenes": ["two_balls", "drum", "sommerfeld"]}
    first, again = (build_release(tmp_path / k, **form) for k in ("first", "again"))
    data = first.files[0].read_bytes()
    assert data == again.files[0].read_bytes()
    assert [why.split(":")[0] for why in first.left_out] == ["sommerfeld"]
    assert first.rows[0][1] == hashlib.sha256(data).hexdigest()
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        lines = archive.read(CHECKSUMS).decode().splitlines()
        sums = {path: total for total, path in (line.split("  ") for line in lines)}
        assert set(sums) == set(archive.namelist()) - {CHECKSUMS}
        for path, total in sums.items():
            assert hashlib.sha256(archive.read(path)).hexdigest() == total
        archive.extractall(tmp_path / "all")
    for name in ("drum", "two_balls"):
        folders = ("ssp", "ssp/separate_units")
        assert {f"fmi{k}/scenes/{name}.fmu" for k in (2, 3)} <= set(sums)
        assert {f"{folder}/{name}.ssp" for folder in folders} <= set(sums)
        assert validate_fmu(str(tmp_path / f"all/fmi3/scenes/{name}.fmu")) == []


def test_a_place_that_takes_no_release_is_refused_before_anything_is_built(tmp_path, monkeypatch):
    monkeypatch.setattr(release, "build_files", pytest.fail)
    (tmp_path / "file").write_text("")
    with pytest.raises(UserError, match=r"file is a file, not a directory"):
        build_release(tmp_path / "file")
