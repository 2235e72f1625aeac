"""The shared library of an unpacked FMU, loaded without a trace in the process.

fmpy's own loading changes the process's working folder for a moment, which every other thread sees;
here the library is loaded by its full path.  Making and freeing instances takes turns: units that
run Python put their folder on the interpreter's path while they are made.
"""

from __future__ import annotations

import ctypes
import sys
import threading
from collections.abc import Callable
from ctypes import byref, c_char_p, c_int, c_void_p
from pathlib import Path

import fmpy
from fmpy import fmi2

STATUS = ("OK", "Warning", "Discard", "Error", "Fatal", "Pending")
MODULE_FILE = "slavemodule.txt"  # of the resources of an FMU that pythonfmu made: its loader's
_TURN = threading.RLock()


def runs_python(folder: Path) -> bool:
    """Whether pythonfmu made the FMU that is unpacked there."""
    return (folder / "resources" / MODULE_FILE).is_file()


def resources_of(folder: Path) -> bytes:
    """Where the resources of an unpacked FMU are, as the URI that FMI 2.0 hands on.

    pythonfmu's loader takes what follows file:// for a path as it stands, whatever RFC 3986
    says of spaces and letters beyond ASCII.
    """
    resources = folder / "resources"
    as_it_stands = sys.platform != "win32" and runs_python(folder)
    uri = f"file://{resources}" if as_it_stands else resources.as_uri()
    return uri.encode("utf-8", "surrogateescape")


def callbacks_to(log: Callable[[int, str], None]) -> fmi2.fmi2CallbackFunctions:
    """What an instance of FMI 2.0 calls; must outlive it.

    Args:
        log: takes status and text of a message.
    """

    def hear(_environment, _instance, status, _category, message) -> None:
        try:  # a Python unit logs with its exception pending, which `decode` would be blamed for
            raise LookupError
        except Exception:
            text = message.decode("utf-8", "replace") if message else ""
        log(status, text)

    callbacks = fmi2.fmi2CallbackFunctions()
    callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(hear)
    callbacks.allocateMemory = fmi2.defaultCallbacks.allocateMemory
    callbacks.freeMemory = fmi2.defaultCallbacks.freeMemory
    return callbacks


class Library:
    """One instance in the library of an FMI 2.0 co-simulation FMU.

    Args:
        directory: where the FMU is unpacked.
        identifier: its model identifier.

    Attributes:
        dll: the library; its functions take C values.
        component: the instance, once it is made.
        runs_python: whether pythonfmu made the FMU.

    Raises:
        OSError: there is no library for this machine, or it cannot be loaded.
    """

    def __init__(self, directory: str, identifier: str) -> None:
        self._directory = Path(directory).resolve()
        binaries = self._directory / "binaries" / fmpy.platform
        path = binaries / f"{identifier}{fmpy.sharedLibraryExtension}"
        if not path.is_file():
            raise OSError(f"Cannot find shared library {path}.")
        self.component = c_void_p()
        self.runs_python = runs_python(self._directory)
        # native calls take microseconds, less than handing on the interpreter's lock at each
        load = ctypes.CDLL if self.runs_python else ctypes.PyDLL
        with _TURN:
            self.dll = load(str(path))

    def instantiate(self, name: str, guid: str, callbacks: fmi2.fmi2CallbackFunctions) -> None:
        """Make the instance; `callbacks` must outlive it.

        Raises:
            OSError: the unit refuses; what it logged says why.
        """
        make = self.dll.fmi2Instantiate
        make.argtypes = (c_char_p, c_int, c_char_p, c_char_p, c_void_p, c_int, c_int)
        make.restype = c_void_p
        with _TURN:
            made = make(
                name.encode(),
                fmi2.fmi2CoSimulation,
                guid.encode(),
                resources_of(self._directory),
                byref(callbacks),
                0,
                1,
            )
        if made is None:
            fmpy.freeLibrary(self.dll._handle)
            raise OSError("Failed to instantiate model")
        self.component = c_void_p(made)

    def free(self) -> None:
        """Free the instance and unload the library."""
        with _TURN:
            self.dll.fmi2FreeInstance(self.component)
            fmpy.freeLibrary(self.dll._handle)
