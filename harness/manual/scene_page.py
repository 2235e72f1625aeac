"""A bundled scene as a page: what it is, the scene running, its file."""

from __future__ import annotations

import html
import json
import warnings
from pathlib import Path

from autobalancer.scene import load

from ..errors import SimulationError, UserError
from ..scene.file import find
from ..scene.plausible import ImplausibleWarning

UNITS = '<script type="text/plain" id="units">'  # from here on all live pages are alike
PAGE = """---
hide: [toc]
---

# {name}

{title}

Source: {source}

<iframe class="live" src="../live/{name}.html" title="{name}, running" loading="lazy"></iframe>

<a href="../live/{name}.html" target="_blank">The running scene alone</a>; to write it yourself:
`autobalancer show {name} -o {name}.html`

```toml title="{name}.toml"
{file}```
"""


def page(name: str) -> str:
    """Markdown of a bundled scene's page, with its live page in a frame."""
    scene, file = load(name), find(name).read_text(encoding="utf-8")
    source = html.escape(scene.source or "an example")
    return PAGE.format(name=name, title=html.escape(scene.title), source=source, file=file)


def live(name: str, path: Path) -> None:
    """Write the page that `autobalancer show` writes, or one that says why there is none.

    Units and scripts are the same in every scene. They are written once, beside the pages, as a
    script that inserts them: pages opened as files may load nothing else.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ImplausibleWarning)
            load(name).show(path)
        own, start, shared = path.read_text(encoding="utf-8").partition(UNITS)
        inserted = f"document.write({json.dumps(start + shared)});"
        path.with_name("units.js").write_text(inserted, encoding="utf-8")
        own = own.replace("script-src ", "script-src 'self' file: ", 1)
        path.write_text(f'{own}<script src="units.js"></script>', encoding="utf-8")
    except (SimulationError, UserError) as error:
        text = f"<!DOCTYPE html><meta charset='utf-8'><p>{html.escape(str(error))}</p>"
        path.write_text(text, encoding="utf-8")
