"""One run has the same bits on glibc, musl, arm64 and older x86-64 (qemu-user), Windows (wine).

A host in plain C (host/runner.c) runs a scene's one file and prints the bits of every output after
every step.  It is compiled here for each machine, without a C library, like the units themselves.
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
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from autobalancer.fmus.native.build.compile import SOURCES, libraries, stamp
from autobalancer.fmus.native.build.tokens import bits
from autobalancer.harness import cosimulate, load_scene
from autobalancer.harness.master.one_file import composition

pytest.importorskip("ziglang", reason="no compiler: ziglang is not installed")

HOST = Path(__file__).parent / "host"
STEPS, PER_TURN = 60, 7.3  # of the host: in all, and per revolution

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
        there = {file for file in self.needs if shutil.which(file) or Path(file).exists()}
        return ", ".join(package for file, package in self.needs.items() if file not in there)


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
    "without AVX2": Machine(
        "x86_64-linux",
        ("qemu-x86_64-static", "-cpu", "Nehalem"),
        {"qemu-x86_64-static": "qemu-user-static", "/lib64/ld-linux-x86-64.so.2": "libc6"},
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
    return cache(
        lambda name: _windows_host(folder) if "windows" in name else _linux_host(folder, name)
    )


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
        options += (f"-I{SOURCES}", "-fno-strict-aliasing")
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
            input="\n".join([library, *orders, ""]).encode(),
            stdout=subprocess.PIPE,
            env=environment,
            timeout=3000,
        )
        lines = done.stdout.decode().replace("\r\n", "\n").splitlines()
        assert done.returncode == 0, lines[-3:]
        return lines

    return outcome


# --- orders -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("scene", "changes"),
    [
        *((scene, {}) for scene in ("goncharov_balls", "drum", "run_up")),
        *((scene, {"tolerance": 1e-6}) for scene in ("three_mass_shaft", "balls_and_liquid")),
    ],
)
@pytest.mark.parametrize("machine", [name for name in MACHINES if name != "glibc"])
def test_a_composite_has_the_bits_it_has_on_glibc(machine, scene, changes, outcome):
    """Read between the ends of its steps; everything moves, nothing is lost."""
    orders = composite(scene, changes)
    expected = outcome("glibc", orders)
    values = [
        struct.unpack(">d", bytes.fromhex(word))[0] for line in expected for word in line.split()
    ]
    assert all(map(math.isfinite, values))
    assert len(set(values)) > 0.4 * len(values)
    for number, pair in enumerate(zip(expected, outcome(machine, orders), strict=True)):
        assert pair[0] == pair[1], f"line {number}"


# machines that meet events: what happens within the run, and what is changed so that it does
EVENTFUL = {
    "impacts": (
        "finite_weights",
        {"balls.restitution": 0.6, "balls.drag": 1.0, "balls.speeds": [20.0, -20.0, 9.0]},
    ),
    "sticking": (
        "two_balls",
        {"weights.rolling_resistance": 0.05, "rotor.friction": [{"limit": 0.05}]},
    ),
}


@pytest.mark.parametrize("kind", EVENTFUL)
@pytest.mark.parametrize("machine", [name for name in MACHINES if name != "glibc"])
def test_a_machine_with_events_has_the_bits_it_has_on_glibc(machine, kind, outcome):
    """Impacts, contacts, weights and supports that stick: roots of polynomials and pivots."""
    scene, changes = EVENTFUL[kind]
    orders = composite(scene, {"tolerance": 1e-6}, changes)
    expected = outcome("glibc", orders)
    words = {word for line in expected for word in line.split()}
    assert len(words) > 0.3 * sum(len(line.split()) for line in expected)
    for number, pair in enumerate(zip(expected, outcome(machine, orders), strict=True)):
        assert pair[0] == pair[1], f"line {number}"


@pytest.mark.parametrize("kind", EVENTFUL)
def test_these_machines_meet_events(kind):
    name, changes = EVENTFUL[kind]
    tolerance = {"coupling.steps_per_rev": None, "coupling.corrections": None}
    tolerance |= {"coupling.tolerance": 1e-6, "run.revolutions": STEPS / PER_TURN}
    scene = load_scene(name).replace({**tolerance, **changes})
    [balls] = scene.balancer
    what = "angle" if kind == "impacts" else "speed"
    record = [f"{balls.label}.weight[{k}].{what}" for k in range(1, balls.count + 1)]
    found = np.array(list(cosimulate(scene, record=record).signals.values()))
    if kind == "impacts":
        touching = 2.0 * math.asin(balls.weight_radius / balls.track_radius)
        assert np.abs(np.diff(found, axis=0).min(axis=1) - touching).min() <= 1e-6
    else:  # it stops, and goes on
        rests = found == 0.0
        assert (rests[:, 1:] & ~rests[:, :-1]).any()
        assert (~rests[:, 1:] & rests[:, :-1]).any()


@pytest.mark.parametrize("scene", ["two_balls", "drum", "filimonikhina"])
@pytest.mark.parametrize("machine", [name for name in MACHINES if name != "glibc"])
def test_machines_side_by_side_have_the_bits_of_one_alone_on_glibc(machine, scene, outcome):
    """Seven unbalances in four lanes, so that one that is finished takes the next machine."""
    token, line = composite(scene, {"tolerance": 1e-5})
    names = composition(load_scene(scene)).described("Composite").layout.index
    first, _, _, length = line.split()
    values = [bits(size * 1e-3) for size in (0.1, 1.0, 0.3, 2.0, 0.5, 1.5, 0.7)]
    reference = names[
        next(name for name in names if name.startswith("rotor.") and "unbalance" in name)
    ]

    def order(side: int) -> list[str]:
        return [token, f"{first} 10 1f {length} {reference:x} {side:x} 7 {' '.join(values)}"]

    expected = outcome("glibc", order(1))
    assert len(set(expected)) == len(expected) == len(values)
    assert outcome(machine, order(4)) == expected == outcome("glibc", order(2))


def composite(
    scene: str, changes: dict[str, float], machine: dict[str, object] | None = None
) -> list[str]:
    """A scene's composite, some seven times per revolution; changes of its coupling and machine."""
    loaded = load_scene(scene)
    scheme = "auto" if changes else loaded.coupling.scheme
    steps = {} if changes else {"coupling.steps_per_rev": 12}
    keys = {"coupling.scheme": scheme, "coupling.corrections": None, **steps}
    loaded = loaded.replace({**keys, **{f"coupling.{k}": v for k, v in changes.items()}})
    loaded = loaded.replace(machine or {})
    made = composition(loaded)
    reals = made.described("Composite").layout.reals
    outputs = [i for i, v in enumerate(reals) if v.causality == "output"]
    length = 2.0 * math.pi / (PER_TURN * max(loaded.profile().start, loaded.profile().end))
    return [made.token(stamp()), f"{outputs[0]:x} {len(outputs):x} {STEPS:x} {bits(length)}"]
