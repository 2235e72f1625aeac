"""The sources that an FMU contains are C99 that Microsoft's compiler accepts.

That compiler does not run here.  Clang parses them for its target instead, with its language mode,
its headers of intrinsics and, of the C library, declarations of what the sources use.
"""

from __future__ import annotations

import importlib.util
import subprocess
from pathlib import Path

import pytest

from autobalancer.fmus.native.build.compile import SOURCE, one_source

pytest.importorskip("ziglang", reason="no compiler: ziglang is not installed")

_HEADERS = {
    "math.h": "double sqrt(double); double fabs(double); double copysign(double, double);\n"
    "#define INFINITY ((float)(1e300 * 1e300))\n#define NAN (-(float)(INFINITY * 0.0F))\n",
    "malloc.h": "",
    "stdlib.h": "#include <stddef.h>\nvoid *calloc(size_t, size_t); void free(void *);\n"
    "void *malloc(size_t);\n",
    "stdio.h": "#include <stddef.h>\ntypedef struct FILE FILE;\n"
    "FILE *fopen(const char *, const char *); int fclose(FILE *);\n"
    "FILE *_wfopen(const unsigned short *, const unsigned short *);\n"
    "size_t fread(void *, size_t, size_t, FILE *);\n",
    "string.h": "#include <stddef.h>\nvoid *memcpy(void *, const void *, size_t);\n"
    "void *memmove(void *, const void *, size_t); void *memset(void *, int, size_t);\n"
    "int memcmp(const void *, const void *, size_t); size_t strlen(const char *);\n"
    "int strcmp(const char *, const char *);\n"
    "int strncmp(const char *, const char *, size_t);\n",
}


@pytest.mark.parametrize("processor", ["x86_64", "aarch64"])
def test_microsofts_language_accepts_the_sources(processor, tmp_path):
    found = importlib.util.find_spec("ziglang").submodule_search_locations[0]
    (tmp_path / SOURCE).write_text(one_source(), encoding="utf-8")
    for name, text in _HEADERS.items():
        (tmp_path / name).write_text(text, encoding="ascii")
    command = [str(Path(found, "zig")), "clang", "-cc1", "-triple", f"{processor}-pc-windows-msvc"]
    command += [
        "-fms-compatibility",
        "-fms-extensions",
        "-std=c99",
        "-pedantic",
        "-Wall",
        "-Werror",
    ]
    command += ["-Wno-unknown-pragmas", "-fsyntax-only", "-nostdsysteminc"]
    command += ["-isystem", ".", "-isystem", str(Path(found, "lib", "include")), SOURCE]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert not done.returncode, done.stderr


def test_the_sources_use_no_extension_of_other_compilers():
    """Clang accepts these for its Microsoft target too; Microsoft's compiler does not."""
    text = one_source()
    exported = '#define EXPORT __attribute__((visibility("default")))'  # not for Microsoft's
    assert exported in text
    text = text.replace(exported, "")
    for word in ("__attribute__", "__builtin_", "__extension__", "typeof", "vector_size"):
        assert word not in text, word
