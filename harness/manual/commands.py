"""Reference of the commands, from their options."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any


def page(program: Any) -> str:
    """Markdown of all commands of a program, a group of Click."""
    return "\n".join("\n".join(_command(n, c)) for n, c in program.commands.items())


def _command(name: str, command: Any) -> Iterator[str]:
    context = command.context_class(command, info_name=f"autobalancer {name}")
    yield from (f"## {name}", "", f"    {command.get_usage(context).removeprefix('Usage: ')}", "")
    yield from (*(command.help or "").strip().splitlines(), "")
    yield from ("| option | meaning |", "|---|---|")
    for parameter in command.params:
        record = parameter.get_help_record(context)
        if record:
            names, meaning = (" ".join(cell.replace("|", "\\|").split()) for cell in record)
            yield f"| `{names}` | {meaning} |"
    yield ""
