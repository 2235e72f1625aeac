"""What the native units are compiled for, and with which options of the compiler."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from platform import machine

# no contraction to fused multiply-add: the same bits on every processor; sqrt an instruction.  With
# less put in line than usual, and no loops unrolled or made into vectors, a library is a quarter
# smaller.  macOS headers would call checking variants of memcpy
COMPILE = (
    *("-std=c99", "-ffp-contract=off", "-fno-math-errno", "-Wall", "-Wextra", "-Wpedantic"),
    "-Wno-unused-parameter",  # signatures are those of FMI or of a table
    "-Wno-unused-function",  # a text has functions for others; a test looks at all of them
    *("-O2", "-mllvm", "-inline-threshold=30"),
    *("-fno-unroll-loops", "-fno-vectorize", "-fno-slp-vectorize"),
    *("-fPIC", "-fvisibility=hidden", "-D_FORTIFY_SOURCE=0", "-g0"),
    "-ffunction-sections",  # the linker leaves out what nobody calls: lanes have much of that
)
# the series of machines and their steps, where the time goes: in line and unrolled what pays.
# Files, and folders with all that is in them; an entry without a file is refused (compile.py)
FAST = (
    "base/elementary.c",
    *(f"coupling/one_piece_{n}.c" for n in ("series", "show", "smooth", "sources", "stand")),
    *(f"coupling/{n}.c" for n in ("one_piece_step", "one_piece_stiff", "smooth_alone")),
    "machine/",
)
_IN_LINE = ("-mllvm", "-inline-threshold=225")
_ALWAYS = ("-DIN_LINE=__attribute__((always_inline))",)
# loops over few stations alone, whose number is known: of at most three stations two axes
_UNROLL = (
    "-funroll-loops",
    "-mllvm",
    "-unroll-runtime=false",
    "-mllvm",
    "-unroll-allow-partial=false",
    "-mllvm",
    "-unroll-full-max-count=6",
)
FAST_COMPILE = (*_IN_LINE, *_ALWAYS, *_UNROLL)
# copies of the recurrence and machines side by side, in lanes; for x86-64 once more with vectors
# that only newer processors have
COPIES_COMPILE = (*_IN_LINE, *_ALWAYS, *_UNROLL, "-Wno-psabi")
LANES_COMPILE = (*COPIES_COMPILE, "-DSIDE_BY_SIDE")
WIDE_COMPILE = ("-mavx2", "-DWIDE_VECTORS")
# nothing unwinds the stack of C; Windows wants its tables, and with them needs no frame pointers
_NO_TABLES = ("-fno-asynchronous-unwind-tables", "-fno-unwind-tables")
_NO_FRAMES = ("-fomit-frame-pointer",)
_LINUX = (*_NO_TABLES, *_NO_FRAMES)
LINK = ("-nostdlib", "-s")
_SHARED = ("-shared", "-Wl,--gc-sections")
# else the path of the output would stand in the library.  Names of functions stay: zig's linker
# leaves memory it never wrote in the file where they are left out
_MACOS = (_NO_TABLES, ("-shared", "-Wl,-dead_strip", "-Wl,-install_name,@rpath/autobalancer.dylib"))

_WINDOWS = (*_SHARED, "-Wl,-Brepro")  # else the time of linking would stand in the library


@dataclass(frozen=True)
class Platform:
    """How a library is made.

    Attributes:
        target: name that zig has for the platform, with the oldest system it serves.
        library: file name.
        compiler, link: further options of either.
        folder: of sources for it alone.
        lanes: whether machines of a batch go on side by side, in vectors.
    """

    target: str
    library: str
    compiler: tuple[str, ...] = ()
    link: tuple[str, ...] = _SHARED
    folder: str = ""
    lanes: bool = True

    @property
    def wide(self) -> bool:
        """Whether there are processors with wider vectors that the library makes use of."""
        return self.lanes and self.target.startswith("x86_64")


# by their names in FMI 3.0
PLATFORMS = {
    "x86_64-linux": Platform("x86_64-linux-gnu.2.17", "autobalancer.so", _LINUX),
    "aarch64-linux": Platform("aarch64-linux-gnu.2.17", "autobalancer.so", _LINUX),
    "x86_64-windows": Platform(
        "x86_64-windows-gnu", "autobalancer.dll", _NO_FRAMES, _WINDOWS, "windows"
    ),
    "x86_64-darwin": Platform("x86_64-macos.11.0", "autobalancer.dylib", *_MACOS),
    "aarch64-darwin": Platform("aarch64-macos.11.0", "autobalancer.dylib", *_MACOS),
}
# a function of the page's calls each; of WASI only its headers
PAGE = "wasm32"
_PAGE = Platform(
    "wasm32-wasi",
    "autobalancer.wasm",
    ("-fno-pic",),
    ("-Wl,--no-entry", "-Wl,-z,stack-size=1048576"),
    "wasm",
    lanes=False,
)
TARGETS = {**PLATFORMS, PAGE: _PAGE}


def present_platform() -> str:
    """The platform that this process runs on, as FMI 3.0 names it, whether there is one or not."""
    system = sys.platform.replace("win32", "windows").rstrip("0123456789")
    known = machine().lower()
    if known in ("arm64", "aarch64"):
        return f"aarch64-{system}"
    if known in ("amd64", "x86_64", "i386", "i686", "x86"):
        return f"x86_64-{system}" if sys.maxsize > 2**32 else f"x86-{system}"
    return f"{known}-{system}"
