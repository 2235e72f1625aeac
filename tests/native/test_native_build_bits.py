"""One run has the same bits on glibc, musl, arm64 (under qemu-user) and Windows (under wine).

A host in plain C (host/runner.c) couples units and prints every output of every step as its bits.
It is compiled here for each machine, without a C run-time library, like the units themselves.
"""

from __future__ import annotations

import math
import os
import platform
import shutil
import struct
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from autobalancer.fmus.catalogue import sized_unit
from autobalancer.fmus.native.build.compile import SOURCES, libraries, stamp
from autobalancer.fmus.native.build.layout import token
from autobalancer.harness import load_scene
from autobalancer.harness.master.one_file import composition

pytest.importorskip("ziglang", reason="no compiler: ziglang is not installed")

HOST = Path(__file__).parent / "host"
STEPS = 60
STEP = 2.0**-11

# what the host calls; a library of these names stands in for the C library when it is linked
_C_LIBRARY = ("_exit", "dlopen", "dlsym", "memcpy", "memset", "read", "strlen", "write")
_KERNEL32 = (
    "ExitProcess", "GetProcAddress", "GetStdHandle", "LoadLibraryA", "ReadFile", "WriteFile",
)  # fmt: skip


# --- machines ---------------------------------------------------------------------------------


@dataclass(frozen=True)
class Machine:
    """Where a run is repeated.

    Attributes:
        platform: whose library it loads.
        command: what runs the host, before the host's path.
        needs: files it needs, and the Debian package they come from.
    """

    platform: str
    command: tuple[str, ...]
    needs: dict[str, str]

    def missing(self) -> str:
        absent = [p for file, p in self.needs.items() if not (shutil.which(file) or _there(file))]
        return ", ".join(absent)


def _there(file: str) -> bool:
    return Path(file).exists()


_MUSL = f"/lib/ld-musl-{platform.machine()}.so.1"
_ARM = "/usr/aarch64-linux-gnu"
_HERE = f"{platform.machine().replace('arm64', 'aarch64')}-linux"
MACHINES = {
    "glibc": Machine(_HERE, (), {}),
    "musl": Machine(_HERE, (_MUSL,), {_MUSL: "musl"}),
    "arm64": Machine(
        "aarch64-linux",
        ("qemu-aarch64-static", "-L", _ARM),
        {"qemu-aarch64-static": "qemu-user-static", f"{_ARM}/lib": "libc6-arm64-cross"},
    ),
    "windows": Machine(
        "x86_64-windows", ("wine",), {"wine": "wine", "/usr/lib/wine/wine64": "wine64"}
    ),
}

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        not sys.platform.startswith("linux"), reason="the other machines are emulated on Linux"
    ),
]


@pytest.fixture(scope="module")
def hosts(tmp_path_factory):
    """Compile the host for a platform, once."""
    folder = tmp_path_factory.mktemp("hosts")
    made: dict[str, Path] = {}

    def host(name: str) -> Path:
        if name not in made:
            made[name] = _windows_host(folder) if "windows" in name else _linux_host(folder, name)
        return made[name]

    return host


def _zig(folder: Path, *arguments: object) -> None:
    caches = {
        name: str(folder / "cache") for name in ("ZIG_GLOBAL_CACHE_DIR", "ZIG_LOCAL_CACHE_DIR")
    }
    command = [sys.executable, "-m", "ziglang", *map(str, arguments)]
    subprocess.run(command, check=True, env={**os.environ, **caches}, cwd=folder)


def _objects(folder: Path, target: str, system: str) -> list[Path]:
    made = []
    for name in ("runner", system):
        made.append(folder / f"{name}-{target}.o")
        options = ("-std=c99", "-O1", "-g0", "-fno-stack-protector", "-Wall", "-Wextra", "-Werror")
        _zig(folder, "cc", "-target", target, *options, "-c", HOST / f"{name}.c", "-o", made[-1])
    return made


def _linux_host(folder: Path, name: str) -> Path:
    target = (
        f"{name}-gnu.2.34"  # dlopen is in libc itself since then; musl calls itself libc as well
    )
    stand_in = folder / f"libc-{name}.so"
    (folder / "libc.c").write_text("".join(f"void {name}(void) {{}}\n" for name in _C_LIBRARY))
    options = ("-shared", "-nostdlib", "-fPIC", "-fno-builtin", "-w", "-Wl,-soname,libc.so.6")
    _zig(folder, "cc", "-target", target, *options, "libc.c", "-o", stand_in)
    objects = _objects(folder, target, "system_linux")
    output = folder / f"runner-{name}"
    _zig(folder, "cc", "-target", target, "-nostdlib", "-pie", *objects, stand_in, "-o", output)
    return output


def _windows_host(folder: Path) -> Path:
    definition = folder / "kernel32.def"
    definition.write_text("\n".join(['LIBRARY "kernel32.dll"', "EXPORTS", *_KERNEL32, ""]))
    for file in (definition, SOURCES / "windows" / "msvcrt.def"):
        library = folder / f"{file.stem}.lib"
        _zig(folder, "dlltool", "-m", "i386:x86-64", "-d", file, "-l", library)
    target = "x86_64-windows-gnu"
    objects = _objects(folder, target, "system_windows")
    entry = ("-Wl,--subsystem,console", "-Wl,-e,mainCRTStartup")
    output = folder / "runner.exe"
    imports = (folder / "kernel32.lib", folder / "msvcrt.lib")
    _zig(folder, "cc", "-target", target, "-nostdlib", *objects, *imports, *entry, "-o", output)
    return output


@pytest.fixture(scope="module")
def wine(tmp_path_factory):
    """Environment with a Windows of its own, removed afterwards: it is large."""
    prefix = tmp_path_factory.mktemp("wine")
    environment = {**os.environ, "WINEPREFIX": str(prefix), "WINEDEBUG": "-all"}
    environment["WINEDLLOVERRIDES"] = "mscoree,mshtml="  # else it offers to download them
    yield environment
    subprocess.run(["wineserver", "-k"], env=environment, check=False)
    shutil.rmtree(prefix, ignore_errors=True)


@pytest.fixture
def outcome(hosts, request):
    """Run orders on a machine; what the host writes, a list of lines."""

    def outcome(name: str, orders: list[str]) -> list[str]:
        machine = MACHINES[name]
        if missing := machine.missing():
            pytest.skip(f"not installed: {missing}")
        environment = request.getfixturevalue("wine") if name == "windows" else dict(os.environ)
        library = str(libraries([machine.platform])[machine.platform])
        if name == "windows":
            library = "Z:" + library.replace("/", "\\")
        done = subprocess.run(
            [*machine.command, str(hosts(machine.platform))],
            input="\n".join([f"open {library}", *orders, ""]).encode(),
            stdout=subprocess.PIPE,
            env=environment,
            timeout=300,
        )
        lines = done.stdout.decode().replace("\r\n", "\n").splitlines()
        assert done.returncode == 0, lines[-3:]
        return lines

    return outcome


# --- orders -----------------------------------------------------------------------------------


class Orders:
    """Orders for the host: units by number, variables by name."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.layouts: list = []

    def new(self, unit: str, **options) -> int:
        """An instance of a unit, not initialised."""
        self.layouts.append(sized_unit(unit, **options).layout)
        number = len(self.layouts) - 1
        self.lines.append(f"new {number} {token(sized_unit(unit, **options), stamp())}")
        return number

    def set(self, unit: int, **values: float) -> None:
        for name, value in values.items():
            self.real(unit, name.replace("__", "."), value)

    def real(self, unit: int, name: str, value: float) -> None:
        self.lines.append(f"real {unit} {self.layouts[unit].index[name]} {_bits(value)}")

    def go(self, unit: int, time: float) -> None:
        self.lines.append(f"to {unit} {_bits(time)} {_bits(STEP)}")

    def connect(self, source: int, output: str, target: int, entry: str) -> None:
        index = (self.layouts[source].index[output], self.layouts[target].index[entry])
        self.lines.append(f"pass {source} {index[0]} {target} {index[1]} 1")

    def show(self, unit: int) -> None:
        """Every output."""
        reals = [i for i, v in enumerate(self.layouts[unit].reals) if v.causality == "output"]
        self.lines.append(f"show {unit} {reals[0]} {len(reals)}")


def _bits(value: float) -> str:
    return struct.pack(">d", value).hex()


def coupled(rotor_options: dict, balancers: list[tuple[str, dict]], acceleration: float, **values):
    """A rotor with a balancer on each plane, outputs handed on after every step."""
    orders = Orders()
    frame = rotor_options["frame"]
    xi, eta = ("xi", "eta") if frame == "rotor" else ("x", "y")
    rotor = orders.new("RotorOnSupports", **rotor_options)
    for name, value in values.items():
        orders.real(rotor, name, value)
    units = [orders.new(unit, frame=frame, **options) for unit, options in balancers]
    for unit, (kind, _) in zip(units, balancers, strict=True):
        if kind == "BallBalancer":
            orders.real(unit, "weight[1].angle0", 0.3)
    everyone = [rotor, *units]
    speed = 220.0

    def hand_on(k: int) -> None:
        now = speed + acceleration * k * STEP
        orders.real(rotor, "speed", now)
        orders.real(rotor, "acceleration", acceleration)
        for i, (unit, (kind, _)) in enumerate(zip(units, balancers, strict=True), 1):
            orders.connect(unit, "added_mass", rotor, f"plane[{i}].added_mass")
            for pattern in ("{}", "der({})"):
                for axis in (xi, eta):
                    a, force = pattern.format(f"plane[{i}].a_{axis}"), pattern.format(f"F_{axis}")
                    orders.connect(rotor, a, unit, pattern.format(f"a_{axis}"))
                    orders.connect(unit, force, rotor, pattern.format(f"plane[{i}].F_{axis}"))
            if kind == "BallBalancer":
                orders.real(unit, "speed", now)
                orders.real(unit, "acceleration", acceleration)
                orders.connect(rotor, "angle", unit, "angle")
            else:
                orders.connect(rotor, f"plane[{i}].x", unit, "x")
                orders.connect(rotor, f"plane[{i}].y", unit, "y")

    for unit in everyone:
        orders.lines.append(f"init {unit}")
    for k in range(STEPS):
        hand_on(k)
        for unit in everyone:
            orders.go(unit, k * STEP)
        for unit in everyone:
            orders.show(unit)
    orders.lines += [f"free {unit}" for unit in everyone]
    return orders.lines


_BALLS = ("BallBalancer", {"weights": 3})
_LIQUID = ("LiquidBalancer", {})
_DISC = {"stations": 1, "kind": "planar"}
_RIGID = {"stations": 2, "kind": "two_support", "planes": 2, "unbalances": 1}
_SHAFT = {"stations": 3, "kind": "flexible", "planes": 2, "unbalances": 2}
RUNS = {
    "planar": lambda w: coupled({"frame": "rotor", "planes": 1, **_DISC}, [_BALLS], w),
    "planar, anisotropic, along fixed axes": lambda w: coupled(
        {"frame": "fixed", "planes": 2, **_DISC}, [_BALLS, _LIQUID], w, stiffness_x=1.1e5
    ),
    "two supports": lambda w: coupled({"frame": "rotor", **_RIGID}, [_BALLS, _LIQUID], w),
    "uniform shaft": lambda w: coupled(
        {"frame": "rotor", "shaft": "uniform", **_SHAFT},
        [_BALLS, _LIQUID],
        w,
        internal_damping=0.3,
    ),
    "shaft by compliance": lambda w: coupled(
        {"frame": "fixed", "shaft": "compliance", **_SHAFT}, [_LIQUID, _BALLS], w
    ),
}


@pytest.mark.parametrize("acceleration", [0.0, 35.0], ids=["constant speed", "varying speed"])
@pytest.mark.parametrize("run", RUNS)
@pytest.mark.parametrize("machine", [name for name in MACHINES if name != "glibc"])
def test_a_coupled_run_has_the_bits_it_has_on_glibc(machine, run, acceleration, outcome):
    compared(machine, RUNS[run](acceleration), outcome)


@pytest.mark.parametrize("changes", [{}, {"tolerance": 1e-6}], ids=["fixed steps", "tolerance"])
@pytest.mark.parametrize("scene", ["two_balls", "goncharov_balls", "three_mass_shaft", "run_up"])
@pytest.mark.parametrize("machine", [name for name in MACHINES if name != "glibc"])
def test_a_composite_has_the_bits_it_has_on_glibc(machine, scene, changes, outcome):
    """Coupled inside, and read between the ends of its steps."""
    compared(machine, composite(scene, changes), outcome)


def composite(scene: str, changes: dict[str, float]) -> list[str]:
    """A scene's composite, some seven times a revolution."""
    loaded = load_scene(scene)
    scheme = "auto" if changes else loaded.coupling.scheme
    steps = {} if changes else {"coupling.steps_per_rev": 12}
    keys = {"coupling.scheme": scheme, "coupling.corrections": None, **steps}
    loaded = loaded.replace({**keys, **{f"coupling.{k}": v for k, v in changes.items()}})
    made = composition(loaded)
    orders = Orders()
    orders.layouts.append(made.described("Composite").layout)
    orders.lines += [f"new 0 {made.token(stamp())}", "init 0"]
    length = 2.0 * math.pi / (7.3 * max(loaded.profile().start, loaded.profile().end))
    for k in range(STEPS):
        orders.lines.append(f"to 0 {_bits(k * length)} {_bits(length)}")
        orders.show(0)
    return [*orders.lines, "free 0"]


def compared(machine: str, orders: list[str], outcome) -> None:
    """What a machine makes of orders, against glibc."""
    expected = outcome("glibc", orders)
    values = [
        struct.unpack(">d", bytes.fromhex(word))[0] for line in expected for word in line.split()
    ]
    # the run is one worth repeating: everything moves, nothing is lost
    assert all(map(math.isfinite, values))
    assert len(set(values)) > 0.4 * len(values)
    found = outcome(machine, orders)
    for number, (one, other) in enumerate(zip(expected, found, strict=True)):
        assert one == other, f"line {number}"
