"""A scene as one page: template, style, scripts, units and data in one text."""

from __future__ import annotations

import base64
import html
import json
import re
from pathlib import Path
from typing import NamedTuple

from ...fmus.native.build.compile import NotCompiled, page_library
from ..errors import UserError
from ..master.recorder import recorded
from ..output.files import plain, write_whole
from ..result.run import cosimulate
from ..scene import Scene
from .content import content

_FOLDER = Path(__file__).parent
# in the order in which one builds on another; all are one module
_SCRIPTS = (
    "units",
    "machine",
    "format",
    "drawing",
    "plots",
    "controls",
    "balance",
    "files",
    "main",
)

_COMMENT = re.compile(r"^ */\*.*?\*/\n", re.MULTILINE | re.DOTALL)  # of whole lines


class Page(NamedTuple):
    """A page that was written.

    Attributes:
        path: of the file.
        summary: of the scene's run, which stands under the title.
    """

    path: Path
    summary: str


def write_page(scene: Scene, path: Path | None = None) -> Page:
    """See `Scene.show`."""
    path = path or Path(f"{scene.name}.html")
    try:
        whole = scene.replace({"run.record": None})
        summary = str(cosimulate(whole, record=recorded(whole)).summary())
        text = page(scene, summary)
    except NotCompiled as error:
        raise UserError(str(error)) from error
    with write_whole(path) as stream:
        stream.write(text)
    return Page(path, summary)


def page(scene: Scene, summary: str = "") -> str:
    """A page that runs a scene's units in the browser; it asks no network for anything.

    Args:
        summary: of the scene's run, shown under the title.

    Raises:
        SceneError, NotCompiled: as `content`.
    """
    known = content(scene)
    # no </script> can end the data, whatever is in it
    data = json.dumps(plain(known), ensure_ascii=False, allow_nan=False).replace("<", "\\u003c")
    parts = {
        "TITLE": html.escape(scene.heading),
        "SOURCE": html.escape(scene.source),
        "SUMMARY": html.escape(summary),
        "STYLE": _without_comments("page.css"),
        "SCRIPT": "\n".join(_without_comments(f"{name}.js") for name in _SCRIPTS),
        "DATA": data,
        "UNITS": base64.b64encode(page_library()).decode("ascii"),
    }
    before, *pieces = _read("page.html").split("{{")
    filled = [before]
    for piece in pieces:  # one pass: what is filled in is not looked at again
        name, _, rest = piece.partition("}}")
        filled += [parts[name], rest]
    return "".join(filled)


def _without_comments(name: str) -> str:
    """A page is sent by mail: what explains its sources stays with them."""
    return _COMMENT.sub("", _read(name))


def _read(name: str) -> str:
    return (_FOLDER / name).read_text(encoding="utf-8")
