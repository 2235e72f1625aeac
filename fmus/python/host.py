"""What pythonfmu's native loader does to the reference counts of its host, and how it is undone.

The loader of pythonfmu 0.7 (PySlaveInstance.cpp) gives back references it does not own:

* `findClass` releases the slave module's dictionary, which it borrowed, at every instantiation;
* after a Python exception `handle_py_exception` releases class, instance and log queue, and the
  destructor releases them a second time.

Both end in freed objects that are still in use.  Each such theft is answered by one reference that
is never given back.

On Linux its library also releases its own state twice when the process ends before the library is
unloaded: first the static object, then once more in the library's destructor, by then in freed
memory ("corrupted double-linked list", now and then).  Releasing it earlier makes both harmless.
"""

from __future__ import annotations

import atexit
import ctypes
import os
import sys
import threading
from typing import Any

_increment = ctypes.pythonapi.Py_IncRef
_increment.argtypes = [ctypes.py_object]
_increment.restype = None

_libraries: set[str] = set()  # paths of the libraries to settle when the process ends


def keep(*objects: Any) -> None:
    """Add one reference that nothing ever releases to each object."""
    for item in objects:
        _increment(item)


def entered(module: dict[str, Any], namespace: Any) -> None:
    """Called by the slave module's top-level code each time the loader runs it.

    Args:
        module: the module's `globals()`.
        namespace: its `locals()`; another dictionary when the loader, not `import`, runs the code.
    """
    if namespace is module:
        return  # the loader follows, and needs the folder that it has put on sys.path
    keep(module)
    # the loader puts the resources folder on sys.path at each instantiation and leaves it there; it
    # is another folder than that of the module when the same FMU was unpacked before
    file = f"{module['__name__']}.py"
    for entry in list(sys.path):
        if entry and os.path.isfile(os.path.join(entry, file)):
            sys.path.remove(entry)
            sys.path_importer_cache.pop(entry, None)
            settle_at_exit(os.path.dirname(os.path.normpath(entry)))


def settle_at_exit(root: str) -> None:
    """Have the library of the FMU unpacked at `root` release its state before the process ends."""
    if sys.platform != "linux" or threading.main_thread().native_id != os.getpid():
        return  # the library itself started this interpreter and must be the one to end it
    folder = os.path.join(root, "binaries", "linux64")
    if not os.path.isdir(folder):
        return
    if not _libraries:
        atexit.register(_settle)
    _libraries.update(os.path.join(folder, name) for name in os.listdir(folder))


def _settle() -> None:
    for path in _libraries:
        try:
            library = ctypes.CDLL(path, mode=os.RTLD_NOLOAD | os.RTLD_NOW)
        except OSError:
            continue  # unloaded in time
        library.finalizePythonInterpreter()
