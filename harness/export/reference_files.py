"""Files in a scene's FMU that say what it should compute, by the layered standard FMI-LS-REF."""

from __future__ import annotations

from collections.abc import Callable
from xml.etree.ElementTree import Element as Xml
from xml.etree.ElementTree import SubElement

import numpy as np

from ...fmus.xml.description import text_of
from ...models.arrays import Array
from ..accuracy.precision.reference import refuse_without_reference, right_motion
from ..master.recorder import recorded
from ..master.schedule import end_time, step_size
from ..output.workers import Progress
from ..scene import Scene

RTOL = 1e-12  # tighter ones take twice the time; what two methods differ by is stated
NAME = "org.fmi-standard.fmi-ls-ref"
FOLDER = f"extra/{NAME}"
_MANIFEST = {
    "xmlns:fmi-ls": "http://fmi-standard.org/fmi-ls-manifest",
    "fmi-ls:fmi-ls-name": NAME,
    "fmi-ls:fmi-ls-version": "1.0.0-alpha.1",
    "fmi-ls:fmi-ls-description": "Layered Standard providing information on related files "
    "included in an FMU.",
}


def reference_files(
    scene: Scene, label: Callable[[str], str], progress: Progress | None = None
) -> dict[str, bytes]:
    """The motion of a scene by an integration of all equations in one piece, and a manifest.

    Args:
        label: from a signal to the name of its variable.
        progress: told the finished fraction: a long run is integrated for minutes.

    Raises:
        SceneError, SimulationError: nobody knows the motion that exactly; the message says why.
    """
    refuse_without_reference(scene)
    step, names = step_size(scene), recorded(scene)
    times: Array = np.arange(1.0, round(end_time(scene) / step) + 1.0) * step
    right, error = right_motion(scene, names, [times], RTOL, progress)
    columns = [right.time.tolist(), *(right.signal(name).tolist() for name in names)]
    lines = [",".join(["time", *map(label, names)])]
    lines += [",".join(map(repr, row)) for row in zip(*columns, strict=True)]
    said = (
        "Motion from the start values of this FMU, by an independent integration of all equations "
        f"in one piece; two methods differ by {error:.0e} of the range of a signal"
    )
    root = Xml("fmiReferences", _MANIFEST)
    about = {"type": "text/csv", "source": "reference.csv", "role": "result", "description": said}
    SubElement(root, "Related", about)
    page = f"<!DOCTYPE html><title>References</title><p>{FOLDER}/reference.csv: {said}."
    return {
        f"{FOLDER}/fmi-ls-manifest.xml": text_of(root),
        f"{FOLDER}/reference.csv": ("\n".join(lines) + "\n").encode(),
        "documentation/fmi-ls-ref.html": page.encode(),
    }
