"""What the native units are compiled for, and with which options of the compiler."""

from __future__ import annotations

from dataclasses import dataclass

# no contraction to fused multiply-add: the same bits on every processor; sqrt an instruction
FLAGS = ("-std=c99", "-ffp-contract=off", "-fno-math-errno")
# where steps spend their time, for speed, with less put in line than usual, which keeps the wheel
# within its size; what takes a part of it, for size with little put in line: it is no slower; all
# else, for the least size (zig takes -Oz alone for -Os)
FAST = ("-O2", "-mllvm", "-inline-threshold=25")
SMALL = ("-Os", "-mllvm", "-inline-threshold=5")
SMALLEST = ("-Os", "-Xclang", "-Oz")
HOT = ("rotor/propagator", "weights/quintic_weights", "weights/weights")
WARM = (
    *("base/elementary", "base/failure", "base/matrix", "base/quintic", "base/signals"),
    *("contact/centre", "contact/pulse", "contact/reaction_change", "coupling/iterated"),
    *("coupling/signals", "rotor/friction", "units/angle", "units/rotor_step", "units/weights"),
    *("wasm/memory", "wasm/page", "weights/liquid", "windows/entry"),
)
WARNINGS = ("-Wall", "-Wextra", "-Wpedantic")
# macOS headers would call checking variants of memcpy; without loops unrolled or made into vectors
# a library is a tenth smaller, and no slower
_LOOPS = ("-fno-unroll-loops", "-fno-vectorize", "-fno-slp-vectorize")
OBJECT = ("-fPIC", "-fvisibility=hidden", "-D_FORTIFY_SOURCE=0", *_LOOPS)
# nothing unwinds the stack of C; Windows wants its tables, and with them needs no frame pointers
_NO_TABLES = ("-fno-asynchronous-unwind-tables", "-fno-unwind-tables")
_NO_FRAMES = ("-fomit-frame-pointer",)
_LINUX = (*_NO_TABLES, *_NO_FRAMES)
LINK = ("-nostdlib", "-s")
_SHARED = ("-shared",)
# else the path of the output would stand in the library, and the names of all functions
_NAMES = ("-Wl,-install_name,@rpath/autobalancer.dylib", "-Wl,-x")
_MACOS = (_NO_TABLES, (*_SHARED, *_NAMES))


@dataclass(frozen=True)
class Platform:
    """How a library is made.

    Attributes:
        target: name that zig has for the platform, with the oldest system it serves.
        library: file name.
        compiler, link: further options of either.
        folder: of sources for it alone.
    """

    target: str
    library: str
    compiler: tuple[str, ...] = ()
    link: tuple[str, ...] = _SHARED
    folder: str = ""


# by their names in FMI 3.0
PLATFORMS = {
    "x86_64-linux": Platform("x86_64-linux-gnu.2.17", "autobalancer.so", _LINUX),
    "aarch64-linux": Platform("aarch64-linux-gnu.2.17", "autobalancer.so", _LINUX),
    "x86_64-windows": Platform(
        "x86_64-windows-gnu", "autobalancer.dll", _NO_FRAMES, folder="windows"
    ),
    "x86_64-darwin": Platform("x86_64-macos.11.0", "autobalancer.dylib", *_MACOS),
    "aarch64-darwin": Platform("aarch64-macos.11.0", "autobalancer.dylib", *_MACOS),
}
# a function of the page's calls each; of WASI only its headers
PAGE = "wasm32"
_PAGE = Platform(
    "wasm32-wasi",
    "autobalancer.wasm.xz",
    ("-fno-pic",),
    ("-Wl,--no-entry", "-Wl,-z,stack-size=1048576"),
    "wasm",
)
TARGETS = {**PLATFORMS, PAGE: _PAGE}
