"""Units and composites in a host in plain C: `host/host.c` says what it demands."""

from __future__ import annotations

import re
import shutil
import subprocess

import pytest

from tests.studies.host import COMPOSITES, UNITS, compiled, run

pytestmark = pytest.mark.slow

NOTHING_WRONG = f"{len(UNITS) + len(COMPOSITES)} units, 0 failures\n"


def test_a_plain_host_finds_nothing_wrong(fmus, tmp_path):
    place = tmp_path / "Jörg (1) + [x] 'y' %s#"
    place.mkdir()
    done = run(compiled(tmp_path), shutil.copy(fmus.library, place), 300, 4)
    assert (done.returncode, done.stderr, done.stdout) == (0, "", NOTHING_WRONG)


def test_sanitizers_find_nothing_either(packaging, tmp_path):
    flags = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-g1"]
    library = packaging.compile_units(tmp_path / "sanitized", *flags, "-O0")
    done = run(compiled(tmp_path, *flags), library, 30, 4, ASAN_OPTIONS="detect_leaks=1")
    assert (done.returncode, done.stderr, done.stdout) == (0, "", NOTHING_WRONG)


def test_the_library_has_no_state_of_its_own(fmus):
    """Instances in any number of threads share constants alone."""
    table = subprocess.run(
        ["objdump", "-h", str(fmus.library)], capture_output=True, text=True, check=True
    ).stdout
    sections = set(re.findall(r"^ +\d+ (\S+)", table, re.MULTILINE))
    assert ".rodata" in sections
    assert not sections & {".data", ".bss", ".tdata", ".tbss"}
