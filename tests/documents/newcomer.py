"""The newcomer's path: the blocks of its page, in their order, as changes of a file and as commands."""

from __future__ import annotations

import re

from pages import blocks, text_of

PAGE = "newcomer.md"
ANSWER = "inerter run my-car.toml -o answer"


def changes() -> list[str]:
    """The lines to be changed in the study file, step by step."""
    return [block.code for block in blocks(PAGE, "toml")]


def steps() -> list[str]:
    """Commands of the shell, and changes of the file, in the order of the page."""
    found = re.findall(
        r"^```toml\n(.*?)^```|^    ((?:inerter|python3) [^\n]*)$", text_of(PAGE), re.MULTILINE | re.DOTALL
    )
    return [change or command for change, command in found]


def with_lines(study: str, change: str) -> str:
    """A study file in which each line of the change replaces that of its key, or is added to its section."""
    lines, section = study.splitlines(), ""
    for line in filter(None, change.splitlines()):
        if line.startswith("["):
            section = line
            continue
        key = line.partition(" =")[0]
        start = lines.index(section) + 1 if section else 0
        rest = range(start, next((i for i in range(start, len(lines)) if lines[i].startswith("[")), len(lines)))
        keys = {lines[i].partition(" =")[0]: i for i in rest if re.match(r"\w+ =", lines[i])}
        at = keys.get(key, max(keys.values()) + 1)
        lines[at : at + (key in keys)] = [line]
    return "\n".join(lines) + "\n"
