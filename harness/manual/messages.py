"""Reference of the messages, read from the sources that write them."""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]
ERRORS = ("Error", "refusal", "Agrees", "Disagreement")


def page() -> str:
    """Markdown of all messages."""
    found: dict[str, list[str]] = defaultdict(list)
    for package in ("models", "fmus", "harness"):
        for path in sorted((ROOT / package).rglob("*.py")):
            raised = dict.fromkeys(_of_python(ast.parse(path.read_text(encoding="utf-8"))))
            found[path.relative_to(ROOT).as_posix()] += [t for t in raised if len(t.split()) > 2]
    for path in sorted((ROOT / "fmus" / "native").rglob("*.c")):
        found[path.relative_to(ROOT).as_posix()] += _of_c(path.read_text(encoding="utf-8"))
    lines: list[str] = []
    for place, texts in found.items():
        if texts:
            lines += [f"## {place}", ""]
            for text in texts:  # a heading: the search ranks titles first
                lines += [f"##### {_plain(text)}", ""]
    return "\n".join(lines)


def _of_python(tree: ast.AST) -> Iterator[str]:
    """Texts of the errors that are raised, and of steps that a run reports."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call):
            name = ast.unparse(node.exc.func)
            if name.endswith(ERRORS):
                yield " ".join(map(_text, node.exc.args)).strip()


def _text(node: ast.AST) -> str:
    """A text with its places to fill as dots."""
    if isinstance(node, ast.Constant):
        return str(node.value)
    if isinstance(node, ast.JoinedStr):
        return "".join(map(_text, node.values))
    if isinstance(node, ast.BinOp):
        return _text(node.left) + _text(node.right)
    return "…"


def _of_c(source: str) -> Iterator[str]:
    """Literals of several words, those next to each other as one."""
    code = re.sub(r"/\*.*?\*/|^#.*?$", "", source, flags=re.DOTALL | re.MULTILINE)
    for match in re.finditer(r'"(?:[^"\\\n]|\\.)*"(?:\s*"(?:[^"\\\n]|\\.)*")*', code):
        text = "".join(re.findall(r'"((?:[^"\\\n]|\\.)*)"', match[0])).replace('\\"', '"')
        if len(text.split()) > 3 and "\\n" not in text:  # with \\n it is assembly
            yield re.sub(r"\{\w(?:\.\d+)?\}", "…", text)


def _plain(text: str) -> str:
    """A text that Markdown shows as it is."""
    return re.sub(r"([\\`*_<\[])", r"\\\1", re.sub(r"…+", "…", " ".join(text.split())))
