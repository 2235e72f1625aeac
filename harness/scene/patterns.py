"""What names and ports in a scene look like, and what a message says of those that do not."""

from __future__ import annotations

import re

LONGEST_NAME = 32  # characters: every variable of it has at most the 63 of MATLAB
NAME = rf"^[A-Za-z_][A-Za-z0-9_-]{{0,{LONGEST_NAME - 1}}}$"  # of a balancer or a unit
BODY = rf"^[^\W\d_][\w-]{{0,{LONGEST_NAME - 1}}}$"  # in tables and legends alone: any script
PORT = rf"^[A-Za-z_][A-Za-z0-9_-]{{0,{LONGEST_NAME - 1}}}\..+$"
WORDS = {
    NAME: f"must begin with a letter; letters, digits, _, - only, at most {LONGEST_NAME}",
    BODY: f"must begin with a letter; letters, digits, _, - only, at most {LONGEST_NAME}",
    PORT: "must be unit.variable, such as rotor.x: a name, a dot, and a variable of it",
}


def legal_characters(text: str) -> str:
    """A text of any length whose other characters are _, with one before a digit at the start."""
    return re.sub(r"^(?=[\d-])|[^\w-]", "_", text, flags=re.ASCII)
